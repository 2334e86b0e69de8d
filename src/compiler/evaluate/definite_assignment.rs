//! Whether the outputs of a function have a value wherever it may end (section 12.4.4 of the specification).
//!
//! The rule is that of definite assignment in Java (The Java Language Specification, chapter 16), with less
//! strictness where conditions or subscripts decide: a loop is taken to run at least once, an element with a computed
//! subscript stands for the whole array, and the last `==` of an `if` with several conditions for an `else`. So a
//! function that is found wanting is so for some arguments, but not every function that is, is found.

use std::collections::BTreeSet;

use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{
    BinaryOp, ComponentRef, Expr, ExprKind, Statement, StatementKind, Subscript, UnaryOp,
};

/// Largest number of elements of an array that is looked at one by one.
const MOST_ELEMENTS: usize = 256;

/// An output, or a part of it, without a value.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Missing {
    /// The output.
    pub name: Name,
    /// A field, `.a`, or an element, `[2]`; empty for the whole.
    pub part: String,
    /// The `if` that assigns it on some paths alone.
    pub branch: Option<Span>,
}

/// The parts of an output that are assigned one by one: fields or elements. Empty if it is a scalar, or unknown.
pub(super) type Parts = BTreeSet<String>;

/// The labels of the elements of an array; empty if there are many.
pub(super) fn elements(sizes: &[usize]) -> Parts {
    if sizes.iter().product::<usize>() > MOST_ELEMENTS {
        return Parts::new();
    }
    let mut indices: Vec<Vec<i64>> = vec![Vec::new()];
    for size in sizes {
        let with = |before: &Vec<i64>| {
            let before = before.clone();
            (1..=*size as i64).map(move |k| before.iter().copied().chain([k]).collect())
        };
        indices = indices.iter().flat_map(with).collect();
    }
    indices.iter().map(|index| element(index)).collect()
}

fn element(index: &[i64]) -> String {
    let index: Vec<String> = index.iter().map(i64::to_string).collect();
    format!("[{}]", index.join(","))
}

/// The outputs that may be without a value at the end, each once.
pub(super) fn missing<'s>(
    outputs: &FastMap<Name, Parts>,
    sections: impl Iterator<Item = &'s [Statement]>,
) -> Vec<Missing> {
    let mut search =
        Search { outputs, branches: FastMap::default(), missing: FastMap::default(), left: None };
    let mut state = Some(State::default());
    for statements in sections {
        state = search.run(statements, state);
    }
    if let Some(state) = state {
        search.end(&state);
    }
    let mut found: Vec<Missing> = search.missing.into_values().collect();
    found.sort_by_key(|missing| missing.name.as_str());
    found
}

/// The parts of outputs that have a value.
#[derive(Clone, Default)]
struct State(FastMap<Name, Assigned>);

#[derive(Clone)]
enum Assigned {
    Whole,
    Parts(Parts),
}

struct Search<'o> {
    outputs: &'o FastMap<Name, Parts>,
    /// Where an output has a value on some paths alone.
    branches: FastMap<Name, Span>,
    missing: FastMap<Name, Missing>,
    /// The state in which a loop was left last.
    left: Option<State>,
}

impl Search<'_> {
    /// The state after statements; `None` where they never end.
    fn run(&mut self, list: &[Statement], before: Option<State>) -> Option<State> {
        let mut state = before?;
        for statement in list {
            match &statement.kind {
                StatementKind::Assign(target, _) => self.assign(&mut state, target),
                StatementKind::AssignTuple(targets, _) => {
                    for target in targets.iter().flatten() {
                        self.assign(&mut state, target);
                    }
                }
                StatementKind::If { branches, otherwise } => {
                    let mut ends: Vec<Option<State>> = Vec::new();
                    for (_, body) in branches {
                        ends.push(self.run(body, Some(state.clone())));
                    }
                    if !otherwise.is_empty() || !is_exhaustive(branches) {
                        ends.push(self.run(otherwise, Some(state.clone())));
                    }
                    state = self.meet(ends, statement.span)?;
                }
                StatementKind::For { body, .. } | StatementKind::While { body, .. } => {
                    let after = self.run(body, Some(state.clone()));
                    // A loop that is always left early has run to there.
                    state = after.or(self.left.take()).unwrap_or(state);
                }
                StatementKind::Call(call) if never_returns(call) => return None,
                StatementKind::Return => {
                    self.end(&state);
                    return None;
                }
                StatementKind::Break => {
                    self.left = Some(state);
                    return None;
                }
                StatementKind::Broken => return None,
                StatementKind::Call(_) | StatementKind::When { .. } => {}
            }
        }
        Some(state)
    }

    fn assign(&self, state: &mut State, target: &ComponentRef) {
        let name = target.parts[0].name.name;
        let Some(all) = self.outputs.get(&name) else { return };
        let assigned = state.0.entry(name).or_insert_with(|| Assigned::Parts(Parts::new()));
        let Assigned::Parts(parts) = assigned else { return };
        match part(target).filter(|part| all.contains(part)) {
            Some(part) => {
                parts.insert(part);
                if parts.len() == all.len() {
                    *assigned = Assigned::Whole;
                }
            }
            None => *assigned = Assigned::Whole,
        }
    }

    /// What is assigned at the end of each of several paths.
    fn meet(&mut self, ends: Vec<Option<State>>, branch: Span) -> Option<State> {
        let mut ends = ends.into_iter().flatten();
        let mut met = ends.next()?;
        for end in ends {
            for name in self.outputs.keys() {
                match (met.0.get(name), end.0.get(name)) {
                    (Some(Assigned::Whole), Some(Assigned::Whole)) | (None, None) => {}
                    (Some(Assigned::Parts(a)), Some(Assigned::Parts(b))) if a == b => {}
                    (a, b) => {
                        let both = match (a, b) {
                            (Some(Assigned::Parts(a)), Some(Assigned::Parts(b))) => a & b,
                            (Some(Assigned::Parts(p)), Some(Assigned::Whole))
                            | (Some(Assigned::Whole), Some(Assigned::Parts(p))) => p.clone(),
                            _ => Parts::new(),
                        };
                        self.branches.entry(*name).or_insert(branch);
                        met.0.insert(*name, Assigned::Parts(both));
                    }
                }
            }
        }
        Some(met)
    }

    /// The function may end in this state.
    fn end(&mut self, state: &State) {
        for (name, all) in self.outputs {
            let part = match state.0.get(name) {
                Some(Assigned::Whole) => continue,
                Some(Assigned::Parts(parts)) if !parts.is_empty() => {
                    all.difference(parts).next().cloned().unwrap_or_default()
                }
                _ => String::new(),
            };
            let branch = self.branches.get(name).copied();
            let missing = Missing { name: *name, part, branch };
            self.missing.entry(*name).or_insert(missing);
        }
    }
}

/// The field or element that is assigned; `None` for the whole, or where its subscripts are computed.
fn part(target: &ComponentRef) -> Option<String> {
    let index = |subscript: &Subscript| match subscript {
        Subscript::Expr(Expr { kind: ExprKind::Integer(k), .. }) => Some(*k),
        _ => None,
    };
    match &*target.parts {
        [whole] if !whole.subscripts.is_empty() => {
            let index: Option<Vec<i64>> = whole.subscripts.iter().map(index).collect();
            index.map(|index| element(&index))
        }
        [whole, field, ..] if whole.subscripts.is_empty() => Some(format!(".{}", field.name.name)),
        _ => None,
    }
}

/// Whether several conditions are taken to leave no other case.
fn is_exhaustive(branches: &[(Expr, Vec<Statement>)]) -> bool {
    let [_, .., (last, _)] = branches else { return false };
    matches!(last.kind, ExprKind::Binary(BinaryOp::Equal, ..) | ExprKind::Unary(UnaryOp::Not, _))
}

/// Whether a call ends the run: an assertion of `false`, or a function that reports an error.
fn never_returns(call: &Expr) -> bool {
    let ExprKind::Call { function, args, .. } = &call.kind else { return false };
    let name = function.parts.last().map_or("", |part| part.name.name.as_str());
    match name {
        "assert" => args.first().is_some_and(|a| matches!(a.kind, ExprKind::Boolean(false))),
        _ => matches!(name, "error" | "ModelicaError"),
    }
}
