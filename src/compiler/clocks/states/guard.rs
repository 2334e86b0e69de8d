//! The equations of states: they act while their state is active, and what several states say about one variable is
//! merged (Modelica 3.6, sections 17.3.2, 17.3.5 and 17.3.6).

use super::{States, previous, previous_of};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::clocks::equal;
use crate::clocks::error::ClockCause;
use crate::clocks::expression::{clocked, is_unknown, variable};
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{ExprId, Type, VarId};
use crate::ir::flat::{Equation, EquationKind, FlatModel, Origin};
use crate::symbolic::rewrite::Rewriter;

/// What one state says about a variable.
struct Definition {
    state: String,
    active: VarId,
    value: ExprId,
    origin: Origin,
}

/// Rewrites all equations of states.
pub fn equations(flat: &mut FlatModel, states: &States, problems: &mut Vec<Diagnostic>) {
    bindings(flat, states);
    let mut guard = Guard { flat, states, definitions: Vec::new(), of: FastMap::default() };
    let written = std::mem::take(&mut guard.flat.equations);
    let written = guard.merged_connections(written);
    let mut kept = Vec::new();
    for e in written {
        let Some((name, _)) = states.around(&e.origin.component) else {
            kept.push(e);
            continue;
        };
        let name = name.to_owned();
        if let Some(e) = guard.equation(e, &name) {
            kept.push(e);
        }
    }
    guard.flat.equations = kept;
    for (v, list) in std::mem::take(&mut guard.definitions) {
        for (k, a) in list.iter().enumerate() {
            if let Some(b) = list[..k].iter().find(|b| !states.exclude(&a.state, &b.state)) {
                let name = guard.flat.variables[v].name.clone();
                problems.push(
                    Diagnostic::new(ClockCause::AssignedInParallelStates { name }, a.origin.span)
                        .also(b.origin.span, "determined here too"),
                );
            }
        }
        let mut value = guard.last(v);
        for d in list.iter().rev() {
            let active = guard.flat.graph.var(d.active, Type::Boolean);
            value = guard.flat.graph.if_then_else(active, d.value, value);
        }
        let read = guard.flat.read(v);
        // Outside of all states, so that nothing guards it again.
        let origin = Origin { span: list[0].origin.span, component: "".into() };
        guard.flat.equations.push(equal(read, value, &origin));
    }
}

/// Makes the bindings of variables in states equations.
fn bindings(flat: &mut FlatModel, states: &States) {
    for v in flat.variables.ids() {
        if flat.variables[v].binding.is_none()
            || !is_unknown(flat, v)
            || flat.variables[v].ty == Type::Clock
        {
            continue;
        }
        let variable = &mut flat.variables[v];
        let component = variable.name.rsplit_once('.').map_or("", |(path, _)| path);
        if states.around(component).is_none() {
            continue;
        }
        let origin = Origin { span: variable.span, component: component.into() };
        if let Some(value) = variable.binding.take() {
            let read = flat.read(v);
            flat.equations.push(equal(read, value, &origin));
        }
    }
}

struct Guard<'a> {
    flat: &'a mut FlatModel,
    states: &'a States,
    definitions: Vec<(VarId, Vec<Definition>)>,
    of: FastMap<VarId, usize>,
}

impl Guard<'_> {
    /// The state in which a variable is declared.
    fn home(&self, v: VarId) -> Option<(&str, &super::State)> {
        self.states.around(self.flat.variables[v].name.rsplit_once('.')?.0)
    }

    /// The value from the previous tick; the start value if the state of the variable starts anew.
    fn last(&mut self, v: VarId) -> ExprId {
        let ty = self.flat.variables[v].ty;
        let before = previous(&mut self.flat.graph, v, ty);
        let Some(reset) = self.home(v).map(|(_, state)| state.reset) else { return before };
        let start = match self.flat.variables[v].start {
            Some(start) => start,
            None => match ty {
                Type::Real => self.flat.graph.real(0.0),
                Type::Integer => self.flat.graph.integer(0),
                Type::Boolean => self.flat.graph.boolean(false),
                _ => return before,
            },
        };
        let reset = self.flat.graph.var(reset, Type::Boolean);
        self.flat.graph.if_then_else(reset, start, before)
    }

    /// An expression of a state: `previous` sees resets, and operators of states mean this one.
    fn within(&mut self, e: ExprId, state: &str) -> ExprId {
        let machine = self.states.by_name.get(state).map(|s| s.machine);
        let mut replacements: FastMap<ExprId, ExprId> = FastMap::default();
        for n in self.flat.graph.postorder([e]) {
            if let Some(v) = previous_of(&self.flat.graph, n) {
                let last = self.last(v);
                replacements.insert(n, last);
            } else if let (Some((op, _)), Some(k)) = (clocked(&self.flat.graph, n), machine) {
                let machine = &self.states.machines[k];
                match op {
                    ClockOperator::TicksInState => {
                        replacements.insert(n, machine.ticks(self.flat));
                    }
                    ClockOperator::TimeInState => {
                        replacements.insert(n, machine.time(self.flat));
                    }
                    _ => {}
                }
            }
        }
        Rewriter::new().apply(&mut self.flat.graph, e, &mut |_, n| replacements.get(&n).copied())
    }

    /// Collects an equation that defines a variable; others are returned as they hold in any state.
    fn equation(&mut self, e: Equation, state: &str) -> Option<Equation> {
        let active = self.states.by_name.get(state)?.active;
        let Equation { kind, origin } = e;
        let kind = match kind {
            EquationKind::Equal(lhs, rhs) => {
                let [a, b] = [lhs, rhs].map(|e| variable(&self.flat.graph, e));
                let local = |g: &Self, v: Option<VarId>| {
                    v.is_some_and(|v| g.home(v).is_some_and(|(name, _)| name == state))
                };
                let unknown = |g: &Self, v: Option<VarId>| v.filter(|v| is_unknown(g.flat, *v));
                let (a, b) = (unknown(self, a), unknown(self, b));
                // Equal variables of one state rest together.
                if !(local(self, a) && local(self, b)) {
                    let target = match (a, b) {
                        // An output of the state, which is declared around it.
                        (Some(a), Some(b))
                            if self.of.contains_key(&a) && self.is_free(b, state) =>
                        {
                            Some((b, lhs))
                        }
                        (Some(a), _) => Some((a, rhs)),
                        (None, Some(b)) => Some((b, lhs)),
                        (None, None) => None,
                    };
                    if let Some((v, value)) = target {
                        let value = self.within(value, state);
                        self.define(
                            v,
                            Definition { state: state.to_owned(), active, value, origin },
                        );
                        return None;
                    }
                }
                EquationKind::Equal(self.within(lhs, state), self.within(rhs, state))
            }
            EquationKind::Algorithm { outputs, values } => {
                for (v, value) in outputs.into_iter().zip(values) {
                    let value = self.within(value, state);
                    let origin = origin.clone();
                    self.define(v, Definition { state: state.to_owned(), active, value, origin });
                }
                return None;
            }
            EquationKind::Assert(mut assert) => {
                let condition = self.within(assert.condition, state);
                let active = self.flat.graph.var(active, Type::Boolean);
                let rests = self.flat.graph.not(active);
                assert.condition = self.flat.graph.or(rests, condition);
                EquationKind::Assert(assert)
            }
            when @ EquationKind::When(_) => when,
        };
        Some(Equation { kind, origin })
    }

    /// Whether no equation of this state has defined a variable yet.
    fn is_free(&self, v: VarId, state: &str) -> bool {
        let list = self.of.get(&v).map(|k| &self.definitions[*k].1);
        list.is_none_or(|list| list.iter().all(|d| d.state != state))
    }

    fn define(&mut self, v: VarId, definition: Definition) {
        match self.of.get(&v) {
            Some(&k) => self.definitions[k].1.push(definition),
            None => {
                self.of.insert(v, self.definitions.len());
                self.definitions.push((v, vec![definition]));
            }
        }
    }

    /// Merges the outputs of states that are connected to one input (section 17.3.6).
    fn merged_connections(&mut self, equations: Vec<Equation>) -> Vec<Equation> {
        // Outputs: variables of states that equations of these states define.
        let mut outputs: FastSet<VarId> = FastSet::default();
        for e in &equations {
            if let EquationKind::Equal(lhs, rhs) = e.kind {
                for side in [lhs, rhs] {
                    if let Some(v) = variable(&self.flat.graph, side)
                        && let Some((home, _)) = self.home(v)
                        && self.states.around(&e.origin.component).is_some_and(|(s, _)| s == home)
                    {
                        outputs.insert(v);
                    }
                }
            }
        }
        let pair = |g: &Self, e: &Equation| match e.kind {
            EquationKind::Equal(lhs, rhs) => {
                let a = variable(&g.flat.graph, lhs).filter(|v| is_unknown(g.flat, *v))?;
                let b = variable(&g.flat.graph, rhs).filter(|v| is_unknown(g.flat, *v))?;
                let around = g.states.around(&e.origin.component).map(|(s, _)| s);
                let outside = |v| g.home(v).map(|(s, _)| s) != around;
                (outside(a) || outside(b)).then_some((a, b))
            }
            _ => None,
        };
        let mut sets: Vec<(Vec<VarId>, Vec<usize>)> = Vec::new();
        for (k, e) in equations.iter().enumerate() {
            let Some((a, b)) = pair(self, e) else { continue };
            let mut joined = (vec![a, b], vec![k]);
            let mut s = 0;
            while s < sets.len() {
                if sets[s].0.contains(&a) || sets[s].0.contains(&b) {
                    let (vars, rows) = sets.remove(s);
                    joined.0.extend(vars);
                    joined.1.extend(rows);
                } else {
                    s += 1;
                }
            }
            sets.push(joined);
        }
        let mut dropped: FastSet<usize> = FastSet::default();
        let mut added = Vec::new();
        for (mut vars, rows) in sets {
            vars.sort_unstable();
            vars.dedup();
            let (sources, targets): (Vec<VarId>, Vec<VarId>) =
                vars.into_iter().partition(|v| outputs.contains(v) && self.home(*v).is_some());
            if sources.len() < 2 || targets.is_empty() {
                continue;
            }
            let origin = equations[rows[0]].origin.clone();
            dropped.extend(rows);
            let ty = self.flat.variables[targets[0]].ty;
            let mut value = previous(&mut self.flat.graph, targets[0], ty);
            for v in sources.into_iter().rev() {
                let Some(active) = self.home(v).map(|(_, s)| s.active) else { continue };
                let active = self.flat.graph.var(active, Type::Boolean);
                let read = self.flat.read(v);
                value = self.flat.graph.if_then_else(active, read, value);
            }
            let first = self.flat.read(targets[0]);
            added.push(equal(first, value, &origin));
            for v in &targets[1..] {
                let read = self.flat.read(*v);
                added.push(equal(read, first, &origin));
            }
        }
        let kept = equations.into_iter().enumerate().filter(|(k, _)| !dropped.contains(k));
        let mut kept: Vec<Equation> = kept.map(|(_, e)| e).collect();
        kept.append(&mut added);
        kept
    }
}
