//! The source of the calibrated model: the original file, followed by a model that extends the original with
//! the estimates.

use crate::ir::program::Program;
use crate::runtime::machine::Machine;

use super::extended_source::{ExtendedSource, file_name};
use super::modification::{Tree, parts, without_subscripts};
use super::plan::Plan;
use super::result::{Calibration, Estimate};
use super::table::shown;

/// The command that runs a calibrated FMU, which cannot be extended.
pub fn command(plan: &Plan, found: &Calibration) -> String {
    let state = if found.fit.complete { "" } else { "; the fit was interrupted" };
    let mut out = format!(
        "# Calibrated by `mocc calibrate {}`:\n# reduced chi-square {:.4}{state}.\nmocc simulate '{}'",
        file_name(&found.plan),
        found.reduced_train(),
        plan.model.display()
    );
    let fixed = plan.fixed.iter().filter_map(|setting| setting.split_once('='));
    for (name, value) in fixed {
        out.push_str(&format!(" \\\n  --set '{}={}'", name.trim(), value.trim()));
    }
    for (target, estimate) in &assigned(plan, found) {
        let inner = target.strip_prefix("start(").and_then(|t| t.strip_suffix(')'));
        let name = inner.map_or_else(|| target.clone(), |v| format!("{}.start", v.trim()));
        out.push_str(&format!(" \\\n  --set '{name}={:?}'", estimate.value));
    }
    out.push('\n');
    out
}

/// The source; `original` is that of the model's file.
pub fn text(original: &str, program: &Program, plan: &Plan, found: &Calibration) -> String {
    let mut root = Tree::default();
    let mut inexpressible = Vec::new();
    for setting in &plan.fixed {
        if let Some((path, value)) = setting.split_once('=') {
            root.set(&parts(path.trim()), value.trim().to_owned(), "fixed by the plan".to_owned());
        }
    }
    let assigned = assigned(plan, found);
    for (target, estimate) in &assigned {
        let (path, is_start) = match target.strip_prefix("start(").and_then(|t| t.strip_suffix(')'))
        {
            Some(variable) => (variable.trim(), true),
            None => (target.as_str(), false),
        };
        let mut path_parts = parts(&without_subscripts(path));
        if is_start {
            path_parts.push("start".to_owned());
        }
        let value = if path.contains('[') {
            elements(program, path, is_start, &assigned)
        } else {
            Some(format!("{:?}", estimate.value))
        };
        match value {
            Some(value) => root.set(&path_parts, value, comment(estimate)),
            None => inexpressible.push(format!("{target} = {:?}", estimate.value)),
        }
    }
    let state = if found.fit.complete { "" } else { "; the fit was interrupted" };
    ExtendedSource {
        original,
        origin: vec![
            format!("Calibrated by `mocc calibrate {}`:", file_name(&found.plan)),
            format!("reduced chi-square {:.4}{state}.", found.reduced_train()),
        ],
        model: &found.model,
        done: "calibrated",
        values: root,
        inexpressible,
        experiment: program.blocks.dae.experiment,
    }
    .text()
}

/// Every target with its estimate.
fn assigned<'a>(plan: &Plan, found: &'a Calibration) -> Vec<(String, &'a Estimate)> {
    let each = plan.free.iter().zip(&found.estimates);
    each.flat_map(|(free, e)| free.targets.iter().map(move |t| (t.trim().to_owned(), e))).collect()
}

fn comment(e: &Estimate) -> String {
    if e.at_bound {
        return "at its bound".to_owned();
    }
    if e.undetermined {
        return "not determined by the data".to_owned();
    }
    let unit = if e.unit == "1" { "" } else { &e.unit };
    format!("+- {} {unit}", shown(e.error, 10.0 * e.error)).trim_end().to_owned()
}

/// `{v1, v2, ...}` for an element of an array with one subscript; elements that are not free keep their value.
fn elements(
    program: &Program,
    path: &str,
    is_start: bool,
    assigned: &[(String, &Estimate)],
) -> Option<String> {
    if path.matches('[').count() != 1 {
        return None;
    }
    let whole = without_subscripts(path);
    let mut machine = Machine::new(program);
    machine.run(&program.tapes.parameters).ok()?;
    let layout = &program.layout;
    let inputs: Vec<(&str, f64)> = if is_start {
        let starts = layout.starts.iter();
        starts.map(|(v, .., cell)| (program.name(*v), machine.get(*cell))).collect()
    } else {
        let inputs = layout.parameter_inputs.iter();
        inputs.map(|(v, _)| (program.name(*v), machine.value(*v))).collect()
    };
    let mut found: Vec<(usize, f64)> = Vec::new();
    for (name, value) in inputs {
        if without_subscripts(name) != whole {
            continue;
        }
        let subscript = name[name.find('[')? + 1..name.find(']')?].parse().ok()?;
        let target = if is_start { format!("start({name})") } else { name.to_owned() };
        let estimate = assigned.iter().find(|(t, _)| t.replace(' ', "") == target);
        found.push((subscript, estimate.map_or(value, |(_, e)| e.value)));
    }
    found.sort_by_key(|f| f.0);
    let dense = found.iter().enumerate().all(|(i, f)| f.0 == i + 1);
    let values: Vec<String> = found.iter().map(|f| format!("{:?}", f.1)).collect();
    dense.then(|| format!("{{{}}}", values.join(", ")))
}
