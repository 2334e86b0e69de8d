//! Equations of stream connectors (Modelica 3.6, chapter 15).
//!
//! In: the connection sets of stream variables, and the variables for which `inStream` was asked.
//! Out: the outflow of each outside connector, and the value of each `inStream`: the mixture of
//! what flows into the connection from all other connectors, regularized at zero flow as section
//! 15.2 describes.
//!
//! From inside connector `j` flows `max(-m_j, 0)` with the outflow of `j`, from outside connector
//! `k` flows `max(m_k, 0)` with `inStream` of `k`. A connector that cannot supply anything, because
//! of the `min` or `max` of its flow, does not take part.

use super::Connections;
use super::sets::SetMember;
use crate::base::index::FastMap;
use crate::evaluate::Evaluator;
use crate::evaluate::history::Synthetic;
use crate::ir::expr::{Binary, Const, ExprId, Type, VarId};
use crate::ir::flat::{Equation, EquationKind, FlatModel, Origin};

/// The flow below which a mixture is regularized, relative to the nominal flow.
const SMALL_FLOW: f64 = 1e-7;

/// A stream that may flow into a connection set.
#[derive(Clone, Copy)]
struct Inflow {
    /// The flow into the set.
    flow: ExprId,
    /// Its nominal value.
    nominal: f64,
    /// The value that it carries.
    value: ExprId,
    /// It may be positive.
    may_supply: bool,
}

impl Connections {
    /// Adds the equations of outside connectors and of `inStream`.
    pub(super) fn stream_equations(&mut self, cx: &mut Evaluator<'_>, flat: &mut FlatModel) {
        let sets = self.streams.sets();
        let mut set_of: FastMap<VarId, usize> = FastMap::default();
        for (k, (members, origin)) in sets.iter().enumerate() {
            for &(v, outside) in members {
                if !outside {
                    set_of.insert(v, k);
                    continue;
                }
                let own = cx.graph.var(v, Type::Real);
                let value = mixture(cx, flat, members, (v, true));
                let kind = EquationKind::Equal(own, value);
                flat.equations.push(Equation { kind, origin: origin.clone() });
            }
        }
        // The value of one `inStream` may ask for others, which are appended.
        let mut at = 0;
        while let Some(made) = cx.history.synthetic.get(at).copied() {
            at += 1;
            let Synthetic::InStream(v) = made else { continue };
            let (value, origin) = match set_of.get(&v) {
                Some(set) => {
                    let (members, origin) = &sets[*set];
                    (mixture(cx, flat, members, (v, false)), origin.clone())
                }
                None => {
                    let origin = Origin { span: flat.variables[v].span, component: "".into() };
                    (cx.graph.var(v, Type::Real), origin)
                }
            };
            let own = cx.in_stream(v);
            flat.equations.push(Equation { kind: EquationKind::Equal(own, value), origin });
        }
    }
}

/// The stream that flows to `target` out of the connection.
fn mixture(
    cx: &mut Evaluator<'_>,
    flat: &FlatModel,
    members: &[SetMember],
    target: SetMember,
) -> ExprId {
    let others: Vec<Inflow> =
        members.iter().filter(|m| **m != target).filter_map(|m| inflow(cx, flat, *m)).collect();
    let supplying: Vec<Inflow> = others.iter().copied().filter(|i| i.may_supply).collect();
    match (supplying.as_slice(), others.first()) {
        ([only], _) => only.value,
        // Nothing can flow to an inside connector: any value will do.
        ([], _) if !target.1 => cx.graph.var(target.0, Type::Real),
        ([], Some(any)) => any.value,
        ([], None) => cx.graph.var(target.0, Type::Real),
        (several, _) => weighted_mean(cx, several),
    }
}

/// The stream of a connector, as it flows into the connection set.
fn inflow(cx: &mut Evaluator<'_>, flat: &FlatModel, (v, outside): SetMember) -> Option<Inflow> {
    let flow = cx.flow_of_stream(cx.instance_of[v.0 as usize].0)?;
    let declared = &flat.variables[flow];
    let limit = if outside { declared.max } else { declared.min };
    let mut number = |e: Option<ExprId>| {
        e.and_then(|e| cx.parameter_expression(e, true)).and_then(Const::number)
    };
    let limit = number(limit);
    let nominal = number(declared.nominal).filter(|n| *n > 0.0).unwrap_or(1.0);
    let m = cx.graph.var(flow, Type::Real);
    Some(match outside {
        true => {
            let may_supply = limit.is_none_or(|max| max > 0.0);
            Inflow { flow: m, nominal, value: cx.in_stream(v), may_supply }
        }
        false => {
            let may_supply = limit.is_none_or(|min| min < 0.0);
            let value = cx.graph.var(v, Type::Real);
            Inflow { flow: cx.graph.neg(m), nominal, value, may_supply }
        }
    })
}

/// The mean of the values, weighted with their inflows.
///
/// With `s` the sum of all inflows, and `eps` a small flow, a weight is `max(m, 0)` where `s > eps`
/// and tends to `eps` as `s` tends to zero, so the mean is defined and continuous everywhere
/// (Modelica 3.6, section 15.2).
fn weighted_mean(cx: &mut Evaluator<'_>, inflows: &[Inflow]) -> ExprId {
    let g = &mut cx.graph;
    let zero = g.real(0.0);
    let least = inflows.iter().map(|i| i.nominal).fold(f64::INFINITY, f64::min);
    let eps = g.real(SMALL_FLOW * least);
    let positive: Vec<ExprId> =
        inflows.iter().map(|i| g.binary(Binary::Max, i.flow, zero)).collect();
    let s = g.sum(positive.clone());
    // alpha = x^2*(3 - 2*x) with x = s/eps in 0..1
    let x = g.div(s, eps);
    let (one, two, three) = (g.real(1.0), g.real(2.0), g.real(3.0));
    let slope = g.mul(two, x);
    let slope = g.sub(three, slope);
    let square = g.mul(x, x);
    let rising = g.mul(square, slope);
    let large = g.binary(Binary::Greater, s, eps);
    let alpha = g.if_then_else(large, one, rising);
    let alpha = g.smooth(1, alpha);
    let alpha = g.no_event(alpha);
    let rest = g.sub(one, alpha);
    let rest = g.mul(rest, eps);
    let mut weights = Vec::with_capacity(inflows.len());
    let mut products = Vec::with_capacity(inflows.len());
    for (inflow, positive) in inflows.iter().zip(positive) {
        let weight = g.mul(alpha, positive);
        let weight = g.add(weight, rest);
        weights.push(weight);
        products.push(g.mul(weight, inflow.value));
    }
    let (numerator, denominator) = (g.sum(products), g.sum(weights));
    g.div(numerator, denominator)
}

/// The variable that stands for `inStream`, with the attributes of the stream variable.
pub(in crate::flatten) fn add_variable(flat: &mut FlatModel, stream: VarId) {
    let of = flat.variables[stream].clone();
    let name = format!("$inStream({})", of.name);
    let made = crate::flatten::variable::add_synthetic(flat, name, of.ty, of.span);
    let variable = &mut flat.variables[made];
    (variable.start, variable.nominal) = (of.start, of.nominal);
    (variable.min, variable.max) = (of.min, of.max);
    (variable.unit, variable.display_unit) = (of.unit, of.display_unit);
}
