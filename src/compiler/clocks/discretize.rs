//! Differential equations of a clocked partition, integrated from tick to tick (Modelica 3.6, section 16.8.2).

use super::add_variable;
use super::error::ClockCause;
use super::partition::Partitions;
use super::solve::{Clocked, System};
use super::ticks::Tick;
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Origin};
use crate::symbolic::rewrite::Rewriter;

/// The solver methods of the specification.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Method {
    ExplicitEuler,
    ExplicitMidPoint2,
    ExplicitRungeKutta4,
    ImplicitEuler,
    ImplicitTrapezoid,
}

/// Replaces derivatives by variables with an equation of the solver method for each state.
pub fn replace(
    flat: &mut FlatModel,
    sub: usize,
    parts: &Partitions,
    tick: &mut Tick,
    system: &mut System,
    problems: &mut Vec<Diagnostic>,
) {
    let sides = system.equations.iter().flat_map(|e| [e.lhs, e.rhs]);
    let mut states: Vec<VarId> = Vec::new();
    for e in flat.graph.postorder(sides) {
        if let Node::Der(x) = flat.graph.node(e)
            && !states.contains(&x)
        {
            states.push(x);
        }
    }
    let Some(&first_state) = states.first() else { return };
    let method = match method(parts, sub) {
        Ok(method) => method,
        Err(None) => {
            let variable = &flat.variables[first_state];
            let cause = ClockCause::NoSolverMethod { variable: variable.name.clone() };
            problems.push(Diagnostic::new(cause, variable.span));
            Method::ExplicitEuler
        }
        Err(Some(cause)) => {
            problems.push(Diagnostic::new(cause, tick.origin.span));
            Method::ExplicitEuler
        }
    };
    let mut rates: FastMap<VarId, VarId> = FastMap::default();
    for &x in &states {
        let name = format!("$der.{}", flat.variables[x].name);
        let rate = add_variable(flat, name, Type::Real, &tick.origin);
        rates.insert(x, rate);
        system.variables.push(rate);
    }
    for e in &mut system.equations {
        let mut rewriter = Rewriter::new();
        for side in [&mut e.lhs, &mut e.rhs] {
            *side = rewriter.apply(&mut flat.graph, *side, &mut |g, n| match g.node(n) {
                Node::Der(x) => rates.get(&x).map(|r| g.var(*r, Type::Real)),
                _ => None,
            });
        }
    }
    let written = system.equations.len();
    let mut step = Step { flat, tick, system, states: &states, rates: &rates, written };
    let increments = step.increments(method);
    let first = step.tick.first(step.flat);
    for (x, next) in states.iter().copied().zip(increments) {
        let origin = step.tick.origin.clone();
        let (lhs, rhs) = match initial(step.flat, x, &rates) {
            None => {
                let before = step.flat.graph.pre(x, Type::Real);
                (step.flat.read(x), step.flat.graph.if_then_else(first, before, next))
            }
            Some((lhs, rhs)) => {
                let read = step.flat.read(x);
                if lhs == read {
                    (lhs, step.flat.graph.if_then_else(first, rhs, next))
                } else {
                    let at_start = step.flat.graph.sub(lhs, rhs);
                    let later = step.flat.graph.sub(read, next);
                    let zero = step.flat.graph.real(0.0);
                    (zero, step.flat.graph.if_then_else(first, at_start, later))
                }
            }
        };
        step.system.equations.push(Clocked { lhs, rhs, origin, input: None });
    }
}

/// The method of a partition: its own, or that of the partitions it exchanges values with (section 16.8.4).
fn method(parts: &Partitions, sub: usize) -> Result<Method, Option<ClockCause>> {
    let own = |sub: usize| -> Vec<&str> {
        let of = parts.solvers.iter().filter(|(node, ..)| parts.sub(*node) == sub);
        of.map(|(_, method, _)| method.as_str()).collect()
    };
    let mut seen = vec![sub];
    let mut pending = vec![sub];
    let mut found: Vec<&str> = Vec::new();
    while let Some(at) = pending.pop() {
        let methods = own(at);
        if !methods.is_empty() {
            found.extend(methods);
            continue;
        }
        for c in &parts.conversions {
            let [from, to] = [c.from, c.to].map(|n| parts.sub(n));
            let other = match at {
                _ if at == from => to,
                _ if at == to => from,
                _ => continue,
            };
            if !seen.contains(&other) {
                seen.push(other);
                pending.push(other);
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    match found.as_slice() {
        [] => Err(None),
        ["ExplicitEuler" | "External"] => Ok(Method::ExplicitEuler),
        ["ExplicitMidPoint2"] => Ok(Method::ExplicitMidPoint2),
        ["ExplicitRungeKutta4"] => Ok(Method::ExplicitRungeKutta4),
        ["ImplicitEuler"] => Ok(Method::ImplicitEuler),
        ["ImplicitTrapezoid"] => Ok(Method::ImplicitTrapezoid),
        [one] => Err(Some(ClockCause::UnknownSolverMethod { method: (*one).to_owned() })),
        [first, second, ..] => Err(Some(ClockCause::ContradictingClocks {
            first: format!("solver method {first}"),
            second: format!("solver method {second}"),
        })),
    }
}

/// An initial equation of a state, which is taken out of the model.
fn initial(
    flat: &mut FlatModel,
    x: VarId,
    rates: &FastMap<VarId, VarId>,
) -> Option<(ExprId, ExprId)> {
    let at = flat.initial_equations.iter().position(|e| match e.kind {
        EquationKind::Equal(lhs, rhs) => {
            flat.graph.any([lhs, rhs], |_, node| node == Node::Var(x) || node == Node::Der(x))
        }
        _ => false,
    })?;
    let EquationKind::Equal(lhs, rhs) = flat.initial_equations.remove(at).kind else { return None };
    let mut sides = [lhs, rhs].map(|side| {
        Rewriter::new().apply(&mut flat.graph, side, &mut |g, n| match g.node(n) {
            Node::Der(x) => rates.get(&x).map(|r| g.var(*r, Type::Real)),
            _ => None,
        })
    });
    if flat.graph.node(sides[1]) == Node::Var(x) {
        sides.swap(0, 1);
    }
    Some((sides[0], sides[1]))
}

struct Step<'a> {
    flat: &'a mut FlatModel,
    tick: &'a mut Tick,
    system: &'a mut System,
    states: &'a [VarId],
    rates: &'a FastMap<VarId, VarId>,
    /// Number of equations before copies were added.
    written: usize,
}

impl Step<'_> {
    /// The value of each state after a step.
    fn increments(&mut self, method: Method) -> Vec<ExprId> {
        let h = self.tick.elapsed(self.flat);
        let before: Vec<ExprId> =
            self.states.iter().map(|x| self.flat.graph.pre(*x, Type::Real)).collect();
        let known: Vec<ExprId> =
            self.states.iter().map(|x| self.flat.graph.pre(self.rates[x], Type::Real)).collect();
        let now: Vec<ExprId> = self.states.iter().map(|x| self.flat.read(self.rates[x])).collect();
        match method {
            Method::ExplicitEuler => self.advanced(&before, &[(1.0, &known)], h),
            Method::ImplicitEuler => self.advanced(&before, &[(1.0, &now)], h),
            Method::ImplicitTrapezoid => self.advanced(&before, &[(0.5, &known), (0.5, &now)], h),
            Method::ExplicitMidPoint2 => {
                let middle = self.advanced(&before, &[(0.5, &known)], h);
                let slope = self.stage(&middle, 0.5, h);
                self.advanced(&before, &[(1.0, &slope)], h)
            }
            Method::ExplicitRungeKutta4 => {
                let x2 = self.advanced(&before, &[(0.5, &known)], h);
                let k2 = self.stage(&x2, 0.5, h);
                let x3 = self.advanced(&before, &[(0.5, &k2)], h);
                let k3 = self.stage(&x3, 0.5, h);
                let x4 = self.advanced(&before, &[(1.0, &k3)], h);
                let k4 = self.stage(&x4, 1.0, h);
                let (sixth, third) = (1.0 / 6.0, 1.0 / 3.0);
                let slopes = [(sixth, &known), (third, &k2), (third, &k3), (sixth, &k4)];
                self.advanced(&before, &slopes, h)
            }
        }
    }

    /// `x + h * sum(weight * slope)` for each state.
    fn advanced(&mut self, x: &[ExprId], slopes: &[(f64, &Vec<ExprId>)], h: ExprId) -> Vec<ExprId> {
        let g = &mut self.flat.graph;
        let of = |(k, x): (usize, &ExprId)| {
            let terms: Vec<ExprId> = slopes
                .iter()
                .map(|(weight, slope)| {
                    let weight = g.real(*weight);
                    g.mul(weight, slope[k])
                })
                .collect();
            let slope = g.sum(terms);
            let change = g.mul(h, slope);
            g.add(*x, change)
        };
        x.iter().enumerate().map(of).collect()
    }

    /// The derivatives at values of the states and a fraction of the step: a copy of all equations, in which Real
    /// inputs run linearly over the step.
    fn stage(&mut self, states: &[ExprId], fraction: f64, h: ExprId) -> Vec<ExprId> {
        let origin: Origin = self.tick.origin.clone();
        let inputs: FastSet<VarId> = self.system.equations.iter().filter_map(|e| e.input).collect();
        let originals: Vec<(ExprId, ExprId)> = self
            .system
            .equations
            .iter()
            .take(self.written)
            .filter(|e| e.input.is_none())
            .map(|e| (e.lhs, e.rhs))
            .collect();
        let own: FastSet<VarId> = self.system.variables.iter().copied().collect();
        let mut copies: FastMap<VarId, ExprId> = FastMap::default();
        for (x, value) in self.states.iter().zip(states) {
            let name =
                format!("$stage{}.{}", self.flat.variables.len(), self.flat.variables[*x].name);
            let copy = add_variable(self.flat, name, Type::Real, &origin);
            self.system.variables.push(copy);
            let read = self.flat.read(copy);
            copies.insert(*x, read);
            let equation = Clocked { lhs: read, rhs: *value, origin: origin.clone(), input: None };
            self.system.equations.push(equation);
        }
        let defined: FastSet<VarId> = {
            let read = originals.iter().flat_map(|(a, b)| [*a, *b]);
            super::expression::read(&self.flat.graph, read)
        };
        let mut defined: Vec<VarId> = defined.into_iter().filter(|v| own.contains(v)).collect();
        defined.sort_unstable();
        for v in defined {
            if copies.contains_key(&v) {
                continue;
            }
            let ty = self.flat.variables[v].ty;
            let value = if inputs.contains(&v) {
                let (before, now) = (self.flat.graph.pre(v, ty), self.flat.read(v));
                match ty {
                    _ if fraction == 1.0 => now,
                    Type::Real => {
                        let half = self.flat.graph.real(0.5);
                        let sum = self.flat.graph.add(before, now);
                        self.flat.graph.mul(half, sum)
                    }
                    _ => before,
                }
            } else {
                let name =
                    format!("$stage{}.{}", self.flat.variables.len(), self.flat.variables[v].name);
                let copy = add_variable(self.flat, name, ty, &origin);
                self.system.variables.push(copy);
                self.flat.read(copy)
            };
            copies.insert(v, value);
        }
        let back = self.flat.graph.real(fraction - 1.0);
        let back = self.flat.graph.mul(back, h);
        let time = self.flat.graph.time();
        let time = self.flat.graph.add(time, back);
        let mut rewriter = Rewriter::new();
        for (lhs, rhs) in originals {
            let [lhs, rhs] = [lhs, rhs].map(|side| {
                rewriter.apply(&mut self.flat.graph, side, &mut |g, n| match g.node(n) {
                    Node::Var(v) => copies.get(&v).copied(),
                    Node::Time => Some(time),
                    _ => None,
                })
            });
            self.system.equations.push(Clocked { lhs, rhs, origin: origin.clone(), input: None });
        }
        self.states.iter().map(|x| copies[&self.rates[x]]).collect()
    }
}
