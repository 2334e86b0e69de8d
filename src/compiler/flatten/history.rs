//! Introduces variables for operators with history, `delay`, `spatialDistribution`, random numbers, and for expressions
//! whose derivative is read or given.

use super::variable::add_synthetic;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::history::{Synthetic, TransportCall};
use crate::evaluate::random_draw::{RandomDraw, RandomDraws};
use crate::ir::ast::Variability;
use crate::ir::expr::{Binary, ExprId, Node, Type, VarId};
use crate::ir::flat::{
    Delay, Equation, EquationKind, FlatModel, GivenDerivative, Origin, Transport, TransportReader,
};
use crate::symbolic::rewrite::Rewriter;

/// Adds a variable for each delayed expression, transport line and random number. They follow all
/// declared variables in the order in which the evaluator met the operators, because the evaluator
/// has already numbered them in this order.
pub fn elaborate(cx: &mut Evaluator<'_>, flat: &mut FlatModel) {
    let draws = std::mem::take(&mut cx.random_draws);
    let draws_any = cx.history.synthetic.iter().any(|m| matches!(m, Synthetic::Number(_)));
    let generator = draws.generator.as_ref().filter(|_| draws_any);
    let generator = generator.and_then(|state| generator_state(cx, flat, state));
    for (k, made) in std::mem::take(&mut cx.history.synthetic).into_iter().enumerate() {
        match made {
            Synthetic::Delay(delay) => {
                let name = format!("$delay{}", flat.delays.len() + 1);
                let variable = defined(cx, flat, name, delay.value, delay.span);
                flat.delays.push(Delay { variable, time: delay.time, span: delay.span });
            }
            Synthetic::Derived(value, span) => {
                defined(cx, flat, format!("$derived{}", k + 1), value, span);
            }
            Synthetic::Given(value, derivative, span) => {
                let variable = defined(cx, flat, format!("$given{}", k + 1), value, span);
                flat.given_derivatives.push(GivenDerivative { variable, derivative });
            }
            Synthetic::InStream(stream) => super::connect::streams::add_variable(flat, stream),
            Synthetic::Condition(condition, span) => {
                let flag = add_synthetic(flat, format!("$condition{}", k + 1), Type::Boolean, span);
                flat.variables[flag].binding = Some(condition);
            }
            Synthetic::Assigned(ty, span) => {
                add_synthetic(flat, format!("$assigned{}", k + 1), ty, span);
            }
            Synthetic::Counter(span) => {
                let zero = cx.graph.integer(0);
                let counter = add_synthetic(flat, format!("$drawn{}", k + 1), Type::Integer, span);
                flat.variables[counter].start = Some(zero);
                flat.variables[counter].fixed = Some(true);
            }
            Synthetic::Number(drawing) => {
                let value = number(cx, &draws, generator.as_deref(), drawing);
                let name = format!("$random{}", k + 1);
                let variable = add_synthetic(flat, name, Type::Real, drawing.span);
                let at_start = drawing.counter.is_none();
                flat.variables[variable].binding = Some(value);
                flat.variables[variable].variability =
                    if at_start { Variability::Parameter } else { Variability::Discrete };
            }
        }
    }
    for (k, line) in std::mem::take(&mut cx.history.lines).into_iter().enumerate() {
        let line = transport(cx, flat, k + 1, line);
        flat.transports.push(line);
    }
}

/// Maximum length of a chain of parameters that are bound to other parameters.
const MAX_PARAMETER_CHAIN: usize = 20;

/// The initial state of the random number generator, if it can be evaluated before simulation.
fn generator_state(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    state: &[ExprId],
) -> Option<Vec<i64>> {
    let mut given: FastMap<VarId, ExprId> = FastMap::default();
    for e in &flat.initial_equations {
        let EquationKind::Equal(a, b) = e.kind else { continue };
        for (side, other) in [(a, b), (b, a)] {
            if let Node::Var(v) = cx.graph.node(side) {
                given.entry(v).or_insert(other);
            }
        }
    }
    for (v, variable) in flat.variables.enumerate() {
        if let Some(e) = variable.binding.filter(|_| variable.variability <= Variability::Parameter)
        {
            given.insert(v, e);
        }
    }
    let mut words = Vec::with_capacity(state.len());
    for &e in state {
        let mut e = e;
        for _ in 0..MAX_PARAMETER_CHAIN {
            if cx.graph.as_const(e).is_some() {
                break;
            }
            e = Rewriter::new().apply(&mut cx.graph, e, &mut |g, n| match g.node(n) {
                Node::Var(v) => {
                    flat.variables[v].structural |= given.contains_key(&v);
                    given.get(&v).copied()
                }
                _ => None,
            });
        }
        words.push(cx.graph.as_number(e)? as i64);
    }
    Some(words)
}

/// The value of a random number as an element of the generator's sequence: the samples of the
/// initialization come first, then those of all when-clauses, which sample in their order if they
/// are active at the same instant.
fn number(
    cx: &mut Evaluator<'_>,
    draws: &RandomDraws,
    generator: Option<&[i64]>,
    drawing: RandomDraw,
) -> ExprId {
    let Some(generator) = generator else {
        cx.report(super::cause::FlattenCause::UnknownSeed, drawing.span);
        return cx.graph.real(0.5);
    };
    let mut at = cx.graph.integer(drawing.number);
    if let Some(own) = drawing.counter {
        let at_start = cx.graph.integer(draws.at_start);
        at = cx.graph.add(at, at_start);
        let mut now = true;
        for &counter in &draws.counters {
            now &= counter != own;
            let drawn = match now {
                true => cx.graph.var(counter, Type::Integer),
                false => cx.graph.intern(Node::Pre(counter), Type::Integer),
            };
            at = cx.graph.add(at, drawn);
        }
    }
    cx.drawn(generator, at)
}

/// A variable with the equation that defines it.
fn defined(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    name: String,
    value: ExprId,
    span: Span,
) -> VarId {
    // An Integer variable has new values at events only.
    let ty = match cx.graph.ty(value) {
        Type::Integer if cx.changes_unseen(value) => Type::Real,
        ty => ty,
    };
    let variable = add_synthetic(flat, name, ty, span);
    let lhs = cx.graph.var(variable, ty);
    let origin = Origin { span, component: "".into() };
    flat.equations.push(Equation { kind: EquationKind::Equal(lhs, value), origin });
    variable
}

/// A variable whose value the simulator supplies.
fn external_variable(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    name: String,
    span: Span,
) -> VarId {
    let variable = add_synthetic(flat, name, Type::Real, span);
    let lhs = cx.graph.var(variable, Type::Real);
    let value = cx.graph.intern(Node::Recorded(variable, 0), Type::Real);
    let origin = Origin { span, component: "".into() };
    flat.equations.push(Equation { kind: EquationKind::Equal(lhs, value), origin });
    variable
}

fn transport(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    number: usize,
    line: TransportCall,
) -> Transport {
    let span = line.span;
    let mut define = |what: &str, value: ExprId| {
        let value = cx.graph.as_real(value);
        defined(cx, flat, format!("$line{number}.{what}"), value, span)
    };
    let ends = [define("low", line.ends[0]), define("high", line.ends[1])];
    let entering = [
        line.entering[0].map(|e| define("enters_low", e)),
        line.entering[1].map(|e| define("enters_high", e)),
    ];
    let mut readers = Vec::with_capacity(line.readers.len());
    for (k, place) in line.readers.into_iter().enumerate() {
        let name = |what: &str| format!("$line{number}.reader{}.{what}", k + 1);
        let place = cx.graph.as_real(place);
        let place = defined(cx, flat, name("place"), place, span);
        let (from, to) = (
            external_variable(cx, flat, name("from"), span),
            external_variable(cx, flat, name("to"), span),
        );
        // The event at which the reader leaves its segment of the history.
        let mut compare = |op: Binary, v: VarId| {
            let limit = cx.graph.var(v, Type::Real);
            let place = cx.graph.var(place, Type::Real);
            cx.graph.binary(op, place, limit)
        };
        let (above, below) = (compare(Binary::GreaterEqual, to), compare(Binary::Less, from));
        let arrives = cx.graph.or(above, below);
        let arrives = defined(cx, flat, name("arrives"), arrives, span);
        readers.push(TransportReader { place, from, to, arrives });
    }
    Transport { ends, entering, initial: line.initial, longest: line.longest, readers, span }
}
