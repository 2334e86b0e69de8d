//! When-clauses as discrete equations (Modelica 3.6, section 8.3.5).
//!
//! Each condition gets a flag, `$whenK := condition`. A branch is active in the event iteration in
//! which one of its flags has just become true, unless an earlier branch is; during initialization
//! it is active exactly if `initial()` is one of its conditions.

use super::rewriting::{RelationMode, Rewriting};
use super::{DiscreteEquations, error};
use crate::base::index::{FastMap, FastSet};
use crate::ir::dae::{GuardedAssert, Reinit, Terminate, VariableKind};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{Action, Assert, Equation, EquationKind, FlatModel, Origin, WhenBranch};

/// The actions of when-clauses other than assignments.
#[derive(Default)]
pub struct WhenActions {
    /// `reinit` in order.
    pub reinits: Vec<Reinit>,
    /// Assertions in order.
    pub asserts: Vec<GuardedAssert>,
    /// `terminate` in order.
    pub terminates: Vec<Terminate>,
}

/// The variables that when-clauses assign.
pub fn assigned(whens: &[(Vec<WhenBranch>, Origin)], r: &Rewriting<'_>) -> FastSet<VarId> {
    let actions = whens.iter().flat_map(|(branches, _)| branches).flat_map(|b| &b.actions);
    let assigned = actions.filter_map(|action| match action {
        Action::Assign(v, _) => Some(r.representative(*v)?.variable),
        _ => None,
    });
    assigned.collect()
}

/// Lowers all when-clauses; assignments are added to `discrete`.
pub fn lower(
    whens: &[(Vec<WhenBranch>, Origin)],
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) -> WhenActions {
    let mut actions = WhenActions::default();
    let mut flags = 0;
    for (branches, origin) in whens {
        let mut earlier: Option<ExprId> = None;
        let mut assignments = Assignments::default();
        for branch in branches {
            let own = activation(&branch.conditions, &mut flags, origin, discrete, r);
            let active = match earlier {
                Some(before) => {
                    let not_before = r.graph.not(before);
                    r.graph.and(own, not_before)
                }
                None => own,
            };
            earlier = Some(match earlier {
                Some(before) => r.graph.or(before, own),
                None => own,
            });
            assignments.next_branch();
            for action in &branch.actions {
                match action {
                    Action::Assign(v, value) => assignments.add(*v, active, *value, origin, r),
                    other => lower_action(other, active, origin, &mut actions, r),
                }
            }
        }
        for (variable, branches) in assignments.list {
            let mut value = r.graph.pre(variable, r.variables[variable].ty);
            for (active, assigned) in branches.into_iter().rev() {
                value = r.graph.if_then_else(active, assigned, value);
            }
            discrete.push(variable, value, origin.clone(), r);
        }
    }
    actions
}

/// Makes an initial equation of each `reinit` in the first branch of a when-clause that is active at the start: the first
/// that has `initial()` among its conditions (section 8.6).
pub fn reinits_at_the_start(flat: &mut FlatModel) {
    let mut more = Vec::new();
    for equation in &flat.equations {
        let EquationKind::When(branches) = &equation.kind else { continue };
        let is_initial = |e: &ExprId| flat.graph.node(*e) == Node::Initial;
        let Some(first) = branches.iter().find(|b| b.conditions.iter().any(is_initial)) else {
            continue;
        };
        for action in &first.actions {
            if let Action::Reinit { state, value, guard: None } = action {
                more.push((*state, *value, equation.origin.clone()));
            }
        }
    }
    for (state, value, origin) in more {
        let own = flat.graph.var(state, Type::Real);
        flat.initial_equations.push(Equation { kind: EquationKind::Equal(own, value), origin });
    }
}

/// An assertion with its activation, both condition and message rewritten.
pub fn guarded(
    active: Option<ExprId>,
    assert: &Assert,
    origin: &Origin,
    r: &mut Rewriting<'_>,
) -> GuardedAssert {
    let condition = r.apply(assert.condition, RelationMode::Literal, origin);
    let message = r.apply(assert.message, RelationMode::Literal, origin);
    let assert = Assert { condition, message, level: assert.level };
    GuardedAssert { active, assert, origin: origin.clone() }
}

/// The values that one when-clause assigns: for each variable, by branch in order.
#[derive(Default)]
struct Assignments {
    list: Vec<(VarId, Vec<(ExprId, ExprId)>)>,
    place: FastMap<VarId, usize>,
    in_branch: FastSet<VarId>,
}

impl Assignments {
    fn next_branch(&mut self) {
        self.in_branch.clear();
    }

    fn add(
        &mut self,
        v: VarId,
        active: ExprId,
        value: ExprId,
        origin: &Origin,
        r: &mut Rewriting<'_>,
    ) {
        let value = r.apply(value, RelationMode::Literal, origin);
        let Some(signed) = r.representative(v) else { return };
        let variable = signed.variable;
        if !self.in_branch.insert(variable) {
            r.problems.push(error::assigned_twice(&r.variables[variable], origin, origin));
            return;
        }
        let place = *self.place.entry(variable).or_insert_with(|| {
            self.list.push((variable, Vec::new()));
            self.list.len() - 1
        });
        let value = if signed.negative { r.graph.neg(value) } else { value };
        self.list[place].1.push((active, value));
    }
}

/// True in the event iteration in which one of the conditions becomes true.
fn activation(
    conditions: &[ExprId],
    flags: &mut usize,
    origin: &Origin,
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) -> ExprId {
    let initial = r.graph.intern(Node::Initial, Type::Boolean);
    let mut edges = r.graph.boolean(false);
    let mut at_start = false;
    for &written in conditions {
        let condition = r.apply(written, RelationMode::Events, origin);
        // `initial()` wrapped by a function is an ordinary condition (Modelica 3.6, section 8.6).
        if condition == initial && !matches!(r.graph.node(written), Node::NoEvent(_)) {
            at_start = true;
            continue;
        }
        *flags += 1;
        let flag = r.add_flag(format!("$when{flags}"), origin.span);
        discrete.push(flag, condition, origin.clone(), r);
        let now = r.graph.var(flag, Type::Boolean);
        let before = r.graph.pre(flag, Type::Boolean);
        let not_before = r.graph.not(before);
        let edge = r.graph.and(now, not_before);
        edges = r.graph.or(edges, edge);
    }
    if at_start {
        return r.graph.or(initial, edges);
    }
    let running = r.graph.not(initial);
    r.graph.and(running, edges)
}

fn lower_action(
    action: &Action,
    active: ExprId,
    origin: &Origin,
    actions: &mut WhenActions,
    r: &mut Rewriting<'_>,
) {
    match action {
        Action::Assign(..) => {}
        Action::Reinit { state, value, guard } => {
            let value = r.apply(*value, RelationMode::Literal, origin);
            let is_state =
                |v: VarId| matches!(r.variables[v].kind, VariableKind::Differentiated { .. });
            let Some(signed) = r.representative(*state).filter(|s| is_state(s.variable)) else {
                r.problems.push(error::reinit_of_no_state(&r.variables[*state], origin));
                return;
            };
            let value = if signed.negative { r.graph.neg(value) } else { value };
            let active = guarded_activation(active, *guard, origin, r);
            let origin = origin.clone();
            actions.reinits.push(Reinit { active, state: signed.variable, value, origin });
        }
        Action::Assert(assert) => actions.asserts.push(guarded(Some(active), assert, origin, r)),
        Action::Terminate { message, guard } => {
            let message = r.apply(*message, RelationMode::Literal, origin);
            let active = guarded_activation(active, *guard, origin, r);
            actions.terminates.push(Terminate { active, message, origin: origin.clone() });
        }
    }
}

/// Whether an action is due: its branch is active and its own condition holds.
fn guarded_activation(
    active: ExprId,
    guard: Option<ExprId>,
    origin: &Origin,
    r: &mut Rewriting<'_>,
) -> ExprId {
    let Some(guard) = guard else { return active };
    let guard = r.apply(guard, RelationMode::Literal, origin);
    r.graph.and(active, guard)
}
