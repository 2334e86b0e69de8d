//! Algorithm sections of models (Modelica 3.6, section 11.1).
//!
//! The statements of a section are executed in order on symbols. A variable that the section assigns
//! begins with its value on entry, and is read as the expression that it has where it is read. At the
//! end each variable has one equation:
//!
//! - assigned outside of when-statements only: its last expression;
//! - assigned by a single when-statement: an equation of a when-clause;
//! - assigned by several statements, of which one is a when-statement: each when-statement gives a
//!   variable of its own its value, and the last one that is active counts.

use super::assigned::{self, Targets};
use super::equation::{Target, asserted};
use super::when::Executed;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::history::Synthetic;
use crate::ir::ast::{self, StatementKind};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{Action, EquationKind, WhenBranch};
use crate::ir::instance::Scope;

/// Expands an algorithm section of a model.
pub(super) fn expand(
    cx: &mut Evaluator<'_>,
    list: &[ast::Statement],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) {
    cx.units.unitless_literal = false;
    cx.assigned.clear();
    if let Some(targets) = assigned::of_statements(cx, list, scope) {
        let mut section = Section::new(list, targets);
        section.enter(cx, target);
        let whens = section.execute(cx, list, scope, target);
        if let Some((outputs, values)) = section.values(cx) {
            section.report_continuous(cx, list, (&outputs, &values), target);
            target.push(EquationKind::Algorithm { outputs, values }, span);
        }
        cx.assigned.clear();
        asserted(cx, target);
        for (branches, span) in whens {
            target.push(EquationKind::When(branches), span);
        }
    }
    cx.assigned.clear();
    target.flat.unitless_literals.extend(cx.units.unitless_literal.then_some(span));
    cx.units.unitless_literal = false;
}

/// A section that is being executed.
struct Section {
    /// The variables that each statement assigns.
    targets: Vec<Targets>,
    /// The last statement that assigns each variable.
    last: FastMap<VarId, usize>,
    /// Variables that when-statements assign: those that nothing else does, and the others.
    sole: FastSet<VarId>,
    shared: FastSet<VarId>,
    /// The last expressions of variables that are read by name from then on.
    finished: FastMap<VarId, ExprId>,
    /// The type of each variable.
    types: FastMap<VarId, Type>,
    /// No statement outside of when-statements failed.
    complete: bool,
}

impl Section {
    fn new(list: &[ast::Statement], targets: Vec<Targets>) -> Self {
        let mut last = FastMap::default();
        let mut statements: FastMap<VarId, usize> = FastMap::default();
        let mut in_when: FastSet<VarId> = FastSet::default();
        for (k, (s, own)) in list.iter().zip(&targets).enumerate() {
            for &v in &own.all {
                last.insert(v, k);
                *statements.entry(v).or_default() += 1;
                if matches!(s.kind, StatementKind::When { .. }) {
                    in_when.insert(v);
                }
            }
        }
        let (sole, shared) = in_when.into_iter().partition(|v| statements[v] == 1);
        let (finished, types) = (FastMap::default(), FastMap::default());
        Section { targets, last, sole, shared, finished, types, complete: true }
    }

    /// Gives the assigned variables their values on entry: discrete ones their `pre` value, others
    /// their start value (section 11.1.2). A variable that a when-statement assigns is discrete.
    fn enter(&mut self, cx: &mut Evaluator<'_>, target: &mut Target<'_>) {
        for &v in self.targets.iter().flat_map(|t| &t.all) {
            let variable = &mut target.flat.variables[v];
            if self.shared.contains(&v) && variable.variability == ast::Variability::Continuous {
                variable.variability = ast::Variability::Discrete;
            }
            let continuous = variable.variability == ast::Variability::Continuous;
            let value = match variable.start {
                _ if !continuous || self.sole.contains(&v) => {
                    cx.graph.intern(Node::Pre(v), variable.ty)
                }
                Some(start) => start,
                None => cx.graph.real(0.0),
            };
            self.types.insert(v, variable.ty);
            cx.assigned.insert(v, value);
        }
    }

    /// Executes all statements; returns the when-clauses.
    fn execute(
        &mut self,
        cx: &mut Evaluator<'_>,
        list: &[ast::Statement],
        scope: Scope,
        target: &mut Target<'_>,
    ) -> Vec<(Vec<WhenBranch>, Span)> {
        let mut whens = Vec::new();
        for (k, s) in list.iter().enumerate() {
            let StatementKind::When { branches } = &s.kind else {
                self.complete =
                    self.complete && cx.run_statements(std::slice::from_ref(s), scope).is_some();
                self.finish(cx, k);
                continue;
            };
            let before = cx.assigned.clone();
            self.read_finished_by_name(cx, k);
            let own = &self.targets[k].branches;
            let executed =
                cx.in_when(|cx| super::when::statement_branches(cx, branches, own, scope));
            cx.assigned = before;
            if let Some(executed) = executed {
                whens.extend(self.when_clause(cx, executed, s.span).map(|w| (w, s.span)));
                target.flat.unitless_literals.extend(cx.units.unitless_literal.then_some(s.span));
            }
            self.finish(cx, k);
        }
        whens
    }

    /// Reads variables that no statement from number `k` on assigns by name: their values need not
    /// be repeated in when-clauses.
    fn read_finished_by_name(&self, cx: &mut Evaluator<'_>, k: usize) {
        for (v, last) in &self.last {
            if *last < k {
                let itself = cx.graph.var(*v, self.types[v]);
                cx.assigned.insert(*v, itself);
            }
        }
    }

    /// The when-clause of a statement. The value of a variable that other statements assign too becomes
    /// that of an intermediate variable, and the variable depends on whether the clause is active.
    fn when_clause(
        &self,
        cx: &mut Evaluator<'_>,
        mut executed: Vec<Executed>,
        span: Span,
    ) -> Option<Vec<WhenBranch>> {
        let mut shared: Vec<VarId> = Vec::new();
        for v in executed.iter().flat_map(|b| &b.values).map(|(v, _)| *v) {
            if self.shared.contains(&v) && !shared.contains(&v) {
                shared.push(v);
            }
        }
        let active: Vec<ExprId> = match shared.is_empty() {
            true => Vec::new(),
            false => executed.iter_mut().map(|b| activation(cx, b, span)).collect(),
        };
        for v in shared {
            let Some(mut value) = cx.assigned.get(&v).copied() else { continue };
            let ty = self.types[&v];
            for (branch, active) in executed.iter_mut().zip(&active).rev() {
                // A branch that does not assign the variable leaves it as it was before the statement.
                let own = match branch.values.iter_mut().find(|(w, _)| *w == v) {
                    Some(own) => {
                        own.0 = cx.make(Synthetic::Assigned(ty, span));
                        cx.graph.var(own.0, ty)
                    }
                    None => cx.assigned[&v],
                };
                value = cx.graph.if_then_else(*active, own, value);
            }
            cx.assigned.insert(v, value);
        }
        let branches: Vec<WhenBranch> = executed.into_iter().map(Executed::into_branch).collect();
        branches.iter().any(|b| !b.actions.is_empty()).then_some(branches)
    }

    /// Finishes the variables that statement number `k` is the last to assign.
    fn finish(&mut self, cx: &mut Evaluator<'_>, k: usize) {
        for &v in &self.targets[k].all {
            if self.last[&v] != k || !(self.sole.contains(&v) || self.shared.contains(&v)) {
                continue;
            }
            let Some(value) = cx.assigned.get(&v).copied() else { continue };
            let itself = cx.graph.var(v, self.types[&v]);
            cx.assigned.insert(v, itself);
            if self.shared.contains(&v) {
                self.finished.insert(v, value);
            }
        }
    }

    /// Reports variables of discrete type that get values which change between events (section 3.8.4).
    fn report_continuous(
        &self,
        cx: &mut Evaluator<'_>,
        list: &[ast::Statement],
        (outputs, values): (&[VarId], &[ExprId]),
        target: &Target<'_>,
    ) {
        if target.initial {
            return;
        }
        for (v, value) in outputs.iter().zip(values) {
            // All of them are reported.
            let _ = cx.check_seen(self.types[v], *value, list[self.last[v]].span);
        }
    }

    /// The variables that are not left to a when-clause, and their values after the section.
    fn values(&mut self, cx: &Evaluator<'_>) -> Option<(Vec<VarId>, Vec<ExprId>)> {
        let mut seen = FastSet::default();
        let all = self.targets.iter().flat_map(|t| &t.all).copied();
        let outputs: Vec<VarId> =
            all.filter(|v| !self.sole.contains(v) && seen.insert(*v)).collect();
        let value = |v: &VarId| self.finished.get(v).or_else(|| cx.assigned.get(v)).copied();
        let values = outputs.iter().map(value).collect::<Option<Vec<_>>>()?;
        (self.complete && !outputs.is_empty()).then_some((outputs, values))
    }
}

/// Whether a branch of a when-statement is active unless an earlier one is: in the iteration of the
/// event in which one of its conditions becomes true, or during initialization if `initial()` is one
/// (sections 8.3.5 and 8.6). Its conditions become variables, which have values before the event.
fn activation(cx: &mut Evaluator<'_>, branch: &mut Executed, span: Span) -> ExprId {
    let initial = cx.graph.intern(Node::Initial, Type::Boolean);
    let mut edges = cx.graph.boolean(false);
    let mut at_start = false;
    for condition in &mut branch.conditions {
        if *condition == initial {
            at_start = true;
            continue;
        }
        let flag = cx.make(Synthetic::Condition(*condition, span));
        *condition = cx.graph.var(flag, Type::Boolean);
        let before = cx.graph.pre(flag, Type::Boolean);
        let not_before = cx.graph.not(before);
        let edge = cx.graph.and(*condition, not_before);
        edges = cx.graph.or(edges, edge);
    }
    if at_start {
        return cx.graph.or(initial, edges);
    }
    let running = cx.graph.not(initial);
    cx.graph.and(running, edges)
}

impl Executed {
    fn into_branch(self) -> WhenBranch {
        let Executed { conditions, mut actions, values } = self;
        actions.extend(values.into_iter().map(|(v, e)| Action::Assign(v, e)));
        WhenBranch { conditions, actions }
    }
}
