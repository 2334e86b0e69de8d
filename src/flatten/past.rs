//! What equations read of the past: delayed expressions, and what is carried along lines.

use super::variable::made;
use crate::base::source::Span;
use crate::instantiate::Context;
use crate::instantiate::evaluate::past::Carrying;
use crate::ir::expr::{Binary, ExprId, Node, Type, VarId};
use crate::ir::flat::{Delay, Equation, EquationKind, FlatModel, Origin, Reader, Transport};

/// Gives what is read of the past variables of its own. Those of delayed expressions follow all others,
/// in their order: that is how they were counted when they were read.
pub fn elaborate(cx: &mut Context<'_>, flat: &mut FlatModel) {
    for (k, delay) in std::mem::take(&mut cx.evaluation.past.delays).into_iter().enumerate() {
        let name = format!("$delay{}", k + 1);
        let variable = defined(cx, flat, name, delay.value, delay.span);
        flat.delays.push(Delay { variable, time: delay.time, span: delay.span });
    }
    for (k, line) in std::mem::take(&mut cx.evaluation.past.lines).into_iter().enumerate() {
        let line = transport(cx, flat, k + 1, line);
        flat.transports.push(line);
    }
}

/// A variable with the equation that says what it is.
fn defined(
    cx: &mut Context<'_>,
    flat: &mut FlatModel,
    name: String,
    value: ExprId,
    span: Span,
) -> VarId {
    let ty = cx.graph.ty(value);
    let variable = made(flat, name, ty, span);
    let lhs = cx.graph.var(variable, ty);
    let origin = Origin { span, component: "".into() };
    flat.equations.push(Equation { kind: EquationKind::Equal(lhs, value), origin });
    variable
}

/// A variable of which the run says what it is.
fn told(cx: &mut Context<'_>, flat: &mut FlatModel, name: String, span: Span) -> VarId {
    let variable = made(flat, name, Type::Real, span);
    let lhs = cx.graph.var(variable, Type::Real);
    let value = cx.graph.intern(Node::Recorded(variable, 0), Type::Real);
    let origin = Origin { span, component: "".into() };
    flat.equations.push(Equation { kind: EquationKind::Equal(lhs, value), origin });
    variable
}

fn transport(
    cx: &mut Context<'_>,
    flat: &mut FlatModel,
    number: usize,
    line: Carrying,
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
        let (from, to) = (told(cx, flat, name("from"), span), told(cx, flat, name("to"), span));
        // The event at which the reader comes to the end of its piece.
        let mut border = |op: Binary, v: VarId| {
            let border = cx.graph.var(v, Type::Real);
            let place = cx.graph.var(place, Type::Real);
            cx.graph.binary(op, place, border)
        };
        let (above, below) = (border(Binary::GreaterEqual, to), border(Binary::Less, from));
        let arrives = cx.graph.or(above, below);
        let arrives = defined(cx, flat, name("arrives"), arrives, span);
        readers.push(Reader { place, from, to, arrives });
    }
    Transport { ends, entering, initial: line.initial, longest: line.longest, readers, span }
}
