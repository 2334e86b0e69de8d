//! The start of a run for people and as JSON: `mocc simulate --explain-start`.

use crate::base::source::{SourceMap, Span};
use crate::calibrate::table::shown;
use crate::io::json::Json;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::runtime::machine::Machine;
use crate::structure::start_report::{InitialEquation, StartReport, StartValue};

/// Guesses that are listed for people; JSON has all.
const MOST_GUESSES: usize = 20;
/// Variables of a system that are listed for people.
const MOST_NAMES: usize = 6;

/// What the texts need: names, values at the start, places.
pub struct Start<'a> {
    /// The program.
    pub program: &'a Program,
    /// A machine that is initialized, if that succeeded.
    pub machine: Option<&'a Machine<'a>>,
    /// The sources.
    pub sources: &'a SourceMap,
    /// How the values come about.
    pub report: &'a StartReport,
}

impl Start<'_> {
    fn name(&self, v: VarId) -> &str {
        self.program.name(v)
    }

    fn value(&self, v: VarId) -> Option<f64> {
        self.machine.map(|m| m.value(v)).filter(|x| x.is_finite())
    }

    /// ` = 0.3 m`, empty without a value.
    fn is(&self, v: VarId) -> String {
        let unit = self.program.blocks.dae.variables[v].unit.as_str();
        let unit = if unit == "1" { "" } else { unit };
        self.value(v)
            .map_or(String::new(), |x| format!(" = {} {unit}", shown(x, 0.0)).trim_end().to_owned())
    }

    fn place(&self, span: Span) -> String {
        self.sources.place(span).map_or(String::new(), |p| format!("  [{p}]"))
    }

    fn names(&self, all: &[VarId]) -> String {
        let mut names: Vec<&str> = all.iter().take(MOST_NAMES).map(|v| self.name(*v)).collect();
        let more = format!("{} more", all.len().saturating_sub(MOST_NAMES));
        if all.len() > MOST_NAMES {
            names.push(&more);
        }
        names.join(", ")
    }

    /// For people.
    pub fn text(&self) -> String {
        let r = self.report;
        let mut out = format!("start of {}\n", self.program.blocks.dae.name);
        let mut section = |title: &str, lines: Vec<String>| {
            if !lines.is_empty() {
                out.push_str(&format!("  {title} ({}):\n", lines.len()));
                lines.iter().for_each(|line| out.push_str(&format!("    {line}\n")));
            }
        };
        let value = |s: &StartValue| {
            let start = match s.start.as_str() {
                "" => "no start value, so 0".to_owned(),
                text => format!("start = {text}"),
            };
            format!(
                "{}{}  ({start}){}",
                self.name(s.variable),
                self.is(s.variable),
                self.place(s.span)
            )
        };
        section("fixed: start values that the model requires", r.fixed.iter().map(value).collect());
        section(
            "assumed: start values that the model does not require; without them the start is open",
            r.assumed.iter().map(value).collect(),
        );
        let equation = |e: &InitialEquation| {
            let what = match e.determines {
                Some(v) => format!("determines {}{}", self.name(v), self.is(v)),
                None => format!("solved together for {}", self.names(&e.together)),
            };
            format!("{}: {what}{}", e.text, self.place(e.span))
        };
        section("initial equations", r.equations.iter().map(equation).collect());
        let states = r.states.iter().map(|f| {
            let from = match (f.from.as_str(), f.initial.as_slice()) {
                ("", []) => format!("from a system of {} equations", f.size),
                ("", some) => {
                    format!("from a system of {} equations with {}", f.size, some.join("; "))
                }
                (text, _) => format!("from {text}"),
            };
            format!("{}{}: {from}", self.name(f.variable), self.is(f.variable))
        });
        section("states that follow from equations", states.collect());
        let redundant = r.redundant.iter().map(|e| format!("{}{}", e.text, self.place(e.span)));
        section("redundant: they follow from the others, and are checked", redundant.collect());
        let mut guesses: Vec<String> = r.guesses.iter().take(MOST_GUESSES).map(value).collect();
        if r.guesses.len() > MOST_GUESSES {
            guesses.push(format!("and {} more", r.guesses.len() - MOST_GUESSES));
        }
        section("guesses: start values at which an iteration begins", guesses);
        if self.machine.is_none() {
            out.push_str("  the start could not be computed: there are no values\n");
        }
        out
    }

    /// As JSON.
    pub fn json(&self) -> Json {
        let r = self.report;
        let place = |span: Span| Json::text(self.sources.place(span).unwrap_or_default());
        let number = |v: VarId| self.value(v).map_or(Json::null(), Json::number);
        let value = |s: &StartValue| {
            Json::object([
                ("name", Json::text(self.name(s.variable))),
                ("start", Json::text(s.start.as_str())),
                ("value", number(s.variable)),
                ("place", place(s.span)),
            ])
        };
        let names = |all: &[VarId]| Json::list(all.iter().map(|v| Json::text(self.name(*v))));
        let equation = |e: &InitialEquation| {
            Json::object([
                ("equation", Json::text(e.text.as_str())),
                ("determines", e.determines.map_or(Json::null(), |v| Json::text(self.name(v)))),
                ("together", names(&e.together)),
                ("place", place(e.span)),
            ])
        };
        let states = r.states.iter().map(|f| {
            Json::object([
                ("name", Json::text(self.name(f.variable))),
                ("value", number(f.variable)),
                ("equation", Json::text(f.from.as_str())),
                ("initial_equations", Json::list(f.initial.iter().map(|t| Json::text(t.as_str())))),
                ("system", Json::count(f.size)),
            ])
        });
        Json::object([
            ("fixed", Json::list(r.fixed.iter().map(value))),
            ("assumed", Json::list(r.assumed.iter().map(value))),
            ("initial_equations", Json::list(r.equations.iter().map(equation))),
            ("states_from_equations", Json::list(states)),
            ("redundant", Json::list(r.redundant.iter().map(equation))),
            ("guesses", Json::list(r.guesses.iter().map(value))),
        ])
    }
}
