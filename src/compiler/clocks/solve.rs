//! Clocked partitions as when-clauses: each variable is assigned by the equation that determines it.
//!
//! Equations that must be solved together, or are not linear in their variable, become continuous equations of
//! auxiliary variables whose other operands change only at ticks; the when-clause reads their solution.

use super::error::ClockCause;
use super::expression::{clocked, read, variable};
use super::partition::{Partitions, node_of};
use super::ticks::Tick;
use super::{Item, add_discrete, add_variable, discretize, equal};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, Id, IndexVec};
use crate::graph::bipartite::{Bipartite, Col, Edge};
use crate::graph::matching::{Matching, maximum_preferring};
use crate::graph::scc;
use crate::ir::ast::Causality;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{
    Action, Assert, Equation, EquationKind, FlatModel, Origin, Variability, WhenBranch,
};
use crate::symbolic::gradient::Leaf;
use crate::symbolic::linear;
use crate::symbolic::rewrite::Rewriter;

/// An equation of a partition, without operators of clocks.
pub struct Clocked {
    pub lhs: ExprId,
    pub rhs: ExprId,
    pub origin: Origin,
    /// The variable, if it takes its value from another partition.
    pub input: Option<VarId>,
}

/// A sub-clock partition.
#[derive(Default)]
pub struct System {
    pub equations: Vec<Clocked>,
    pub asserts: Vec<Assert>,
    pub variables: Vec<VarId>,
}

/// Puts the equations back as they are.
pub fn restore(flat: &mut FlatModel, items: Vec<Item>) {
    for item in items {
        match (item.binding_of, &item.equation.kind) {
            (Some(v), EquationKind::Equal(_, value)) => flat.variables[v].binding = Some(*value),
            _ => flat.equations.push(item.equation),
        }
    }
}

/// Replaces clocked partitions by when-clauses and gives the rest back to the model.
pub fn replace(
    flat: &mut FlatModel,
    items: Vec<Item>,
    parts: &Partitions,
    mut ticks: FastMap<usize, Tick>,
    problems: &mut Vec<Diagnostic>,
) {
    let mut systems: FastMap<usize, System> = FastMap::default();
    let mut order = Vec::new();
    for v in flat.variables.ids().take(parts.node_of_item(0)) {
        let sub = parts.sub(node_of(v));
        let x = &flat.variables[v];
        let free = x.causality == Some(Causality::Input);
        if x.ty != Type::Clock && !free && parts.is_clocked(sub) {
            systems.entry(sub).or_insert_with(|| {
                order.push(sub);
                System::default()
            });
            systems.entry(sub).or_default().variables.push(v);
        }
    }
    let mut rest = Vec::new();
    for (k, item) in items.into_iter().enumerate() {
        let sub = parts.sub(parts.node_of_item(k));
        if !parts.is_clocked(sub) {
            rest.push(item);
            continue;
        }
        let Some(tick) = ticks.get_mut(&sub) else { continue };
        if !systems.contains_key(&sub) {
            order.push(sub);
        }
        take(flat, item.equation, tick, systems.entry(sub).or_default());
    }
    // Numbers of partitions are those of their first nodes, which keeps the order of the source.
    order.sort_unstable();
    order.dedup();
    for sub in order {
        let (Some(mut system), Some(mut tick)) = (systems.remove(&sub), ticks.remove(&sub)) else {
            continue;
        };
        discretize::replace(flat, sub, parts, &mut tick, &mut system, problems);
        emit(flat, tick, system, problems);
    }
    restore(flat, rest);
    initial_values(flat, parts, problems);
    let mut rewriter = Rewriter::new();
    flat.map_expressions(&mut |graph, e| {
        rewriter.apply(graph, e, &mut |g, n| match clocked(g, n) {
            Some((ClockOperator::Hold, args)) => Some(args[0]),
            _ => None,
        })
    });
}

/// Adds an equation to its partition.
fn take(flat: &mut FlatModel, equation: Equation, tick: &mut Tick, system: &mut System) {
    let origin = equation.origin;
    match equation.kind {
        EquationKind::Equal(lhs, rhs) => {
            if [lhs, rhs].iter().any(|e| flat.graph.ty(*e) == Type::Clock) {
                return;
            }
            let foreign = [(lhs, rhs), (rhs, lhs)].into_iter().find_map(|(v, e)| {
                let (op, _) = clocked(&flat.graph, e)?;
                (op.converts() || op == ClockOperator::Sample)
                    .then(|| variable(&flat.graph, v))
                    .flatten()
            });
            let [lhs, rhs] = [lhs, rhs].map(|e| plain(flat, e, tick));
            system.equations.push(Clocked { lhs, rhs, origin, input: foreign });
        }
        EquationKind::Algorithm { outputs, values } => {
            for (v, value) in outputs.into_iter().zip(values) {
                let (lhs, rhs) = (flat.read(v), plain(flat, value, tick));
                system.equations.push(Clocked { lhs, rhs, origin: origin.clone(), input: None });
            }
        }
        EquationKind::Assert(mut assert) => {
            assert.condition = plain(flat, assert.condition, tick);
            assert.message = plain(flat, assert.message, tick);
            system.asserts.push(assert);
        }
        EquationKind::When(_) => {}
    }
}

/// The expression without operators of clocks, as it is read at a tick.
fn plain(flat: &mut FlatModel, root: ExprId, tick: &mut Tick) -> ExprId {
    let mut done: FastMap<ExprId, ExprId> = FastMap::default();
    let mut operands = Vec::new();
    for e in flat.graph.postorder([root]) {
        operands.clear();
        flat.graph.for_each_operand(e, |a| operands.push(done[&a]));
        let new = match flat.graph.node(e) {
            Node::Clocked(op, _) => match op {
                ClockOperator::Sample | ClockOperator::Previous => {
                    match variable(&flat.graph, operands[0]) {
                        Some(v) => flat.graph.pre(v, flat.variables[v].ty),
                        None => operands[0],
                    }
                }
                ClockOperator::FirstTick => tick.first(flat),
                ClockOperator::Elapsed => tick.elapsed(flat),
                _ => operands.first().copied().unwrap_or(e),
            },
            _ => flat.graph.rebuild(e, &operands),
        };
        done.insert(e, new);
    }
    done[&root]
}

/// Adds the when-clause of a partition.
fn emit(flat: &mut FlatModel, mut tick: Tick, system: System, problems: &mut Vec<Diagnostic>) {
    for &v in &system.variables {
        let variable = &mut flat.variables[v];
        variable.variability = Variability::Discrete;
        variable.binding = None;
        variable.fixed = Some(true);
    }
    let mut actions = assignments(flat, &mut tick, &system, problems);
    actions.append(&mut tick.actions);
    actions.extend(system.asserts.into_iter().map(Action::Assert));
    if actions.is_empty() {
        return;
    }
    let branch = WhenBranch { conditions: tick.conditions, actions };
    let kind = EquationKind::When(vec![branch]);
    flat.equations.push(Equation { kind, origin: tick.origin });
}

fn assignments(
    flat: &mut FlatModel,
    tick: &mut Tick,
    system: &System,
    problems: &mut Vec<Diagnostic>,
) -> Vec<Action> {
    let columns: FastMap<VarId, Col> =
        system.variables.iter().enumerate().map(|(k, v)| (*v, Col::from_usize(k))).collect();
    let mut graph: Bipartite = Bipartite::new(columns.len());
    let mut costs: IndexVec<Edge, Option<u8>> = IndexVec::new();
    for e in &system.equations {
        let cols = read(&flat.graph, [e.lhs, e.rhs]).into_iter().filter_map(|v| columns.get(&v));
        let row = graph.push_row(cols.copied());
        for &col in graph.cols(row) {
            let v = system.variables[col.idx()];
            let real = flat.variables[v].ty == Type::Real;
            costs.push(match explicit(flat, e, v).is_some() {
                true => Some(0),
                false => real.then_some(1),
            });
        }
    }
    let matching = maximum_preferring(&graph, &costs, Matching::empty(&graph));
    let mut complete = true;
    for row in matching.free_rows() {
        complete = false;
        let place = system.equations[row.idx()].origin.span;
        problems.push(Diagnostic::new(ClockCause::Overdetermined, place));
    }
    for col in matching.free_cols() {
        complete = false;
        let variable = &flat.variables[system.variables[col.idx()]];
        let cause = ClockCause::Undetermined { name: variable.name.clone() };
        problems.push(Diagnostic::new(cause, variable.span));
    }
    if !complete {
        return Vec::new();
    }
    let mut frozen = Frozen::default();
    let mut actions = Vec::new();
    for block in scc::blocks(&graph, &matching).iter() {
        if let [(row, col)] = block {
            let (e, v) = (&system.equations[row.idx()], system.variables[col.idx()]);
            if let Some(value) = explicit(flat, e, v).or_else(|| linear(flat, e, v)) {
                actions.push(Action::Assign(v, value));
                continue;
            }
        }
        let unknowns: Vec<VarId> = block.iter().map(|(_, c)| system.variables[c.idx()]).collect();
        if unknowns.iter().any(|v| flat.variables[*v].ty != Type::Real) {
            let names: Vec<&str> =
                unknowns.iter().map(|v| flat.variables[*v].name.as_str()).collect();
            let cause = ClockCause::DiscreteLoop { names: names.join(", ") };
            let place = system.equations[block[0].0.idx()].origin.span;
            problems.push(Diagnostic::new(cause, place));
            continue;
        }
        let equations = block.iter().map(|(r, _)| &system.equations[r.idx()]);
        solve_together(flat, equations, &unknowns, &mut frozen, &mut actions, &tick.origin);
    }
    actions.append(&mut frozen.actions);
    actions
}

/// The value of a variable that is alone on one side, possibly negated.
fn explicit(flat: &mut FlatModel, e: &Clocked, v: VarId) -> Option<ExprId> {
    for (side, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
        let (alone, negation) = match flat.graph.node(side) {
            Node::Unary(op @ (Unary::Not | Unary::Neg), a) => (a, Some(op)),
            _ => (side, None),
        };
        if variable(&flat.graph, alone) == Some(v)
            && !flat.graph.any([other], |_, node| node == Node::Var(v))
        {
            return Some(match negation {
                Some(op) => flat.graph.unary(op, other),
                None => other,
            });
        }
    }
    None
}

/// The value of a Real variable in which the equation is linear.
fn linear(flat: &mut FlatModel, e: &Clocked, v: VarId) -> Option<ExprId> {
    if flat.variables[v].ty != Type::Real {
        return None;
    }
    let residual = flat.graph.sub(e.lhs, e.rhs);
    let (slope, rest) = linear::split(&mut flat.graph, residual, Leaf::Var(v))?;
    if flat.graph.as_number(slope) == Some(0.0) {
        return None;
    }
    let quotient = flat.graph.div(rest, slope);
    Some(flat.graph.neg(quotient))
}

/// Values that a when-clause stores for equations that hold between its ticks.
#[derive(Default)]
struct Frozen {
    stored: FastMap<ExprId, ExprId>,
    actions: Vec<Action>,
}

impl Frozen {
    /// What changes besides at ticks, as a variable that does not.
    fn value(&mut self, flat: &mut FlatModel, e: ExprId, origin: &Origin) -> Option<ExprId> {
        let start = match flat.graph.node(e) {
            Node::Pre(v) => flat.variables[v].start,
            Node::Time => None,
            _ => return None,
        };
        if let Some(known) = self.stored.get(&e) {
            return Some(*known);
        }
        let name = format!("$stored{}", flat.variables.len());
        let v = add_discrete(flat, name, flat.graph.ty(e), start, origin);
        self.actions.push(Action::Assign(v, e));
        let read = flat.read(v);
        self.stored.insert(e, read);
        Some(read)
    }
}

fn solve_together<'e>(
    flat: &mut FlatModel,
    equations: impl Iterator<Item = &'e Clocked>,
    unknowns: &[VarId],
    frozen: &mut Frozen,
    actions: &mut Vec<Action>,
    origin: &Origin,
) {
    let mut solution: FastMap<VarId, ExprId> = FastMap::default();
    for &v in unknowns {
        let (name, model) =
            (format!("$solve.{}", flat.variables[v].name), flat.variables[v].clone());
        let own = add_variable(flat, name, Type::Real, origin);
        let x = &mut flat.variables[own];
        (x.start, x.min, x.max, x.nominal) = (model.start, model.min, model.max, model.nominal);
        let read = flat.read(own);
        solution.insert(v, read);
        actions.push(Action::Assign(v, read));
    }
    for e in equations {
        let sides = [e.lhs, e.rhs].map(|side| {
            for n in flat.graph.postorder([side]) {
                frozen.value(flat, n, origin);
            }
            Rewriter::new().apply(&mut flat.graph, side, &mut |g, n| match g.node(n) {
                Node::Var(v) => solution.get(&v).copied(),
                _ => frozen.stored.get(&n).copied(),
            })
        });
        flat.equations.push(equal(sides[0], sides[1], &e.origin));
    }
}

/// Initial equations of clocked variables that are start values become these; others are errors.
fn initial_values(flat: &mut FlatModel, parts: &Partitions, problems: &mut Vec<Diagnostic>) {
    let count = parts.node_of_item(0);
    let is_clocked = |v: VarId| node_of(v) < count && parts.is_clocked(node_of(v));
    let list = std::mem::take(&mut flat.initial_equations);
    for e in list {
        let EquationKind::Equal(lhs, rhs) = e.kind else {
            flat.initial_equations.push(e);
            continue;
        };
        let concerned = flat.graph.any(
            [lhs, rhs],
            |_, node| matches!(node, Node::Var(v) | Node::Pre(v) | Node::Der(v) if is_clocked(v)),
        );
        if !concerned {
            flat.initial_equations.push(e);
            continue;
        }
        let value = [(lhs, rhs), (rhs, lhs)].into_iter().find_map(|(side, value)| {
            let v = match flat.graph.node(side) {
                Node::Var(v) | Node::Pre(v) => v,
                _ => return None,
            };
            super::expression::is_fixed(flat, value).then_some((v, value))
        });
        match value {
            Some((v, value)) => flat.variables[v].start = Some(value),
            None => {
                problems.push(Diagnostic::new(ClockCause::ClockedInitialEquation, e.origin.span))
            }
        }
    }
}
