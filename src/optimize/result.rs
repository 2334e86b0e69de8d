//! The best design: as a table for people, and as JSON.

use crate::calibrate::table::shown;
use crate::io::json::Json;
use crate::ir::trajectory::Trajectory;
use crate::simulate::failure::Failure;

/// Distance from an end of its range, relative to it, at which a parameter is at that end.
const AT_END: f64 = 1e-4;
/// Distance from a bound, relative to it, at which a limit holds the design.
const AT_BOUND: f64 = 1e-4;

/// An optimized design.
#[derive(Clone, Debug)]
pub struct Optimum {
    /// Full name of the model.
    pub model: String,
    /// The plan file.
    pub plan: String,
    /// Name of the goal.
    pub goal: String,
    /// Its expression.
    pub goal_text: String,
    /// Its SI unit, if that is plain.
    pub goal_unit: String,
    /// The goal is to be greatest.
    pub maximize: bool,
    /// The goal at the start.
    pub before: Option<f64>,
    /// The goal of the best design.
    pub after: Option<f64>,
    /// The free parameters.
    pub parameters: Vec<ParameterFound>,
    /// The limits.
    pub limits: Vec<LimitFound>,
    /// All limits hold.
    pub is_feasible: bool,
    /// No step leads to a better design.
    pub converged: bool,
    /// The search was not interrupted.
    pub complete: bool,
    /// Each search.
    pub searches: Vec<SearchFound>,
    /// Runs of all searches.
    pub runs: u32,
    /// Gradients from sensitivities.
    pub exact: u32,
    /// Gradients from differences.
    pub differences: u32,
    /// Variables on the page; without them, a choice.
    pub show: Vec<String>,
    /// The run at the start, if it can be simulated.
    pub trace_before: Option<Trajectory>,
    /// The run of the best design.
    pub trace_after: Trajectory,
    /// The model's file, followed by a model with the design.
    pub amended: String,
}

/// A free parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct ParameterFound {
    /// Its name.
    pub name: String,
    /// The parameters of the model that take its value.
    pub targets: Vec<String>,
    /// Its unit.
    pub unit: String,
    /// Its least value.
    pub low: f64,
    /// Its greatest value.
    pub high: f64,
    /// Where the first search began.
    pub start: f64,
    /// In the best design.
    pub value: f64,
}

/// A measure with bounds.
#[derive(Clone, PartialEq, Debug)]
pub struct LimitFound {
    /// Its name.
    pub name: String,
    /// Its expression.
    pub text: String,
    /// Its SI unit, if that is plain.
    pub unit: String,
    /// Its least value.
    pub min: Option<f64>,
    /// Its greatest value.
    pub max: Option<f64>,
    /// At the start.
    pub before: Option<f64>,
    /// In the best design.
    pub after: Option<f64>,
    /// Derivative of the best goal by the bound that holds it.
    pub price: Option<f64>,
}

/// How a search ended.
#[derive(Clone, PartialEq, Debug)]
pub enum State {
    /// No step leads to a better design.
    Converged,
    /// The steps or the time ran out.
    Ended,
    /// A limit does not hold.
    OutsideLimits,
    /// Its start has no goal, for this reason.
    Failed(String),
}

/// A search.
#[derive(Clone, PartialEq, Debug)]
pub struct SearchFound {
    /// The parameters at its start.
    pub start: Vec<f64>,
    /// How it ended.
    pub state: State,
    /// The goal at its end.
    pub goal: Option<f64>,
    /// The parameters there.
    pub values: Vec<f64>,
    /// Its steps.
    pub steps: u32,
}

/// What a search took.
#[derive(Clone, PartialEq, Debug)]
pub struct Counts {
    /// Runs.
    pub runs: u32,
    /// Gradients from sensitivities.
    pub exact: u32,
    /// Gradients from differences.
    pub differences: u32,
    /// Why its last run failed, if one did.
    pub failure: Option<Failure>,
}

impl ParameterFound {
    /// Which end of its range holds it, if one does.
    pub fn end(&self) -> &'static str {
        let near = AT_END * (self.high - self.low);
        match self.value {
            v if v <= self.low + near => "at its least",
            v if v >= self.high - near => "at its greatest",
            _ => "",
        }
    }
}

impl LimitFound {
    /// `<= 0.5`, or the range.
    pub fn range(&self) -> String {
        match (self.min, self.max) {
            (Some(a), Some(b)) => format!("{} ... {}", shown(a, 0.0), shown(b, 0.0)),
            (Some(a), None) => format!(">= {}", shown(a, 0.0)),
            (None, Some(b)) => format!("<= {}", shown(b, 0.0)),
            (None, None) => String::new(),
        }
    }

    /// How the bounds act on the design.
    pub fn effect(&self) -> &'static str {
        let Some(after) = self.after else { return "has no value" };
        let size = |bound: f64| AT_BOUND * bound.abs().max(f64::MIN_POSITIVE);
        let violated = self.max.is_some_and(|b| after > b + size(b))
            || self.min.is_some_and(|b| after < b - size(b));
        let holds =
            [self.min, self.max].into_iter().flatten().any(|b| (after - b).abs() <= size(b));
        match (violated, holds) {
            (true, _) => "violated",
            (false, true) => "active",
            (false, false) => "",
        }
    }
}

impl State {
    /// In words.
    pub fn text(&self) -> &str {
        match self {
            State::Converged => "converged",
            State::Ended => "ended early",
            State::OutsideLimits => "outside the limits",
            State::Failed(why) => why,
        }
    }
}

/// A value that may be missing.
pub fn value(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), |x| shown(x, 0.0))
}

/// A unit; empty for numbers without one.
pub fn unit(unit: &str) -> &str {
    if unit == "1" { "" } else { unit }
}

impl Optimum {
    /// For people.
    pub fn table(&self) -> String {
        let mut rows: Vec<[String; 6]> = Vec::new();
        let head = ["", "before", "after", "unit", "range", ""].map(str::to_owned);
        rows.push(head);
        let goal = format!("{} {}", if self.maximize { "maximize" } else { "minimize" }, self.goal);
        let own = unit(&self.goal_unit).to_owned();
        rows.push([goal, value(self.before), value(self.after), own, String::new(), String::new()]);
        for l in &self.limits {
            let (before, after) = (value(l.before), value(l.after));
            rows.push([
                format!("limit {}", l.name),
                before,
                after,
                unit(&l.unit).to_owned(),
                l.range(),
                l.effect().to_owned(),
            ]);
        }
        for p in &self.parameters {
            rows.push([
                p.name.clone(),
                shown(p.start, 0.0),
                shown(p.value, 0.0),
                unit(&p.unit).to_owned(),
                format!("{} ... {}", shown(p.low, 0.0), shown(p.high, 0.0)),
                p.end().to_owned(),
            ]);
        }
        let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..6).map(width).collect();
        let mut out = format!("{}\n", self.model);
        for row in &rows {
            let mut line = String::from(" ");
            for (k, cell) in row.iter().enumerate() {
                let pad = " ".repeat(widths[k] - cell.chars().count());
                // Numbers are aligned at their end.
                let (left, right) =
                    if k == 1 || k == 2 { (pad, String::new()) } else { (String::new(), pad) };
                line.push_str(&format!(" {left}{cell}{right} "));
            }
            out.push_str(line.trim_end());
            out.push('\n');
        }
        out
    }

    /// One line on the searches.
    pub fn effort(&self) -> String {
        let count = |state: &dyn Fn(&SearchFound) -> bool| {
            self.searches.iter().filter(|s| state(s)).count()
        };
        let converged = count(&|s| s.state == State::Converged);
        let of = self.searches.len();
        let searches = if of == 1 { "search" } else { "searches" };
        let gradients = match (self.exact, self.differences) {
            (exact, 0) => format!("{exact} exact gradients"),
            (0, differences) => format!("{differences} gradients by differences"),
            (exact, differences) => {
                format!("{exact} exact gradients, {differences} by differences")
            }
        };
        format!("{converged} of {of} {searches} converged; {} runs, {gradients}", self.runs)
    }

    /// As JSON.
    pub fn json(&self, seconds: f64) -> String {
        let maybe = |x: Option<f64>| x.map_or(Json::null(), Json::number);
        let parameters = self.parameters.iter().map(|p| {
            Json::object([
                ("name", Json::text(p.name.as_str())),
                ("unit", Json::text(p.unit.as_str())),
                ("min", Json::number(p.low)),
                ("max", Json::number(p.high)),
                ("before", Json::number(p.start)),
                ("after", Json::number(p.value)),
            ])
        });
        let limits = self.limits.iter().map(|l| {
            Json::object([
                ("name", Json::text(l.name.as_str())),
                ("is", Json::text(l.text.as_str())),
                ("unit", Json::text(l.unit.as_str())),
                ("min", maybe(l.min)),
                ("max", maybe(l.max)),
                ("before", maybe(l.before)),
                ("after", maybe(l.after)),
                ("goal_per_unit", maybe(l.price)),
            ])
        });
        let searches = self.searches.iter().map(|s| {
            Json::object([
                ("start", Json::numbers(&s.start)),
                ("end", Json::numbers(&s.values)),
                ("goal", maybe(s.goal)),
                ("steps", Json::count(s.steps as usize)),
                ("state", Json::text(s.state.text())),
            ])
        });
        Json::object([
            ("model", Json::text(self.model.as_str())),
            ("plan", Json::text(self.plan.as_str())),
            (
                "goal",
                Json::object([
                    ("name", Json::text(self.goal.as_str())),
                    ("is", Json::text(self.goal_text.as_str())),
                    ("unit", Json::text(self.goal_unit.as_str())),
                    ("maximize", Json::flag(self.maximize)),
                    ("before", maybe(self.before)),
                    ("after", maybe(self.after)),
                ]),
            ),
            ("parameters", Json::list(parameters)),
            ("limits", Json::list(limits)),
            ("feasible", Json::flag(self.is_feasible)),
            ("converged", Json::flag(self.converged)),
            ("complete", Json::flag(self.complete)),
            ("searches", Json::list(searches)),
            ("runs", Json::count(self.runs as usize)),
            ("exact_gradients", Json::count(self.exact as usize)),
            ("difference_gradients", Json::count(self.differences as usize)),
            ("seconds", Json::number(seconds)),
        ])
        .pretty()
    }
}
