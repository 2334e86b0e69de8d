//! The source of the optimized model: the original file, followed by a model that extends the original with the design.

use super::plan::Plan;
use super::result::{Optimum, unit, value};
use crate::calibrate::modification::{Tree, parts};
use crate::ir::flat::Experiment;

/// The source; `original` is that of the model's file.
pub fn text(original: &str, plan: &Plan, found: &Optimum, declared: &Experiment) -> String {
    let full = &found.model;
    let base = full.rsplit('.').next().unwrap_or(full);
    let name = match base.strip_prefix('\'').and_then(|b| b.strip_suffix('\'')) {
        Some(quoted) => format!("'{quoted}_optimized'"),
        None => format!("{base}_optimized"),
    };
    let mut root = Tree::default();
    let mut inexpressible = Vec::new();
    for setting in &plan.fixed {
        // A quantity with a unit is no expression.
        match setting.split_once('=') {
            Some((path, number))
                if number.trim().parse::<f64>().is_ok() || !number.contains(' ') =>
            {
                root.set(
                    &parts(path.trim()),
                    number.trim().to_owned(),
                    "fixed by the plan".to_owned(),
                );
            }
            _ => inexpressible.push(setting.clone()),
        }
    }
    for p in &found.parameters {
        for target in &p.targets {
            let start = target.trim().strip_prefix("start(").and_then(|t| t.strip_suffix(')'));
            let mut path = parts(start.unwrap_or(target).trim());
            if start.is_some() {
                path.push("start".to_owned());
            }
            let number = format!("{:?}", p.value);
            match target.contains('[') {
                true => inexpressible.push(format!("{target}={number}")),
                false => root.set(&path, number, p.end().to_owned()),
            }
        }
    }
    let mut out = original.trim_end().to_owned();
    let file = found.plan.rsplit(['/', '\\']).next().unwrap_or(&found.plan);
    out.push_str(&format!("\n\n// Optimized by `mocc optimize {file}`:\n"));
    let (before, after) = (value(found.before), value(found.after));
    let (goal, of) = (&found.goal, unit(&found.goal_unit));
    out.push_str(format!("// {goal} was {before}, is {after} {of}").trim_end());
    out.push('\n');
    for line in &inexpressible {
        out.push_str(&format!("// Not expressible as a modification; use `--set`: {line}\n"));
    }
    out.push_str(&format!("model {name} \"{base}, optimized\"\n  extends {full}"));
    if !root.is_empty() {
        out.push_str("(\n");
        root.print(4, &mut out);
        out.push_str("  )");
    }
    out.push_str(";\n");
    let all = [
        ("StartTime", declared.start),
        ("StopTime", plan.stop.or(declared.stop)),
        ("Interval", declared.interval),
        ("Tolerance", plan.tolerance.or(declared.tolerance)),
    ];
    let set: Vec<String> =
        all.iter().filter_map(|(name, x)| x.map(|x| format!("{name} = {x:?}"))).collect();
    if !set.is_empty() {
        out.push_str(&format!("  annotation(experiment({}));\n", set.join(", ")));
    }
    out.push_str(&format!("end {name};\n"));
    out
}
