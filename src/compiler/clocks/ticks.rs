//! The conditions on which partitions tick.
//!
//! The periodic partitions of one base clock count the ticks of one grid, the largest period of which all their
//! periods and shifts are multiples: ticks that coincide are the same event. Partitions of an event clock, or of one
//! with a varying interval, count its ticks.

use super::error::ClockCause;
use super::expression::{clocked, is_fixed, variable};
use super::fraction::Fraction;
use super::partition::Partitions;
use super::rate::Rate;
use super::{add_discrete, add_variable, equal};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Binary, Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Action, Equation, EquationKind, FlatModel, Origin, WhenBranch};

/// When a partition ticks.
pub struct Tick {
    /// The conditions of its when-clause.
    pub conditions: Vec<ExprId>,
    /// What its when-clause does besides its own equations.
    pub actions: Vec<Action>,
    /// A place in the partition.
    pub origin: Origin,
    elapsed: Elapsed,
    first: Option<ExprId>,
}

/// The interval between the previous and the present tick.
enum Elapsed {
    Known(ExprId),
    /// Measured, from this value at the first tick.
    Measured(ExprId),
}

impl Tick {
    /// Whether this tick is the first one.
    pub fn first(&mut self, flat: &mut FlatModel) -> ExprId {
        if let Some(first) = self.first {
            return first;
        }
        let name = format!("$ticked{}", flat.variables.len());
        let [no, yes] = [false, true].map(|b| flat.graph.boolean(b));
        let ticked = add_discrete(flat, name, Type::Boolean, Some(no), &self.origin);
        self.actions.push(Action::Assign(ticked, yes));
        let before = flat.graph.pre(ticked, Type::Boolean);
        let first = flat.graph.not(before);
        self.first = Some(first);
        first
    }

    /// `interval()`, s.
    pub fn elapsed(&mut self, flat: &mut FlatModel) -> ExprId {
        let start = match self.elapsed {
            Elapsed::Known(e) => return e,
            Elapsed::Measured(start) => start,
        };
        let first = self.first(flat);
        let name = format!("$lastTick{}", flat.variables.len());
        let zero = flat.graph.real(0.0);
        let last = add_discrete(flat, name, Type::Real, Some(zero), &self.origin);
        let time = flat.graph.time();
        self.actions.push(Action::Assign(last, time));
        let before = flat.graph.pre(last, Type::Real);
        let since = flat.graph.sub(time, before);
        let e = flat.graph.if_then_else(first, start, since);
        self.elapsed = Elapsed::Known(e);
        e
    }
}

/// What makes a clock tick.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Source {
    /// A grid of exact periods, s.
    Exact,
    /// A period that is a parameter expression, s.
    Period(ExprId),
    /// `Clock(condition, startInterval)`
    Event(ExprId, ExprId),
    /// The variable, and the divisor that makes it an interval; `None` for a Real interval.
    Varying(VarId, Option<i64>),
}

/// The unit in which a group of partitions counts.
#[derive(Clone, Copy, Debug)]
struct Unit {
    source: Source,
    /// The period of the group in periods of the source; for exact grids in s.
    scale: Fraction,
    /// The shift that starts with the source, in periods of the group.
    start: Fraction,
}

/// The ticks of all clocked partitions.
pub fn of(
    flat: &mut FlatModel,
    parts: &Partitions,
    rates: &FastMap<usize, Rate>,
    problems: &mut Vec<Diagnostic>,
) -> FastMap<usize, Tick> {
    let mut bases: Vec<(usize, Vec<usize>)> = Vec::new();
    for sub in parts.subs() {
        let base = parts.base(sub);
        match bases.iter_mut().find(|(b, _)| *b == base) {
            Some((_, subs)) => subs.push(sub),
            None => bases.push((base, vec![sub])),
        }
    }
    let mut ticks = FastMap::default();
    for (base, subs) in bases {
        let units = units(flat, parts, rates, base, &subs, problems);
        let mut sources: Vec<Source> = Vec::new();
        for sub in &subs {
            if let Some(unit) = units.get(&rates[sub].group)
                && !sources.contains(&unit.source)
            {
                sources.push(unit.source);
            }
        }
        let Some(origin) = parts.clock_of(base).cloned() else { continue };
        for source in sources {
            let mut placed = Vec::new();
            for &sub in &subs {
                let rate = rates[&sub];
                let Some(unit) = units.get(&rate.group).filter(|u| u.source == source) else {
                    continue;
                };
                let period = rate.period.times(unit.scale);
                let start = rate.shift.minus(unit.start).times(unit.scale);
                placed.push(Placed { sub, period, start });
            }
            grid(flat, source, &placed, &origin, &mut ticks, problems);
        }
    }
    ticks
}

/// A partition on its grid: period and first tick in periods of the source.
struct Placed {
    sub: usize,
    period: Fraction,
    start: Fraction,
}

/// The units of the groups of one base clock.
fn units(
    flat: &mut FlatModel,
    parts: &Partitions,
    rates: &FastMap<usize, Rate>,
    base: usize,
    subs: &[usize],
    problems: &mut Vec<Diagnostic>,
) -> FastMap<usize, Unit> {
    let mut units: FastMap<usize, Unit> = FastMap::default();
    let mut stated: Vec<(ExprId, Source, Option<Fraction>, &Origin)> = Vec::new();
    for (node, e, origin) in &parts.definitions {
        let Some(rate) = rates.get(&parts.sub(*node)) else { continue };
        if parts.base(*node) != base {
            continue;
        }
        let (source, period) = source(flat, *e);
        let scale = period.unwrap_or(Fraction::ONE).over(rate.period);
        let unit = Unit { source, scale, start: rate.shift };
        let other = stated.iter().find(|(known, s, period, _)| {
            known != e && (*s != Source::Exact || source != Source::Exact || period.is_none())
        });
        let before = units.get(&rate.group).copied();
        let agrees = before.is_none_or(|u| u.scale == unit.scale && u.start == unit.start);
        if other.is_some() || !agrees {
            let names = |v: VarId| flat.variables[v].name.clone();
            let text = |e| crate::symbolic::print::print(&flat.graph, e, &names);
            let first = other.map_or(stated.first().map(|s| s.0), |o| Some(o.0)).unwrap_or(*e);
            let cause = ClockCause::ContradictingClocks { first: text(first), second: text(*e) };
            let place = stated.first().map_or(origin.span, |s| s.3.span);
            problems.push(Diagnostic::new(cause, origin.span).also(place, "first clock"));
            continue;
        }
        units.entry(rate.group).or_insert(unit);
        stated.push((*e, source, period, origin));
    }
    if units.is_empty() {
        default_unit(parts, rates, base, subs, &mut units, problems);
    }
    // The other groups follow from those that they exchange values with.
    loop {
        let mut changed = false;
        for c in &parts.conversions {
            let [from, to] = [c.from, c.to].map(|n| rates.get(&parts.sub(n)));
            let (Some(from), Some(to)) = (from, to) else { continue };
            for (known, own) in [(from, to), (to, from)] {
                if units.contains_key(&own.group) {
                    continue;
                }
                let Some(unit) = units.get(&known.group).copied() else { continue };
                let ratio = known.period.over(own.period);
                let begins = known.shift.minus(unit.start).over(ratio);
                let start = own.shift.minus(begins);
                let scale = unit.scale.times(ratio);
                units.insert(own.group, Unit { scale, start, ..unit });
                changed = true;
            }
        }
        if !changed {
            return units;
        }
    }
}

/// The fastest partition ticks once a second (section 16.3).
fn default_unit(
    parts: &Partitions,
    rates: &FastMap<usize, Rate>,
    base: usize,
    subs: &[usize],
    units: &mut FastMap<usize, Unit>,
    problems: &mut Vec<Diagnostic>,
) {
    let Some(first) = subs.iter().find_map(|s| rates.get(s)) else { return };
    let of_group = || subs.iter().filter_map(|s| rates.get(s)).filter(|r| r.group == first.group);
    let fastest = of_group().fold(first.period, |f, r| if r.period < f { r.period } else { f });
    let start = of_group().fold(first.shift, |f, r| if r.shift < f { r.shift } else { f });
    let scale = Fraction::ONE.over(fastest);
    units.insert(first.group, Unit { source: Source::Exact, scale, start });
    if let Some(origin) = parts.clock_of(base) {
        problems.push(Diagnostic::new(ClockCause::DefaultClock, origin.span));
    }
}

/// What a constructor states, and its period in s if it is exact.
fn source(flat: &mut FlatModel, e: ExprId) -> (Source, Option<Fraction>) {
    let Some((op, args)) = clocked(&flat.graph, e) else { return (Source::Exact, None) };
    match op {
        ClockOperator::Event => (Source::Event(args[0], args[1]), None),
        ClockOperator::Rational => {
            let Some(Const::Integer(resolution)) = flat.graph.as_const(args[1]) else {
                return (Source::Exact, None);
            };
            match (flat.graph.as_const(args[0]), variable(&flat.graph, args[0])) {
                (Some(Const::Integer(n)), _) => {
                    let period = Fraction::new(i128::from(n), i128::from(resolution));
                    (Source::Exact, Some(period))
                }
                (_, Some(v)) => (Source::Varying(v, Some(resolution)), None),
                _ => (Source::Exact, None),
            }
        }
        _ => {
            if !is_fixed(flat, args[0])
                && let Some(v) = variable(&flat.graph, args[0])
            {
                return (Source::Varying(v, None), None);
            }
            let literal = flat.graph.as_number(args[0]);
            match literal.filter(|x| *x > 0.0).and_then(Fraction::of_float) {
                Some(period) => (Source::Exact, Some(period)),
                None => (Source::Period(args[0]), None),
            }
        }
    }
}

/// Adds the ticks of the partitions of one source.
fn grid(
    flat: &mut FlatModel,
    source: Source,
    placed: &[Placed],
    origin: &Origin,
    ticks: &mut FastMap<usize, Tick>,
    problems: &mut Vec<Diagnostic>,
) {
    if placed.iter().any(|p| p.start.is_negative()) {
        problems.push(Diagnostic::new(ClockCause::TicksTooEarly, origin.span));
        return;
    }
    let periodic = matches!(source, Source::Exact | Source::Period(_));
    let mut step = Fraction::ONE;
    if periodic {
        step = placed.first().map_or(step, |p| p.period);
        for p in placed {
            step = step.common_divisor(p.period);
            if !p.start.is_zero() {
                step = step.common_divisor(p.start);
            }
        }
    }
    let single = placed.windows(2).all(|w| w[0].period == w[1].period && w[0].start == w[1].start);
    let offset = match placed.first() {
        Some(p) if periodic && single => {
            step = p.period;
            p.start
        }
        _ => Fraction::ZERO,
    };
    let mut raw = raw(flat, source, step, offset, origin);
    let mut counter = None;
    for p in placed {
        let (every, skip) = (p.period.over(step).whole(), p.start.minus(offset).over(step).whole());
        let (Some(every), Some(skip)) = (every, skip) else {
            problems.push(Diagnostic::new(ClockCause::FasterThanEvents, origin.span));
            continue;
        };
        let conditions = if (every, skip) == (1, 0) {
            raw.conditions.clone()
        } else {
            let count = *counter.get_or_insert_with(|| count(flat, &raw.conditions, origin));
            let due = due(flat, count, every, skip);
            raw.edges.iter().map(|edge| flat.graph.and(*edge, due)).collect()
        };
        let elapsed = elapsed(flat, source, p.period, every);
        let actions =
            if (every, skip) == (1, 0) { std::mem::take(&mut raw.actions) } else { vec![] };
        let tick = Tick { conditions, actions, origin: origin.clone(), elapsed, first: None };
        ticks.insert(p.sub, tick);
    }
}

fn elapsed(flat: &mut FlatModel, source: Source, period: Fraction, every: i64) -> Elapsed {
    match source {
        Source::Exact => Elapsed::Known(flat.graph.real(period.value())),
        Source::Period(e) => Elapsed::Known(scaled(flat, e, period)),
        Source::Event(_, start) => Elapsed::Measured(start),
        Source::Varying(v, resolution) if every == 1 => {
            let ty = flat.variables[v].ty;
            let before = flat.graph.pre(v, ty);
            Elapsed::Known(divided(flat, before, resolution))
        }
        Source::Varying(..) => Elapsed::Measured(flat.graph.real(0.0)),
    }
}

fn scaled(flat: &mut FlatModel, e: ExprId, by: Fraction) -> ExprId {
    let by = flat.graph.real(by.value());
    flat.graph.mul(e, by)
}

fn divided(flat: &mut FlatModel, e: ExprId, by: Option<i64>) -> ExprId {
    match by {
        Some(n) => {
            let n = flat.graph.real(n as f64);
            flat.graph.div(e, n)
        }
        None => e,
    }
}

/// The ticks of a source.
struct Raw {
    /// Conditions that become true at the ticks.
    conditions: Vec<ExprId>,
    /// Expressions that are true at the ticks only.
    edges: Vec<ExprId>,
    /// What the partition that ticks with the source has to do.
    actions: Vec<Action>,
}

fn raw(
    flat: &mut FlatModel,
    source: Source,
    step: Fraction,
    offset: Fraction,
    origin: &Origin,
) -> Raw {
    let begin = flat.experiment.start.unwrap_or(0.0);
    match source {
        Source::Exact | Source::Period(_) => {
            let [step, offset] = [step, offset].map(|x| match source {
                Source::Period(e) => scaled(flat, e, x),
                _ => flat.graph.real(x.value()),
            });
            let begin = flat.graph.real(begin);
            let start = flat.graph.add(begin, offset);
            let ticks = vec![flat.graph.intern(Node::Sample(start, step), Type::Boolean)];
            Raw { conditions: ticks.clone(), edges: ticks, actions: Vec::new() }
        }
        Source::Event(condition, _) => {
            let name = format!("$event{}", flat.variables.len());
            let v = add_variable(flat, name, Type::Boolean, origin);
            let read = flat.read(v);
            flat.equations.push(equal(read, condition, origin));
            let before = flat.graph.pre(v, Type::Boolean);
            let not_before = flat.graph.not(before);
            let edge = flat.graph.and(read, not_before);
            Raw { conditions: vec![read], edges: vec![edge], actions: Vec::new() }
        }
        Source::Varying(v, resolution) => {
            // The first tick comes at the start; the time of the next is known from then on.
            let never = flat.graph.real(1e60);
            let name = format!("$nextTick{}", flat.variables.len());
            let next = add_discrete(flat, name, Type::Real, Some(never), origin);
            let [time, begin] = [flat.graph.time(), flat.graph.real(begin)];
            let first = flat.graph.intern(Node::Sample(begin, never), Type::Boolean);
            let due = flat.graph.pre(next, Type::Real);
            let later = flat.graph.binary(Binary::GreaterEqual, time, due);
            let value = match resolution {
                Some(_) => flat.read(v),
                None => flat.graph.pre(v, Type::Real),
            };
            let interval = divided(flat, value, resolution);
            let at = flat.graph.add(time, interval);
            let conditions = vec![first, later];
            Raw { edges: conditions.clone(), conditions, actions: vec![Action::Assign(next, at)] }
        }
    }
}

/// A variable that counts ticks from 0.
fn count(flat: &mut FlatModel, conditions: &[ExprId], origin: &Origin) -> VarId {
    let [before_first, one] = [-1, 1].map(|n| flat.graph.integer(n));
    let name = format!("$ticks{}", flat.variables.len());
    let count = add_discrete(flat, name, Type::Integer, Some(before_first), origin);
    let before = flat.graph.pre(count, Type::Integer);
    let next = flat.graph.add(before, one);
    let actions = vec![Action::Assign(count, next)];
    let branch = WhenBranch { conditions: conditions.to_vec(), actions };
    flat.equations
        .push(Equation { kind: EquationKind::When(vec![branch]), origin: origin.clone() });
    count
}

/// Whether a partition ticks that skips ticks and then takes every n-th.
fn due(flat: &mut FlatModel, count: VarId, every: i64, skip: i64) -> ExprId {
    let read = flat.read(count);
    let [every, skip, zero] = [every, skip, 0].map(|n| flat.graph.integer(n));
    let since = flat.graph.sub(read, skip);
    let begun = match flat.graph.as_number(skip) {
        Some(0.0) => flat.graph.boolean(true),
        _ => flat.graph.binary(Binary::GreaterEqual, since, zero),
    };
    let rest = flat.graph.binary(Binary::Mod, since, every);
    let whole = flat.graph.binary(Binary::Equal, rest, zero);
    flat.graph.and(begun, whole)
}
