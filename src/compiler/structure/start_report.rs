//! How the initial values of a model come about, in its own names (`mocc simulate --explain-start`).
//!
//! *In:* the sorted system. *Out:* which starts are fixed, which are assumed because the model leaves them open, what the
//! initial equations determine, what follows from the others, and which starts only begin an iteration.

use super::print::printed;
use super::{explain, is_continuous};
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::ir::blocks::{Assignment, Block, Blocks, Source};
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::VarId;

/// How the initial values come about.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct StartReport {
    /// `fixed = true`: the value is the start value.
    pub fixed: Vec<StartValue>,
    /// Not fixed, but the model leaves the value open: it is the start value all the same.
    pub assumed: Vec<StartValue>,
    /// Equations that hold at the start only.
    pub equations: Vec<InitialEquation>,
    /// States that follow from equations.
    pub states: Vec<Followed>,
    /// Conditions that follow from the others, and are checked at the start.
    pub redundant: Vec<InitialEquation>,
    /// Start values at which iterations begin; the value is another.
    pub guesses: Vec<StartValue>,
}

/// A variable and its start value.
#[derive(Clone, PartialEq, Debug)]
pub struct StartValue {
    /// The variable.
    pub variable: VarId,
    /// Its start value as written; empty if it has none, which is 0.
    pub start: String,
    /// Where it is declared.
    pub span: Span,
}

/// An equation that holds at the start.
#[derive(Clone, PartialEq, Debug)]
pub struct InitialEquation {
    /// The equation.
    pub text: String,
    /// The variable that it determines, if it is solved alone.
    pub determines: Option<VarId>,
    /// The variables of the system that it is solved with.
    pub together: Vec<VarId>,
    /// Where it is written.
    pub span: Span,
}

/// A state that follows from equations.
#[derive(Clone, PartialEq, Debug)]
pub struct Followed {
    /// The state.
    pub variable: VarId,
    /// The equation that is solved for it; empty for a system.
    pub from: String,
    /// The initial equations in the system that determines it.
    pub initial: Vec<String>,
    /// Number of equations of that system.
    pub size: usize,
}

/// Explains the start of a model.
pub fn report(blocks: &Blocks) -> StartReport {
    let dae = &blocks.dae;
    let mut report = StartReport::default();
    let states: FastSet<VarId> = blocks.states.iter().map(|s| s.variable).collect();
    let assumed: FastSet<VarId> = blocks.assumed_starts.iter().copied().collect();
    let mut used = Used::default();
    for part in parts(&blocks.initial) {
        part.read(dae, &states, &mut report, &mut used);
    }
    for (v, variable) in dae.variables.enumerate() {
        if used.starts.contains(&v) {
            let list = if assumed.contains(&v) { &mut report.assumed } else { &mut report.fixed };
            list.push(start_value(dae, v));
        } else if variable.fixed == Some(true) && is_continuous(dae, v) {
            let text = format!("{} = {} (fixed)", variable.name, start_text(dae, v));
            let (determines, together) = (None, Vec::new());
            report.redundant.push(InitialEquation {
                text,
                determines,
                together,
                span: variable.span,
            });
        }
    }
    for i in 0..dae.initial.len() {
        if !used.equations.contains(&i) {
            let (determines, together) = (None, Vec::new());
            let source = Source::Initial(i);
            let (text, span) = (equation(dae, source), explain::origin(dae, source).span);
            report.redundant.push(InitialEquation { text, determines, together, span });
        }
    }
    report.guesses.sort_by_key(|g| g.variable);
    report
}

/// What the blocks have used.
#[derive(Default)]
struct Used {
    starts: FastSet<VarId>,
    equations: FastSet<usize>,
}

/// Equations that are solved together, or one alone.
struct Part<'b> {
    assignments: Vec<&'b Assignment>,
    unknowns: Vec<VarId>,
    sources: Vec<Source>,
}

fn parts(sequence: &[Block]) -> Vec<Part<'_>> {
    let mut out = Vec::new();
    for block in sequence {
        match block {
            Block::Assign(a) => {
                out.push(Part { assignments: vec![a], unknowns: vec![], sources: vec![a.source] });
            }
            Block::Torn(t) => {
                let explicit = t.explicit.iter().map(|a| a.source);
                out.push(Part {
                    assignments: t.explicit.iter().collect(),
                    unknowns: t.unknowns.clone(),
                    sources: explicit.chain(t.residuals.iter().map(|r| r.source)).collect(),
                });
            }
            Block::Mixed(inner) => out.extend(parts(inner)),
        }
    }
    out
}

impl Part<'_> {
    fn read(&self, dae: &Dae, states: &FastSet<VarId>, report: &mut StartReport, used: &mut Used) {
        let is_alone = self.unknowns.is_empty();
        let mut all: Vec<VarId> = self.unknowns.clone();
        all.extend(self.assignments.iter().map(|a| a.variable));
        let shown = |v: &VarId| !dae.variables[*v].hidden;
        let initial: Vec<String> = self
            .sources
            .iter()
            .filter(|s| matches!(s, Source::Initial(_)))
            .map(|s| equation(dae, *s))
            .collect();
        for source in &self.sources {
            match *source {
                Source::Start(v) => {
                    used.starts.insert(v);
                }
                Source::Initial(i) => {
                    used.equations.insert(i);
                    report.equations.push(InitialEquation {
                        text: equation(dae, *source),
                        determines: is_alone.then_some(all[0]),
                        together: if is_alone {
                            vec![]
                        } else {
                            all.iter().copied().filter(shown).collect()
                        },
                        span: explain::origin(dae, *source).span,
                    });
                }
                _ => {}
            }
        }
        for &v in all.iter().filter(|v| states.contains(v) && shown(v)) {
            let own = self.assignments.iter().find(|a| a.variable == v);
            if own.is_some_and(|a| matches!(a.source, Source::Start(_))) {
                continue;
            }
            let from = own.filter(|_| is_alone).map_or(String::new(), |a| equation(dae, a.source));
            let (initial, size) = (initial.clone(), self.sources.len());
            report.states.push(Followed { variable: v, from, initial, size });
        }
        let is_guess = |v: &&VarId| {
            let variable = &dae.variables[**v];
            !variable.hidden && variable.kind != VariableKind::Discrete
        };
        report.guesses.extend(self.unknowns.iter().filter(is_guess).map(|v| start_value(dae, *v)));
    }
}

fn start_value(dae: &Dae, v: VarId) -> StartValue {
    let start = dae.variables[v].start.map_or(String::new(), |e| printed(dae, e));
    StartValue { variable: v, start, span: dae.variables[v].span }
}

fn start_text(dae: &Dae, v: VarId) -> String {
    dae.variables[v].start.map_or_else(|| "0".to_owned(), |e| printed(dae, e))
}

/// An equation as written.
fn equation(dae: &Dae, source: Source) -> String {
    match source {
        Source::Continuous(id) => {
            let e = &dae.equations[id];
            format!("{} = {}", printed(dae, e.lhs), printed(dae, e.rhs))
        }
        Source::Initial(i) => {
            let e = &dae.initial[i];
            format!("{} = {}", printed(dae, e.lhs), printed(dae, e.rhs))
        }
        Source::Discrete(i) => {
            let e = &dae.discrete[i];
            format!("{} = {}", dae.variables[e.variable].name, printed(dae, e.value))
        }
        Source::Start(v) => format!("{} = {}", dae.variables[v].name, start_text(dae, v)),
    }
}
