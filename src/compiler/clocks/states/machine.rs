//! The equations that say which state of a state machine is active (Modelica 3.6, section 17.3.4).

use std::sync::Arc;

use super::{States, place, previous};
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::clocks::error::ClockCause;
use crate::clocks::expression::clocked;
use crate::clocks::{add_variable, equal};
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Binary, ExprId, Type, VarId};
use crate::ir::flat::{FlatModel, Transition};
use crate::symbolic::rewrite::Rewriter;

/// A state machine with the variables of its semantics, named as in the specification.
pub struct Machine {
    states: Vec<Arc<str>>,
    /// The more urgent a transition is, the later it comes.
    transitions: Vec<Transition>,
    span: Span,
    active: VarId,
    reset: VarId,
    active_state: VarId,
    active_reset: VarId,
    next_state: VarId,
    next_reset: VarId,
    fired: VarId,
    delayed: VarId,
    entered: VarId,
    ticks: VarId,
    since: VarId,
    active_reset_states: Vec<VarId>,
    next_reset_states: Vec<VarId>,
    /// Whether each state is active at this tick.
    pub is_active: Vec<VarId>,
    /// Whether each state starts anew at this tick.
    pub is_reset: Vec<VarId>,
}

impl Machine {
    /// A machine whose first state is the initial one.
    pub fn new(
        flat: &mut FlatModel,
        number: usize,
        states: &[Arc<str>],
        mut transitions: Vec<Transition>,
        span: Span,
        problems: &mut Vec<Diagnostic>,
    ) -> Machine {
        transitions.sort_by_key(|t| std::cmp::Reverse(t.priority));
        for (k, t) in transitions.iter().enumerate() {
            let same = |u: &&Transition| u.from == t.from && u.priority == t.priority;
            if transitions[..k].iter().any(|u| same(&u)) {
                let (state, priority) = (t.from.to_string(), t.priority);
                let cause = ClockCause::EqualPriorities { state, priority };
                problems.push(Diagnostic::new(cause, t.origin.span));
            }
        }
        let mut variable = |name: &str, ty: Type, start: Option<i64>| {
            let full = format!("$machine{}.{name}", number + 1);
            let v = add_variable(flat, full, ty, &place(span));
            flat.variables[v].start = start.map(|n| match ty {
                Type::Boolean => flat.graph.boolean(n != 0),
                _ => flat.graph.integer(n),
            });
            v
        };
        let mut of_states = |name: &str, start: Option<i64>| -> Vec<VarId> {
            let all = states.iter();
            all.map(|s| variable(&format!("{name}.{s}"), Type::Boolean, start)).collect()
        };
        let active_reset_states = of_states("activeResetStates", None);
        let next_reset_states = of_states("nextResetStates", None);
        let is_active = of_states("isActive", None);
        let is_reset = of_states("isReset", None);
        Machine {
            states: states.to_vec(),
            transitions,
            span,
            active: variable("active", Type::Boolean, Some(0)),
            reset: variable("reset", Type::Boolean, None),
            active_state: variable("activeState", Type::Integer, Some(1)),
            active_reset: variable("activeReset", Type::Boolean, None),
            next_state: variable("nextState", Type::Integer, Some(1)),
            next_reset: variable("nextReset", Type::Boolean, None),
            fired: variable("fired", Type::Integer, None),
            delayed: variable("delayed", Type::Integer, Some(0)),
            entered: variable("entered", Type::Boolean, None),
            ticks: variable("ticksInState", Type::Integer, Some(0)),
            since: variable("enteredAt", Type::Real, None),
            active_reset_states,
            next_reset_states,
            is_active,
            is_reset,
        }
    }

    fn number(&self, state: &str) -> i64 {
        self.states.iter().position(|s| **s == *state).map_or(0, |k| k as i64 + 1)
    }

    /// `ticksInState()`
    pub fn ticks(&self, flat: &mut FlatModel) -> ExprId {
        flat.read(self.ticks)
    }

    /// `timeInState()`
    pub fn time(&self, flat: &mut FlatModel) -> ExprId {
        let (now, since) = (now(flat), flat.read(self.since));
        flat.graph.sub(now, since)
    }
}

/// Time at a tick: its left limit, which is the same.
fn now(flat: &mut FlatModel) -> ExprId {
    let time = flat.graph.time();
    flat.graph.clocked(ClockOperator::Sample, &[time], Type::Real)
}

/// Adds the equations of a machine.
pub fn equations(flat: &mut FlatModel, states: &States, k: usize) {
    Writer { flat, states, m: &states.machines[k] }.write();
}

struct Writer<'a> {
    flat: &'a mut FlatModel,
    states: &'a States,
    m: &'a Machine,
}

impl Writer<'_> {
    fn define(&mut self, v: VarId, value: ExprId) {
        let read = self.flat.read(v);
        self.flat.equations.push(equal(read, value, &place(self.m.span)));
    }

    fn previous(&mut self, v: VarId) -> ExprId {
        let ty = self.flat.variables[v].ty;
        previous(&mut self.flat.graph, v, ty)
    }

    fn is(&mut self, e: ExprId, number: i64) -> ExprId {
        let number = self.flat.graph.integer(number);
        self.flat.graph.binary(Binary::Equal, e, number)
    }

    /// Whether all state machines directly in a state have reached final states.
    fn finished(&mut self, state: &str) -> ExprId {
        let mut all = self.flat.graph.boolean(true);
        for machine in &self.states.machines {
            let inside = machine.states.first().and_then(|s| self.states.parent(s));
            if inside.is_none_or(|(name, _)| name != state) {
                continue;
            }
            let mut done = self.flat.graph.boolean(false);
            for (s, active) in machine.states.iter().zip(&machine.is_active) {
                if machine.transitions.iter().all(|t| t.from != *s) {
                    let active = self.flat.read(*active);
                    done = self.flat.graph.or(done, active);
                }
            }
            all = self.flat.graph.and(all, done);
        }
        all
    }

    fn write(&mut self) {
        let m = self.m;
        let (active, reset) = match m.states.first().and_then(|s| self.states.parent(s)) {
            Some((_, parent)) => {
                let [active, reset] = [parent.active, parent.reset].map(|v| self.flat.read(v));
                (active, self.flat.graph.and(active, reset))
            }
            None => {
                let yes = self.flat.graph.boolean(true);
                let first = self.flat.graph.clocked(ClockOperator::FirstTick, &[], Type::Boolean);
                (yes, first)
            }
        };
        self.define(m.active, active);
        self.define(m.reset, reset);
        let [active, reset] = [m.active, m.reset].map(|v| self.flat.read(v));
        let [yes, no] = [true, false].map(|b| self.flat.graph.boolean(b));
        let [zero, one] = [0, 1].map(|n| self.flat.graph.integer(n));

        let before = self.previous(m.next_state);
        let selected = self.flat.graph.if_then_else(reset, one, before);
        let before = self.previous(m.next_reset);
        let selected_reset = self.flat.graph.if_then_else(reset, yes, before);
        let (mut immediate, mut delayed) = (zero, zero);
        let next_state = self.flat.read(m.next_state);
        for (k, t) in m.transitions.iter().enumerate() {
            let from = m.number(&t.from);
            let mut condition = self.condition(t, reset);
            if t.synchronize {
                let finished = self.finished(&t.from);
                condition = self.flat.graph.and(condition, finished);
            }
            let at = if t.immediate { selected } else { next_state };
            let at = self.is(at, from);
            let fires = self.flat.graph.and(at, condition);
            let index = self.flat.graph.integer(k as i64 + 1);
            let which = if t.immediate { &mut immediate } else { &mut delayed };
            *which = self.flat.graph.if_then_else(fires, index, *which);
        }
        self.define(m.delayed, delayed);
        let before = self.previous(m.delayed);
        let largest = self.flat.graph.binary(Binary::Max, before, immediate);
        // While the machine rests, nothing fires; what was decided before fires when it goes on.
        let not_reset = self.flat.graph.not(reset);
        let may_fire = self.flat.graph.and(active, not_reset);
        let at_start = self.flat.graph.and(active, reset);
        let fired = self.flat.graph.if_then_else(at_start, immediate, zero);
        let fired = self.flat.graph.if_then_else(may_fire, largest, fired);
        self.define(m.fired, fired);
        let fired = self.flat.read(m.fired);

        let (mut state, mut state_reset) = (selected, selected_reset);
        for (k, t) in m.transitions.iter().enumerate() {
            let this = self.is(fired, k as i64 + 1);
            let to = self.flat.graph.integer(m.number(&t.to));
            let resets = self.flat.graph.boolean(t.reset);
            state = self.flat.graph.if_then_else(this, to, state);
            state_reset = self.flat.graph.if_then_else(this, resets, state_reset);
        }
        self.define(m.active_state, state);
        let state_reset = self.flat.graph.or(reset, state_reset);
        self.define(m.active_reset, state_reset);
        let [active_state, active_reset] =
            [m.active_state, m.active_reset].map(|v| self.flat.read(v));
        let before = self.previous(m.next_state);
        let next = self.flat.graph.if_then_else(active, active_state, before);
        self.define(m.next_state, next);
        let before = self.previous(m.next_reset);
        let next = self.flat.graph.if_then_else(active, no, before);
        self.define(m.next_reset, next);

        for k in 0..m.states.len() {
            let this = self.is(active_state, k as i64 + 1);
            let before = self.previous(m.next_reset_states[k]);
            let pending = self.flat.graph.or(reset, before);
            self.define(m.active_reset_states[k], pending);
            let pending = self.flat.read(m.active_reset_states[k]);
            let after = self.flat.graph.if_then_else(this, no, pending);
            let next = self.flat.graph.if_then_else(active, after, before);
            self.define(m.next_reset_states[k], next);
            let here = self.flat.graph.and(active, this);
            self.define(m.is_active[k], here);
            let here = self.flat.read(m.is_active[k]);
            let anew = self.flat.graph.or(active_reset, pending);
            let anew = self.flat.graph.and(here, anew);
            self.define(m.is_reset[k], anew);
        }
        let interrupted = self.interrupted(reset);
        let moved = self.flat.graph.binary(Binary::Greater, fired, zero);
        let entered = self.flat.graph.or(interrupted, moved);
        self.define(m.entered, entered);
        let entered = self.flat.read(m.entered);
        let ticks = self.ticks_unless(entered);
        let ticks = self.flat.graph.if_then_else(active, ticks, zero);
        self.define(m.ticks, ticks);
        let since = self.since_unless(entered);
        self.define(m.since, since);
    }

    /// Whether the machine has not been active without a break.
    fn interrupted(&mut self, reset: ExprId) -> ExprId {
        let before = self.previous(self.m.active);
        let rested = self.flat.graph.not(before);
        self.flat.graph.or(reset, rested)
    }

    fn ticks_unless(&mut self, entered: ExprId) -> ExprId {
        let one = self.flat.graph.integer(1);
        let before = self.previous(self.m.ticks);
        let more = self.flat.graph.add(before, one);
        self.flat.graph.if_then_else(entered, one, more)
    }

    fn since_unless(&mut self, entered: ExprId) -> ExprId {
        let now = now(self.flat);
        let before = self.previous(self.m.since);
        self.flat.graph.if_then_else(entered, now, before)
    }

    /// The condition of a transition. An immediate one sees the state that is left, as if nothing fired.
    fn condition(&mut self, t: &Transition, reset: ExprId) -> ExprId {
        let [ticks, time] = if t.immediate {
            let interrupted = self.interrupted(reset);
            let since = self.since_unless(interrupted);
            let now = now(self.flat);
            [self.ticks_unless(interrupted), self.flat.graph.sub(now, since)]
        } else {
            [self.m.ticks(self.flat), self.m.time(self.flat)]
        };
        Rewriter::new().apply(&mut self.flat.graph, t.condition, &mut |g, n| match clocked(g, n)?.0
        {
            ClockOperator::TicksInState => Some(ticks),
            ClockOperator::TimeInState => Some(time),
            _ => None,
        })
    }
}
