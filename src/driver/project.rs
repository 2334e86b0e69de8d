//! The settings of a project: `mocc.toml` in the folder of a model, or in one above it.

use std::path::{Path, PathBuf};

use super::files::read;
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::base::toml_file::read as read_toml;

/// The name of the file.
pub const NAME: &str = "mocc.toml";

/// Names of integration methods.
pub const METHODS: [&str; 4] = ["auto", "radau", "bdf", "dopri"];

/// The settings of a project.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Project {
    /// Folders of libraries, in addition to those of the command line.
    pub libraries: Vec<PathBuf>,
    /// Folders whose data files models may read.
    pub allow_read: Vec<PathBuf>,
    /// Integration method of runs whose command names none: one of [`METHODS`].
    pub method: Option<String>,
    /// Relative tolerance of runs for which neither the command nor the model has one.
    pub tolerance: Option<f64>,
}

/// The settings that hold for a file, or for the working directory. Errors are added to `problems`.
pub fn of(file: Option<&Path>, sources: &mut SourceMap, problems: &mut Problems) -> Project {
    let Some(path) = find(file) else { return Project::default() };
    let Ok(text) = read(&path) else { return Project::default() };
    let base = path.parent().unwrap_or(Path::new("")).to_owned();
    let found = read_toml(&path, &text, sources, problems, |r, root| {
        r.known(&root, &["libraries", "allow_read", "method", "tolerance"]);
        let folders = |names: Option<Vec<String>>| {
            names.unwrap_or_default().into_iter().map(|name| base.join(name)).collect()
        };
        Project {
            libraries: folders(r.texts(&root, "libraries")),
            allow_read: folders(r.texts(&root, "allow_read")),
            method: r.value(&root, "method", "\"auto\", \"radau\", \"bdf\" or \"dopri\"", |item| {
                item.text().filter(|name| METHODS.contains(&name.as_str()))
            }),
            tolerance: r.value(&root, "tolerance", "a positive number", |item| {
                item.number().filter(|x| *x > 0.0 && x.is_finite())
            }),
        }
    });
    found.unwrap_or_default()
}

/// The file of the settings: in the folder of a file or in one above it, as the user would write its path.
fn find(file: Option<&Path>) -> Option<PathBuf> {
    let own = match file.and_then(Path::parent) {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let absolute = own.canonicalize().ok()?;
    for (k, folder) in absolute.ancestors().enumerate() {
        if folder.join(NAME).is_file() {
            let mut path = own;
            path.extend(std::iter::repeat_n("..", k));
            let path = path.strip_prefix(".").map(Path::to_owned).unwrap_or(path);
            return Some(path.join(NAME));
        }
    }
    None
}
