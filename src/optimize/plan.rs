//! Reads the plan of a design: the model, the goal, the limits and the free parameters.
//!
//! `docs/guide/optimize.md` describes the keys.

use std::path::{Path, PathBuf};

use super::cause::DesignCause;
use crate::base::diag::{Diagnostic, Problems};
use crate::base::document::{Item, Section};
use crate::base::source::{SourceMap, Span};
use crate::base::toml_file::{Reader, read as read_toml};
use crate::calibrate::plan::Free;
use crate::driver::quantity::{self, Quantity};

/// A plan.
#[derive(Clone, PartialEq, Debug)]
pub struct Plan {
    /// The plan file.
    pub path: PathBuf,
    /// The model's file.
    pub model: PathBuf,
    /// The model's name, if it is not the last of its file.
    pub name: Option<String>,
    /// Folders of libraries.
    pub libraries: Vec<PathBuf>,
    /// Settings `NAME=VALUE`, as with `--set`.
    pub fixed: Vec<String>,
    /// End of the run, s.
    pub stop: Option<f64>,
    /// Relative tolerance of the integration.
    pub tolerance: Option<f64>,
    /// The goal, `NAME = EXPRESSION`.
    pub goal: String,
    /// The goal is to be greatest.
    pub maximize: bool,
    /// Further measures and their bounds.
    pub limits: Vec<Limit>,
    /// The free parameters.
    pub free: Vec<Range>,
    /// Number of searches.
    pub starts: usize,
    /// Variables on the page.
    pub show: Vec<String>,
}

/// A measure and its bounds.
#[derive(Clone, PartialEq, Debug)]
pub struct Limit {
    /// Its name.
    pub name: String,
    /// Its expression, as after `--measure`.
    pub expression: String,
    /// Its least value.
    pub min: Option<Value>,
    /// Its greatest value.
    pub max: Option<Value>,
}

/// A number in SI units, and its unit as written.
#[derive(Clone, PartialEq, Debug)]
pub struct Value {
    /// The number.
    pub quantity: Quantity,
    /// Its place in the plan.
    pub span: Span,
}

/// A free parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct Range {
    /// Its name.
    pub name: String,
    /// The parameters of the model that take its value; `start(x)` is the start value of `x`.
    pub targets: Vec<String>,
    /// Where the first search begins; without it, at the value in the model.
    pub start: Option<Value>,
    /// Its least value.
    pub min: Value,
    /// Its greatest value.
    pub max: Value,
    /// Its place in the plan.
    pub span: Span,
}

impl Range {
    /// As a parameter of a fit.
    pub fn free(&self) -> Free {
        Free {
            name: self.name.clone(),
            targets: self.targets.clone(),
            start: self.start.as_ref().map(|v| v.quantity.value),
            min: Some(self.min.quantity.value),
            max: Some(self.max.quantity.value),
            around: None,
            acts_on: None,
            only: None,
            span: self.span,
        }
    }
}

const TOP: [&str; 11] = [
    "model",
    "name",
    "libraries",
    "fixed",
    "stop",
    "tolerance",
    "goal",
    "limits",
    "free",
    "starts",
    "show",
];
/// Number of searches if the plan does not say.
const STARTS: usize = 4;

/// Reads a plan. None if it has errors, which are added to `problems`.
pub fn read(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Plan> {
    read_toml(path, text, sources, problems, |reader, root| plan(reader, &root, path)).flatten()
}

fn plan(r: &mut Reader<'_>, root: &Section<'_>, path: &Path) -> Option<Plan> {
    r.known(root, &TOP);
    let base = path.parent().unwrap_or(Path::new(""));
    let model = r.required(root, "model");
    let (goal, maximize) = goal(r, root)?;
    let count = |item: Item<'_>| {
        item.number().filter(|x| x.fract() == 0.0 && (1.0..=1e4).contains(x)).map(|x| x as usize)
    };
    Some(Plan {
        path: path.to_owned(),
        model: base.join(model),
        name: r.text(root, "name"),
        libraries: r
            .texts(root, "libraries")
            .unwrap_or_default()
            .iter()
            .map(|f| base.join(f))
            .collect(),
        fixed: r.settings(root, "fixed"),
        stop: r.size(root, "stop"),
        tolerance: r.size(root, "tolerance"),
        goal,
        maximize,
        limits: limits(r, root),
        free: free(r, root),
        starts: r
            .value(root, "starts", "a number of searches, 1 to 10000", count)
            .unwrap_or(STARTS),
        show: r.texts(root, "show").unwrap_or_default(),
    })
}

fn goal(r: &mut Reader<'_>, root: &Section<'_>) -> Option<(String, bool)> {
    let Some(section) = r.section(root, "goal") else {
        if root.get("goal").is_none() {
            let place = root.place();
            r.report(Diagnostic::new(DesignCause::NoGoal, place));
        }
        return None;
    };
    r.known(&section, &["minimize", "maximize"]);
    let (least, most) = (r.text(&section, "minimize"), r.text(&section, "maximize"));
    match (least, most) {
        (Some(text), None) => Some((text, false)),
        (None, Some(text)) => Some((text, true)),
        _ => {
            let place = section.place();
            r.report(Diagnostic::new(DesignCause::NoGoal, place));
            None
        }
    }
}

fn limits(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<Limit> {
    let mut out = Vec::new();
    for (name, own) in r.tables(root, "limits", "a table `{ is = \"...\", max = ... }`") {
        r.known(&own, &["is", "min", "max"]);
        let expression = r.required(&own, "is");
        let (min, max) = (value(r, &own, "min"), value(r, &own, "max"));
        check(r, &name, &own, [&min, &max]);
        out.push(Limit { name, expression, min, max });
    }
    out
}

fn free(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<Range> {
    if r.entries(root, "free").is_empty() {
        r.report(Diagnostic::new(DesignCause::NothingFree, root.place()));
    }
    let mut out = Vec::new();
    for (name, own) in r.tables(root, "free", "a table `{ min = ..., max = ... }`") {
        r.known(&own, &["start", "min", "max", "tied"]);
        let [start, min, max] = ["start", "min", "max"].map(|key| value(r, &own, key));
        check(r, &name, &own, [&min, &start]);
        check(r, &name, &own, [&start, &max]);
        check(r, &name, &own, [&min, &max]);
        let span = own.place();
        let targets = r.texts(&own, "tied").unwrap_or_else(|| vec![name.clone()]);
        match (min, max) {
            (Some(min), Some(max)) => out.push(Range { name, targets, start, min, max, span }),
            _ if own.get("min").is_some() && own.get("max").is_some() => {}
            _ => r.report(Diagnostic::new(DesignCause::NoRange { name }, span)),
        }
    }
    out
}

/// Reports values that do not increase.
fn check(r: &mut Reader<'_>, name: &str, own: &Section<'_>, ends: [&Option<Value>; 2]) {
    if let [Some(a), Some(b)] = ends
        && a.quantity.value > b.quantity.value
    {
        r.report(Diagnostic::new(DesignCause::EmptyRange { name: name.to_owned() }, own.place()));
    }
}

/// A number, or a string with a unit.
fn value(r: &mut Reader<'_>, section: &Section<'_>, key: &str) -> Option<Value> {
    let item = section.get(key)?;
    let span = item.place();
    let text = item.written().unwrap_or_else(|| key.to_owned());
    let quantity = quantity::read(&text).filter(|q| q.value.is_finite() && item.flag().is_none());
    if quantity.is_none() {
        r.report(Diagnostic::new(DesignCause::NotAValue { text }, span));
    }
    quantity.map(|quantity| Value { quantity, span })
}
