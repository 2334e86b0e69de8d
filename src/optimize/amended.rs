//! The source of the optimized model: the original file, followed by a model that extends the original with the design.

use super::plan::Plan;
use super::result::{Optimum, unit, value};
use crate::calibrate::extended_source::{ExtendedSource, file_name};
use crate::calibrate::modification::{Tree, parts};
use crate::ir::flat::Experiment;

/// The source; `original` is that of the model's file.
pub fn text(original: &str, plan: &Plan, found: &Optimum, declared: &Experiment) -> String {
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
    let (before, after) = (value(found.before), value(found.after));
    let change = format!("{} was {before}, is {after} {}", found.goal, unit(&found.goal_unit));
    ExtendedSource {
        original,
        origin: vec![
            format!("Optimized by `mocc optimize {}`:", file_name(&found.plan)),
            change.trim_end().to_owned(),
        ],
        model: &found.model,
        done: "optimized",
        values: root,
        inexpressible,
        experiment: Experiment {
            stop: plan.stop.or(declared.stop),
            tolerance: plan.tolerance.or(declared.tolerance),
            ..*declared
        },
    }
    .text()
}
