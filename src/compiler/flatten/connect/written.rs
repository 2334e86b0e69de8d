//! The connections of a model as they are written, before equations are expanded: each `connect`,
//! and each operator of a connection graph such as `Connections.branch`, with the iterators around
//! it.
//!
//! Whatever the whole set of connections decides is found from this list: the variables of
//! expandable connectors, the number of connections of a connector, the roots of a graph.

use super::expandable::connection_ends::{
    self, ConnectionEnd, EndTarget, MissingVariable, is_assembled, is_unfilled,
};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::frame::Frames;
use crate::evaluate::implicit_ranges::Body;
use crate::ir::ast::{ComponentRef, Equation, EquationKind, Expr, ExprKind};
use crate::ir::instance::{InstanceId, InstanceKind, Scope, SectionKind};

/// A `connect` of the source with its enclosing iterators.
pub(crate) struct WrittenConnect {
    pub(crate) ends: [ComponentRef; 2],
    pub(crate) scope: Scope,
    pub(crate) frames: Frames,
    pub(crate) span: Span,
}

/// A call of an operator of `Connections`, with its enclosing iterators.
pub(crate) struct WrittenGraphCall {
    pub(crate) call: Expr,
    pub(crate) scope: Scope,
    pub(crate) frames: Frames,
}

/// All connections of a model.
#[derive(Default)]
pub(crate) struct Written {
    pub(crate) connects: Vec<WrittenConnect>,
    pub(crate) graph_calls: Vec<WrittenGraphCall>,
}

/// The connections of all components below `root`, in branches whose conditions hold.
pub(crate) fn below(cx: &mut Evaluator<'_>, root: InstanceId) -> Written {
    let mut written = Written::default();
    for object in crate::flatten::objects(cx, root) {
        let table = cx.table_of(object);
        for section in table.sections.iter().filter(|s| !s.initial) {
            if let SectionKind::Equations(list) = &section.kind {
                let scope = Scope { instance: object, class: section.class };
                collect(cx, list, scope, &mut written);
            }
        }
    }
    written
}

fn collect(cx: &mut Evaluator<'_>, list: &[Equation], scope: Scope, out: &mut Written) {
    for e in list {
        match &e.kind {
            EquationKind::Connect(a, b) => out.connects.push(WrittenConnect {
                ends: [a.clone(), b.clone()],
                scope,
                frames: cx.frames.clone(),
                span: e.span,
            }),
            EquationKind::Call(call) if is_graph_call(call) => {
                let (call, frames) = (call.clone(), cx.frames.clone());
                out.graph_calls.push(WrittenGraphCall { call, scope, frames });
            }
            EquationKind::For { iterators, body } if connects(body) => {
                let Some(iterators) = cx.with_ranges(iterators, Body::Equations(body), scope)
                else {
                    continue;
                };
                crate::flatten::equation::for_each(cx, &iterators, scope, &mut |cx| {
                    collect(cx, body, scope, out);
                });
            }
            EquationKind::If { branches, otherwise } if branch_connects(branches, otherwise) => {
                let mut chosen: Option<&[Equation]> = Some(otherwise);
                for (condition, body) in branches {
                    match cx.fold_boolean(condition, scope) {
                        Some(false) => continue,
                        Some(true) => chosen = Some(body),
                        None => chosen = None,
                    }
                    break;
                }
                collect(cx, chosen.unwrap_or_default(), scope, out);
            }
            _ => {}
        }
    }
}

/// True for a call of `Connections.branch`, `root` or `potentialRoot`.
pub(crate) fn is_graph_call(call: &Expr) -> bool {
    matches!(&call.kind, ExprKind::Call { function, .. } if is_of_connections(function))
}

/// True for a function of the predefined package `Connections` (Modelica 3.6, section 9.4.1).
fn is_of_connections(function: &ComponentRef) -> bool {
    function.parts.len() == 2 && function.parts[0].name.name == "Connections"
}

/// True if a `connect` or a call of an operator of `Connections` is among the equations.
pub(crate) fn connects(list: &[Equation]) -> bool {
    list.iter().any(|e| match &e.kind {
        EquationKind::Connect(..) => true,
        EquationKind::Call(call) => is_graph_call(call),
        EquationKind::For { body, .. } => connects(body),
        EquationKind::If { branches, otherwise } => branch_connects(branches, otherwise),
        _ => false,
    })
}

fn branch_connects(branches: &[(Expr, Vec<Equation>)], otherwise: &[Equation]) -> bool {
    branches.iter().any(|(_, body)| connects(body)) || connects(otherwise)
}

/// The pairs of ends of a connection, element by element.
pub(crate) fn pairs(
    cx: &mut Evaluator<'_>,
    connect: &WrittenConnect,
) -> Vec<(ConnectionEnd, ConnectionEnd)> {
    let [a, b] = &connect.ends;
    let (left, right) = cx.with_frames(&connect.frames, |cx| {
        (connection_ends::of(cx, a, connect.scope), connection_ends::of(cx, b, connect.scope))
    });
    let (Some(mut left), Some(mut right)) = (left, right) else { return Vec::new() };
    let is_uneven = left.iter().zip(&right).any(|(a, b)| is_one_an_array(cx, a, b));
    let open = [&left, &right].map(|ends| open_array(cx, ends));
    if left.len() != right.len() || is_uneven || open.iter().flatten().next().is_some() {
        // An array of connectors, and a connector of each component of an array.
        left = elements(cx, left);
        right = elements(cx, right);
        let (m, n) = (left.len(), right.len());
        extend(&mut left, open[0], n);
        extend(&mut right, open[1], m);
    }
    // `connect` itself reports wrong sizes and names.
    if left.len() == right.len() { left.into_iter().zip(right).collect() } else { Vec::new() }
}

/// The connector and the name of a variable that does not exist yet, or of an array that connections of its elements have
/// created, if that is the only end.
fn open_array(cx: &mut Evaluator<'_>, ends: &[ConnectionEnd]) -> Option<(InstanceId, Name)> {
    let [ConnectionEnd { at, member }] = ends else { return None };
    match at {
        EndTarget::Missing(MissingVariable { bus, name, index: None }) => Some((*bus, *name)),
        EndTarget::Instance(id) => {
            let (bus, name, _) = (*member)?;
            let is_open = cx.child(bus, name) == Some(*id) && is_assembled(cx, *id);
            is_open.then_some((bus, name))
        }
        _ => None,
    }
}

/// Makes a variable that does not exist yet, or an array of connected elements, as long as the array that it is connected to.
fn extend(ends: &mut Vec<ConnectionEnd>, open: Option<(InstanceId, Name)>, count: usize) {
    let Some((bus, name)) = open.filter(|_| ends.len() < count) else { return };
    if matches!(ends.as_slice(), [end] if is_whole(end)) {
        ends.clear();
    }
    ends.extend((ends.len()..count).map(|k| missing_element(bus, name, k)));
}

/// True for a variable that does not exist yet and is named without subscript.
fn is_whole(end: &ConnectionEnd) -> bool {
    matches!(end.at, EndTarget::Missing(MissingVariable { index: None, .. }))
}

/// The end that is element `k`, from 0, of an array of an expandable connector.
fn missing_element(bus: InstanceId, name: Name, k: usize) -> ConnectionEnd {
    let missing = MissingVariable { bus, name, index: Some(k + 1) };
    ConnectionEnd { at: EndTarget::Missing(missing), member: Some((bus, name, Some(k))) }
}

/// Whether just one of two instances is an array.
fn is_one_an_array(cx: &Evaluator<'_>, a: &ConnectionEnd, b: &ConnectionEnd) -> bool {
    let (EndTarget::Instance(a), EndTarget::Instance(b)) = (&a.at, &b.at) else { return false };
    let [a, b] = [a, b].map(|id| match &cx.instances[*id].kind {
        InstanceKind::Array { .. } => true,
        InstanceKind::Variable { dims, .. } => !dims.is_empty(),
        _ => false,
    });
    a != b
}

/// The ends with arrays of components split into their elements.
fn elements(cx: &Evaluator<'_>, ends: Vec<ConnectionEnd>) -> Vec<ConnectionEnd> {
    let mut out = Vec::with_capacity(ends.len());
    for end in ends {
        match end.at {
            EndTarget::Instance(id) => split(cx, id, &end, &mut out),
            _ => out.push(end),
        }
    }
    out
}

fn split(cx: &Evaluator<'_>, id: InstanceId, end: &ConnectionEnd, out: &mut Vec<ConnectionEnd>) {
    match &cx.instances[id].kind {
        InstanceKind::Array { elements, .. } => {
            for (k, e) in elements.iter().enumerate() {
                match end.member.filter(|_| is_unfilled(cx, *e)) {
                    Some((bus, name, _)) => out.push(missing_element(bus, name, k)),
                    None => split(cx, *e, end, out),
                }
            }
        }
        InstanceKind::Variable { dims, .. } if !dims.is_empty() => {
            let scalar = ConnectionEnd { at: EndTarget::Element(id), member: end.member };
            out.extend(vec![scalar; dims.iter().product()]);
        }
        _ => out.push(ConnectionEnd { at: EndTarget::Instance(id), member: end.member }),
    }
}
