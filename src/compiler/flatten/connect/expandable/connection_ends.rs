//! Resolves the ends of connections, whose names may not exist yet.

use crate::base::name::Name;
use crate::evaluate::Evaluator;
use crate::ir::ast::{ComponentRef, RefPart, Subscript};
use crate::ir::expr::Const;
use crate::ir::instance::{InstanceId, InstanceKind, Scope};

/// One end of a connection, or one element of it.
#[derive(Clone, Debug)]
pub(crate) struct ConnectionEnd {
    /// The instance or variable.
    pub(crate) at: EndTarget,
    /// The innermost variable of an expandable connector that contains it or is it.
    pub(crate) member: Option<BusMember>,
}

/// A variable of an expandable connector, or an element of it, by its position.
pub(crate) type BusMember = (InstanceId, Name, Option<usize>);

/// The instance or variable at an end.
#[derive(Clone, Debug)]
pub(crate) enum EndTarget {
    /// A component as a whole.
    Instance(InstanceId),
    /// A scalar of an array variable.
    Element(InstanceId),
    /// A variable that does not exist yet.
    Missing(MissingVariable),
    /// A component whose condition is false.
    Absent,
}

/// A variable that an expandable connector does not have yet.
#[derive(Clone, Debug)]
pub(crate) struct MissingVariable {
    /// The connector.
    pub(crate) bus: InstanceId,
    /// The name.
    pub(crate) name: Name,
    /// Subscript, from 1, if it is an element of an array.
    pub(crate) index: Option<usize>,
}

/// The ends that a reference denotes, row-major; `None` if it cannot be resolved.
pub(crate) fn of(
    cx: &mut Evaluator<'_>,
    r: &ComponentRef,
    scope: Scope,
) -> Option<Vec<ConnectionEnd>> {
    let first = cx.child(scope.instance, r.parts[0].name.name)?;
    let mut out = Vec::new();
    follow(cx, first, &r.parts, true, scope, None, &mut out)?;
    Some(out)
}

fn follow(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    parts: &[RefPart],
    open: bool,
    scope: Scope,
    member: Option<BusMember>,
    out: &mut Vec<ConnectionEnd>,
) -> Option<()> {
    cx.complete(id);
    let (part, rest) = parts.split_first()?;
    let subscripts: &[Subscript] = if open { &part.subscripts } else { &[] };
    match cx.instances[id].kind.clone() {
        InstanceKind::Outer(inner) => follow(cx, inner, parts, open, scope, member, out),
        InstanceKind::Absent => {
            out.push(ConnectionEnd { at: EndTarget::Absent, member });
            Some(())
        }
        InstanceKind::Object(_) => {
            let Some(next) = rest.first() else {
                out.push(ConnectionEnd { at: EndTarget::Instance(id), member });
                return Some(());
            };
            let name = next.name.name;
            let bus = super::is_expandable(cx, id);
            match cx.child(id, name) {
                Some(child) => {
                    let member = if bus { Some((id, name, None)) } else { member };
                    follow(cx, child, rest, true, scope, member, out)
                }
                None if bus && rest.len() == 1 => missing(cx, id, next, scope, out),
                None => None,
            }
        }
        InstanceKind::Array { dims, elements } => {
            if subscripts.is_empty() && rest.is_empty() {
                out.push(ConnectionEnd { at: EndTarget::Instance(id), member });
                return Some(());
            }
            for k in chosen(cx, &dims, subscripts, scope)? {
                let member = member.map(|(bus, name, _)| (bus, name, Some(k)));
                match elements.get(k) {
                    // An element that no connection has created so far.
                    Some(e) if is_unfilled(cx, *e) => {
                        let (bus, name, _) = member?;
                        let missing = MissingVariable { bus, name, index: Some(k + 1) };
                        out.push(ConnectionEnd { at: EndTarget::Missing(missing), member });
                    }
                    Some(e) => follow(cx, *e, parts, false, scope, member, out)?,
                    None => {
                        let (bus, name, _) = member.filter(|_| dims.len() == 1)?;
                        let missing = MissingVariable { bus, name, index: Some(k + 1) };
                        out.push(ConnectionEnd { at: EndTarget::Missing(missing), member });
                    }
                }
            }
            Some(())
        }
        InstanceKind::Variable { dims, .. } => {
            if !rest.is_empty() {
                return None;
            }
            if subscripts.is_empty() {
                out.push(ConnectionEnd { at: EndTarget::Instance(id), member });
                return Some(());
            }
            for k in chosen(cx, &dims, subscripts, scope)? {
                let member = member.map(|(bus, name, _)| (bus, name, Some(k)));
                let inside = k < dims.iter().product();
                let at = match member {
                    _ if inside => EndTarget::Element(id),
                    Some((bus, name, _)) if dims.len() == 1 => {
                        EndTarget::Missing(MissingVariable { bus, name, index: Some(k + 1) })
                    }
                    _ => return None,
                };
                out.push(ConnectionEnd { at, member });
            }
            Some(())
        }
        InstanceKind::Pending | InstanceKind::InProgress | InstanceKind::Broken => None,
    }
}

/// True for an element of an augmented array to which no connection refers.
pub(crate) fn is_unfilled(cx: &Evaluator<'_>, id: InstanceId) -> bool {
    let instance = &cx.instances[id];
    matches!(instance.kind, InstanceKind::Absent) && instance.class.is_none()
}

/// True for an array that has no declaration with a size: connections of its elements have created it.
pub(crate) fn is_assembled(cx: &Evaluator<'_>, id: InstanceId) -> bool {
    match &cx.instances[id].kind {
        InstanceKind::Array { elements, .. } => {
            cx.instances[id].class.is_none() || elements.iter().any(|e| is_unfilled(cx, *e))
        }
        _ => false,
    }
}

fn missing(
    cx: &mut Evaluator<'_>,
    bus: InstanceId,
    part: &RefPart,
    scope: Scope,
    out: &mut Vec<ConnectionEnd>,
) -> Option<()> {
    let name = part.name.name;
    if part.subscripts.is_empty() {
        let missing = MissingVariable { bus, name, index: None };
        out.push(ConnectionEnd {
            at: EndTarget::Missing(missing),
            member: Some((bus, name, None)),
        });
        return Some(());
    }
    for k in chosen(cx, &[], &part.subscripts, scope)? {
        let missing = MissingVariable { bus, name, index: Some(k + 1) };
        out.push(ConnectionEnd {
            at: EndTarget::Missing(missing),
            member: Some((bus, name, Some(k))),
        });
    }
    Some(())
}

/// Positions from 0, row-major, that subscripts select. In an array with one dimension, they may
/// lie beyond its end.
fn chosen(
    cx: &mut Evaluator<'_>,
    dims: &[usize],
    subscripts: &[Subscript],
    scope: Scope,
) -> Option<Vec<usize>> {
    if dims.len() > 1 && subscripts.len() > dims.len() || dims.is_empty() && subscripts.len() > 1 {
        return None;
    }
    let mut positions = vec![0];
    for k in 0..dims.len().max(1) {
        let size = dims.get(k).copied();
        let list: Vec<usize> = match subscripts.get(k) {
            None | Some(Subscript::Colon(_)) => (1..=size?).collect(),
            Some(Subscript::Expr(e)) => {
                let value = match size {
                    Some(n) => cx.with_end(n, |cx| cx.fold(e, scope)),
                    None => cx.fold(e, scope),
                };
                let mut list = Vec::new();
                for element in value?.elements() {
                    let e = element.scalar()?;
                    let i = match cx.graph.as_const(e)? {
                        Const::Integer(i) => i,
                        Const::Enumeration(_, k) => i64::from(k),
                        Const::Boolean(b) => i64::from(b) + 1,
                        _ => return None,
                    };
                    list.push(usize::try_from(i).ok().filter(|i| *i > 0)?);
                }
                list
            }
        };
        if dims.len() > 1 && list.iter().any(|i| *i > dims[k]) {
            return None;
        }
        let stride = size.unwrap_or(0);
        positions = positions
            .iter()
            .flat_map(|at| list.iter().map(move |i| at * stride + (i - 1)).collect::<Vec<_>>())
            .collect();
    }
    Some(positions)
}
