//! Presence of the variables of expandable connectors: a variable exists if a connection refers to
//! it, and a variable that is read needs a source (Modelica 3.6, section 9.1.3).

use super::super::written::{WrittenConnect, pairs};
use super::AugmentationSets;
use super::connection_ends::{BusMember, ConnectionEnd, EndTarget, is_unfilled};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::flatten::connect::cause::ConnectCause;
use crate::ir::ast::{Causality, ClassKind, ConnectionPrefix, Variability};
use crate::ir::instance::{InstanceId, InstanceKind};

/// How connections use a variable of an augmentation set.
#[derive(Clone, Copy, Default)]
struct MemberUse {
    /// A connection determines its value, or may do so.
    driven: bool,
    /// The first connection that only reads it.
    read: Option<Span>,
}

/// Checks the declarations in an expandable connector.
pub(super) fn check_declarations(cx: &mut Evaluator<'_>, bus: InstanceId) {
    let InstanceKind::Object(children) = cx.instances[bus].kind.clone() else { return };
    for &child in children.iter() {
        let variable = matches!(cx.instances[child].kind, InstanceKind::Variable { .. });
        if !variable || is_parameter(cx, child) {
            continue;
        }
        let (path, place) = (cx.path(child), cx.declared_at(child));
        if cx.instances[child].prefix.connection == Some(ConnectionPrefix::Flow) {
            let cause = ConnectCause::FlowInExpandable { path: path.clone() };
            cx.problems.push(
                Diagnostic::new(cause, place)
                    .note("an expandable connector has no flow variables of its own"),
            );
        }
        if let Some(binding) = cx.binding(child) {
            cx.problems.push(
                Diagnostic::new(ConnectCause::BoundInExpandable { path }, binding.value.span)
                    .also(place, "declared in an expandable connector")
                    .note("variables of expandable connectors exist if they are connected"),
            );
        }
    }
}

/// Removes variables that no connection refers to, and reports variables that are only read.
pub(super) fn apply(
    cx: &mut Evaluator<'_>,
    written: &[WrittenConnect],
    buses: &AugmentationSets,
    model: InstanceId,
) {
    let mut uses: FastMap<BusMember, MemberUse> = FastMap::default();
    let mut order: Vec<BusMember> = Vec::new();
    let root = |bus: InstanceId| buses.number.get(&bus).map(|k| buses.all[buses.root(*k)]);
    for connect in written {
        for (a, b) in pairs(cx, connect) {
            mismatched(cx, &a, &b, connect);
            for (end, other, k) in [(&a, &b, 1), (&b, &a, 0)] {
                // A connection between buses does not make their variables present.
                let whole = matches!(end.at, EndTarget::Instance(id) if is_bus(cx, id));
                let Some((bus, name, index)) = end.member.filter(|_| !whole) else { continue };
                let Some(first) = root(bus) else { continue };
                let member = (first, name, index);
                let entry = uses.entry(member).or_insert_with(|| {
                    order.push(member);
                    MemberUse::default()
                });
                match reads(cx, other, connect, k) {
                    true => entry.read = entry.read.or(Some(connect.span)),
                    false => entry.driven = true,
                }
            }
        }
    }
    // The surroundings of a component may drive the buses of its interface.
    let in_interface = |cx: &mut Evaluator<'_>, mut bus: InstanceId| {
        while let Some(parent) = cx.instances[bus].parent.filter(|parent| *parent != model) {
            let array = matches!(cx.instances[parent].kind, InstanceKind::Array { .. });
            if !array && !is_bus(cx, parent) {
                return false;
            }
            bus = parent;
        }
        !cx.instances[bus].protected
    };
    let mut open: FastSet<InstanceId> = FastSet::default();
    if cx.surrounded {
        open.extend(buses.all.iter().filter(|b| in_interface(cx, **b)).filter_map(|b| root(*b)));
    }
    for member in order {
        let (bus, name, index) = member;
        if open.contains(&bus) {
            continue;
        }
        // A connection of the whole array drives all its elements.
        let whole = uses.get(&(bus, name, None)).is_some_and(|u| u.driven);
        let some = index.is_none()
            && uses.iter().any(|((b, n, _), u)| (*b, *n) == (bus, name) && u.driven);
        let MemberUse { driven, read: Some(span) } = uses[&member] else { continue };
        if driven || whole || some {
            continue;
        }
        let path = cx.path(bus);
        let written = match index {
            Some(k) => format!("{path}.{name}[{}]", k + 1),
            None => format!("{path}.{name}"),
        };
        cx.problems.push(
            Diagnostic::new(ConnectCause::UndrivenVariable { path: written }, span)
                .label("read here")
                .note("an input of one expandable connector must not be an input in all others"),
        );
    }
    for &bus in &buses.all {
        let Some(first) = root(bus) else { continue };
        let InstanceKind::Object(children) = cx.instances[bus].kind.clone() else { continue };
        for &child in children.iter() {
            let name = cx.instances[child].name;
            if is_bus(cx, child)
                || is_parameter(cx, child)
                || uses.contains_key(&(first, name, None))
            {
                continue;
            }
            match cx.instances[child].kind.clone() {
                InstanceKind::Array { elements, .. } => {
                    for (k, &e) in elements.iter().enumerate() {
                        if !uses.contains_key(&(first, name, Some(k))) && !is_unfilled(cx, e) {
                            cx.instances[e].kind = InstanceKind::Absent;
                        }
                    }
                }
                InstanceKind::Variable { dims, .. } => {
                    let n = dims.iter().product();
                    if !(0..n).any(|k| uses.contains_key(&(first, name, Some(k)))) {
                        cx.instances[child].kind = InstanceKind::Absent;
                    }
                }
                InstanceKind::Object(_) => cx.instances[child].kind = InstanceKind::Absent,
                _ => {}
            }
        }
    }
}

/// True if the other end of a connection only reads the value: an input of a component, or an
/// output of the class that contains the connection.
fn reads(
    cx: &mut Evaluator<'_>,
    other: &ConnectionEnd,
    connect: &WrittenConnect,
    k: usize,
) -> bool {
    let (EndTarget::Instance(id) | EndTarget::Element(id)) = other.at else { return false };
    // A protected variable is not part of the interface, so its direction is unknown.
    if other.member.is_some() || cx.instances[id].protected {
        return false;
    }
    let outside = match cx.child(connect.scope.instance, connect.ends[k].parts[0].name.name) {
        Some(first) => crate::flatten::connect::is_connector(cx, first),
        None => false,
    };
    match cx.instances[id].prefix.causality {
        Some(Causality::Input) => !outside,
        Some(Causality::Output) => outside,
        _ => false,
    }
}

/// Reports a connection between an expandable and an ordinary connector.
fn mismatched(
    cx: &mut Evaluator<'_>,
    a: &ConnectionEnd,
    b: &ConnectionEnd,
    connect: &WrittenConnect,
) {
    let (EndTarget::Instance(x), EndTarget::Instance(y)) = (&a.at, &b.at) else { return };
    if is_bus(cx, *x) == is_bus(cx, *y) {
        return;
    }
    let (bus, other) = if is_bus(cx, *x) { (0, *y) } else { (1, *x) };
    let path = cx.path(other);
    let name = cx.sources.text(connect.ends[bus].span).unwrap_or("BUS").to_string();
    cx.problems.push(
        Diagnostic::new(ConnectCause::ExpandableWithOther { path, bus: name }, connect.span)
            .also(connect.ends[bus].span, "expandable")
            .note("expandable connectors are connected to expandable connectors only"),
    );
}

fn is_bus(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    match cx.instances[id].kind {
        InstanceKind::Object(_) | InstanceKind::Array { .. } => {
            let Some(class) = cx.instances[id].class else { return false };
            cx.kind(class) == ClassKind::ExpandableConnector
        }
        _ => false,
    }
}

fn is_parameter(cx: &Evaluator<'_>, id: InstanceId) -> bool {
    matches!(
        cx.instances[id].prefix.variability,
        Some(Variability::Parameter | Variability::Constant)
    )
}
