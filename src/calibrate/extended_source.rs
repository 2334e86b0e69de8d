//! The source of a model that extends the user's with other values: the original file, followed by the extension.

use super::modification::Tree;
use crate::ir::flat::Experiment;

/// What is appended to the file of a model.
pub struct ExtendedSource<'a> {
    /// The source of the model's file.
    pub original: &'a str,
    /// Comment lines that say where the values come from, without their slashes.
    pub origin: Vec<String>,
    /// The full name of the model.
    pub model: &'a str,
    /// What was done to it, such as `calibrated`: the end of the new name.
    pub done: &'a str,
    /// The values.
    pub values: Tree,
    /// Assignments that no modification can express.
    pub inexpressible: Vec<String>,
    /// The experiment annotation, which is not inherited.
    pub experiment: Experiment,
}

impl ExtendedSource<'_> {
    /// The whole file.
    pub fn text(&self) -> String {
        let (full, done) = (self.model, self.done);
        let base = full.rsplit('.').next().unwrap_or(full);
        let name = match base.strip_prefix('\'').and_then(|b| b.strip_suffix('\'')) {
            Some(quoted) => format!("'{quoted}_{done}'"),
            None => format!("{base}_{done}"),
        };
        let mut out = self.original.trim_end().to_owned();
        out.push_str("\n\n");
        for line in &self.origin {
            out.push_str(&format!("// {line}\n"));
        }
        for line in &self.inexpressible {
            out.push_str(&format!("// Not expressible as a modification; use `--set`: {line}\n"));
        }
        out.push_str(&format!("model {name} \"{base}, {done}\"\n  extends {full}"));
        if !self.values.is_empty() {
            out.push_str("(\n");
            self.values.print(4, &mut out);
            out.push_str("  )");
        }
        out.push_str(";\n");
        let e = self.experiment;
        let all = [
            ("StartTime", e.start),
            ("StopTime", e.stop),
            ("Interval", e.interval),
            ("Tolerance", e.tolerance),
        ];
        let set: Vec<String> =
            all.iter().filter_map(|(name, x)| x.map(|x| format!("{name} = {x:?}"))).collect();
        if !set.is_empty() {
            out.push_str(&format!("  annotation(experiment({}));\n", set.join(", ")));
        }
        out.push_str(&format!("end {name};\n"));
        out
    }
}

/// The last part of a path, for comments.
pub fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}
