//! A variable is reinitialized in one when-equation only, and once in each of its branches (Modelica 3.6, section 8.3.6).

use super::cause::FlattenCause;
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::expr::{Binary, ExprId, Graph, Node, VarId};
use crate::ir::flat::{Action, EquationKind, FlatModel};

/// Reports variables that several when-equations reinitialize, or several statements of one branch. Branches of one equation
/// may do so, and branches of an if-equation within it.
pub(super) fn check(cx: &mut Evaluator<'_>, flat: &FlatModel) {
    let mut first: FastMap<VarId, (usize, Span)> = FastMap::default();
    for (k, equation) in flat.equations.iter().enumerate() {
        let EquationKind::When(branches) = &equation.kind else { continue };
        let span = equation.origin.span;
        for branch in branches {
            let mut guards: FastMap<VarId, Vec<Option<ExprId>>> = FastMap::default();
            for action in &branch.actions {
                let Action::Reinit { state, guard, .. } = action else { continue };
                let (number, place) = *first.entry(*state).or_insert((k, span));
                let before = guards.entry(*state).or_default();
                let overlaps = before.iter().any(|other| !exclude(&mut cx.graph, *other, *guard));
                before.push(*guard);
                if number != k || overlaps {
                    let name = flat.variables[*state].name.to_string();
                    let twice = Diagnostic::new(FlattenCause::ReinitTwice { name }, span);
                    cx.problems.push(match number == k {
                        true => twice,
                        false => twice.also(place, "reinitialized here too"),
                    });
                }
            }
        }
    }
}

/// True for conditions of which one has a factor that contradicts one of the other: branches of an if-equation.
fn exclude(graph: &mut Graph, a: Option<ExprId>, b: Option<ExprId>) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return false };
    let (of_a, of_b) = (factors(graph, a), factors(graph, b));
    let mut opposite = |all: &[ExprId], e: ExprId| {
        let not_e = graph.not(e);
        all.contains(&not_e)
    };
    of_a.iter().any(|e| opposite(&of_b, *e)) || of_b.iter().any(|e| opposite(&of_a, *e))
}

/// The conjunctions and conditions that a condition implies.
fn factors(graph: &Graph, e: ExprId) -> Vec<ExprId> {
    let mut found = vec![e];
    let mut next = 0;
    while let Some(e) = found.get(next) {
        if let Node::Binary(Binary::And, a, b) = graph.node(*e) {
            found.extend([a, b]);
        }
        next += 1;
    }
    found
}
