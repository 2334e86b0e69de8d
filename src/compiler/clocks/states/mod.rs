//! State machines as clocked equations (Modelica 3.6, chapter 17).
//!
//! [`machine`] writes the equations of section 17.3.4 for each state machine, which say which of its states is active
//! and which of them are reset. [`guard`] lets the equations of a state act only while it is active, and merges what
//! several states say about one variable.
mod guard;
mod machine;

use std::sync::Arc;

use super::error::ClockCause;
use super::expression::clocked;
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Const, ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Origin, Transition};
use machine::Machine;

/// A state: the machine that it belongs to, its number there, counted from 1, and the variables that say whether it
/// is active and whether it starts anew at this tick.
#[derive(Clone)]
struct State {
    machine: usize,
    number: i64,
    active: VarId,
    reset: VarId,
}

/// All state machines of a model.
#[derive(Default)]
struct States {
    machines: Vec<Machine>,
    by_name: FastMap<Arc<str>, State>,
}

impl States {
    /// The innermost state that holds a component or variable.
    fn around(&self, path: &str) -> Option<(&str, &State)> {
        let mut at = path;
        loop {
            if let Some((name, state)) = self.by_name.get_key_value(at) {
                return Some((name, state));
            }
            at = at.rsplit_once('.')?.0;
        }
    }

    /// The state around another one.
    fn parent(&self, state: &str) -> Option<(&str, &State)> {
        self.around(state.rsplit_once('.')?.0)
    }

    /// Whether two states are never active at the same tick.
    fn exclude(&self, a: &str, b: &str) -> bool {
        let chain = |state: &str| {
            let mut found = Vec::new();
            let mut at = self.around(state);
            while let Some((name, s)) = at {
                found.push((s.machine, s.number));
                at = self.parent(name);
            }
            found
        };
        let others = chain(b);
        chain(a).iter().any(|(m, k)| others.iter().any(|(n, l)| m == n && k != l))
    }
}

/// Replaces state machines by equations.
pub fn elaborate(flat: &mut FlatModel, problems: &mut Vec<Diagnostic>) {
    let transitions = std::mem::take(&mut flat.transitions);
    let initial = std::mem::take(&mut flat.initial_states);
    let mut states = States::default();
    for (transitions, names) in clusters(transitions, &initial) {
        let starts: Vec<_> = initial.iter().filter(|(s, _)| names.contains(s)).collect();
        let [(start, _)] = starts.as_slice() else {
            let span = match transitions.first() {
                Some(t) => t.origin.span,
                None => initial.first().map_or(flat.span, |i| i.1),
            };
            let text: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
            let cause = ClockCause::InitialStates { states: text.join(", "), count: starts.len() };
            problems.push(Diagnostic::new(cause, span));
            continue;
        };
        let mut ordered = vec![start.clone()];
        ordered.extend(names.into_iter().filter(|n| n != start));
        let span = starts[0].1;
        let machine = states.machines.len();
        states.machines.push(Machine::new(flat, machine, &ordered, transitions, span, problems));
        for (k, name) in ordered.into_iter().enumerate() {
            let machine_of = &states.machines[machine];
            let (active, reset) = (machine_of.is_active[k], machine_of.is_reset[k]);
            let state = State { machine, number: k as i64 + 1, active, reset };
            states.by_name.insert(name, state);
        }
    }
    if !states.machines.is_empty() {
        join_inner_outer(flat);
    }
    for k in 0..states.machines.len() {
        machine::equations(flat, &states, k);
    }
    if !states.machines.is_empty() {
        guard::equations(flat, &states, problems);
    }
    queries(flat, &states, problems);
}

/// Lets states mean the outermost variable where they say `inner outer` (section 17.3.5).
fn join_inner_outer(flat: &mut FlatModel) {
    let outer: FastMap<VarId, VarId> = std::mem::take(&mut flat.inner_outer).into_iter().collect();
    if outer.is_empty() {
        return;
    }
    let outermost = |mut v: VarId| {
        while let Some(next) = outer.get(&v) {
            v = *next;
        }
        v
    };
    let mut rewriter = crate::symbolic::rewrite::Rewriter::new();
    flat.map_expressions(&mut |graph, e| {
        rewriter.apply(graph, e, &mut |g, n| match g.node(n) {
            Node::Var(v) if outer.contains_key(&v) => {
                let ty = g.ty(n);
                Some(g.var(outermost(v), ty))
            }
            _ => None,
        })
    });
    for e in &mut flat.equations {
        if let EquationKind::Algorithm { outputs, .. } = &mut e.kind {
            outputs.iter_mut().for_each(|v| *v = outermost(*v));
        }
    }
    let mut inner: Vec<VarId> = outer.keys().copied().collect();
    inner.sort_unstable();
    for v in inner {
        let read = flat.read(v);
        let value = flat.read(outermost(v));
        flat.equations.push(super::equal(read, value, &place(flat.variables[v].span)));
    }
}

/// The transitions of each state machine, with its states in alphabetic order.
fn clusters(
    transitions: Vec<Transition>,
    initial: &[(Arc<str>, crate::base::source::Span)],
) -> Vec<(Vec<Transition>, Vec<Arc<str>>)> {
    let mut found: Vec<(Vec<Transition>, Vec<Arc<str>>)> = Vec::new();
    for t in transitions {
        let mut joined = (Vec::new(), vec![t.from.clone(), t.to.clone()]);
        let mut k = 0;
        while k < found.len() {
            if found[k].1.iter().any(|s| *s == t.from || *s == t.to) {
                let (mut list, mut names) = found.remove(k);
                joined.0.append(&mut list);
                joined.1.append(&mut names);
            } else {
                k += 1;
            }
        }
        joined.0.push(t);
        found.push(joined);
    }
    for (state, _) in initial {
        if !found.iter().any(|(_, names)| names.contains(state)) {
            found.push((Vec::new(), vec![state.clone()]));
        }
    }
    for (_, names) in &mut found {
        names.sort();
        names.dedup();
    }
    found
}

/// Replaces `activeState(state)`; what is left of the other operators of states is outside of state machines.
fn queries(flat: &mut FlatModel, states: &States, problems: &mut Vec<Diagnostic>) {
    let span = flat.span;
    let mut rewriter = crate::symbolic::rewrite::Rewriter::new();
    let mut outside: Vec<&'static str> = Vec::new();
    flat.map_expressions(&mut |graph, e| {
        rewriter.apply(graph, e, &mut |g, n| {
            let (op, args) = clocked(g, n)?;
            match op {
                ClockOperator::ActiveState => {
                    let Some(Const::String(name)) = g.as_const(args[0]) else { return None };
                    match states.by_name.get(name.as_str()) {
                        Some(state) => Some(g.var(state.active, Type::Boolean)),
                        None => {
                            outside.push(op.name());
                            Some(g.boolean(false))
                        }
                    }
                }
                ClockOperator::TicksInState | ClockOperator::TimeInState => {
                    outside.push(op.name());
                    None
                }
                _ => None,
            }
        })
    });
    outside.dedup();
    for operator in outside {
        let cause = ClockCause::OutsideOfStateMachine { operator: operator.to_owned() };
        problems.push(Diagnostic::new(cause, span));
    }
}

/// `previous(v)`
fn previous(graph: &mut Graph, v: VarId, ty: Type) -> ExprId {
    let read = graph.var(v, ty);
    graph.clocked(ClockOperator::Previous, &[read], ty)
}

/// The variable of `previous(v)`.
fn previous_of(graph: &Graph, e: ExprId) -> Option<VarId> {
    let (op, args) = clocked(graph, e)?;
    match (op, graph.node(*args.first()?)) {
        (ClockOperator::Previous, Node::Var(v)) => Some(v),
        _ => None,
    }
}

/// A place without a component.
fn place(span: crate::base::source::Span) -> Origin {
    Origin { span, component: "".into() }
}
