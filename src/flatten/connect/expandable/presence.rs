//! Which variables of expandable connectors are present: those that a connection reaches. The others do
//! not exist, and each that is read needs something that writes it.

use super::connection_ends::{At, End, Member, unfilled};
use super::{Buses, Written, pairs};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::instantiate::Context;
use crate::ir::ast::{Causality, ClassKind, ConnectionPrefix, Variability};
use crate::ir::instance::{InstanceId, InstanceKind};

/// What connections do with a variable of an augmentation set.
#[derive(Clone, Copy, Default)]
struct Use {
    /// Something gives it a value, or may.
    driven: bool,
    /// The first connection that only reads it.
    read: Option<Span>,
}

/// What may not be declared in an expandable connector.
pub(super) fn check_declarations(cx: &mut Context<'_>, bus: InstanceId) {
    let InstanceKind::Object(children) = cx.instances[bus].kind.clone() else { return };
    for &child in children.iter() {
        let variable = matches!(cx.instances[child].kind, InstanceKind::Variable { .. });
        if !variable || is_parameter(cx, child) {
            continue;
        }
        let (path, place) = (cx.path(child), cx.declared_at(child));
        if cx.instances[child].prefix.connection == Some(ConnectionPrefix::Flow) {
            let message = format!("`{path}` is a flow variable of an expandable connector");
            cx.problems.push(
                Diagnostic::error("MO0243", place, message)
                    .help("declare it in a connector, and that in the expandable one")
                    .note(
                        "an expandable connector has no flow variables of its own (section 9.1.3)",
                    ),
            );
        }
        if let Some(binding) = cx.binding(child) {
            let message = format!("`{path}` is given a value, and may not be present at all");
            cx.problems.push(
                Diagnostic::error("MO0243", binding.value.span, message)
                    .also(place, "declared in an expandable connector")
                    .help("connect it to an output that has the value")
                    .note("variables of expandable connectors are present if they are connected (section 9.1.3)"),
            );
        }
    }
}

/// Removes what no connection reaches, and reports what is read only.
pub(super) fn settle(cx: &mut Context<'_>, written: &[Written], buses: &Buses, model: InstanceId) {
    let mut uses: FastMap<Member, Use> = FastMap::default();
    let mut order: Vec<Member> = Vec::new();
    let root = |bus: InstanceId| buses.number.get(&bus).map(|k| buses.all[buses.root(*k)]);
    for connect in written {
        for (a, b) in pairs(cx, connect) {
            mismatched(cx, &a, &b, connect);
            for (end, other, k) in [(&a, &b, 1), (&b, &a, 0)] {
                // A bus that is connected to a bus says nothing of its variables.
                let whole = matches!(end.at, At::Instance(id) if is_bus(cx, id));
                let Some((bus, name, index)) = end.member.filter(|_| !whole) else { continue };
                let Some(first) = root(bus) else { continue };
                let member = (first, name, index);
                let entry = uses.entry(member).or_insert_with(|| {
                    order.push(member);
                    Use::default()
                });
                match reads(cx, other, connect, k) {
                    true => entry.read = entry.read.or(Some(connect.span)),
                    false => entry.driven = true,
                }
            }
        }
    }
    // What surrounds a component may give values to the buses that lead out of it.
    let leads_out = |cx: &mut Context<'_>, mut bus: InstanceId| {
        while let Some(around) = cx.instances[bus].parent.filter(|around| *around != model) {
            let array = matches!(cx.instances[around].kind, InstanceKind::Array { .. });
            if !array && !is_bus(cx, around) {
                return false;
            }
            bus = around;
        }
        !cx.instances[bus].protected
    };
    let mut open: FastSet<InstanceId> = FastSet::default();
    if cx.surrounded {
        open.extend(buses.all.iter().filter(|b| leads_out(cx, **b)).filter_map(|b| root(*b)));
    }
    for member in order {
        let (bus, name, index) = member;
        if open.contains(&bus) {
            continue;
        }
        // What is connected as a whole somewhere is driven element by element, too.
        let whole = uses.get(&(bus, name, None)).is_some_and(|u| u.driven);
        let some = index.is_none()
            && uses.iter().any(|((b, n, _), u)| (*b, *n) == (bus, name) && u.driven);
        let Use { driven, read: Some(span) } = uses[&member] else { continue };
        if driven || whole || some {
            continue;
        }
        let path = cx.path(bus);
        let written = match index {
            Some(k) => format!("{path}.{name}[{}]", k + 1),
            None => format!("{path}.{name}"),
        };
        cx.problems.push(
            Diagnostic::error("MO0244", span, format!("nothing gives `{written}` a value"))
                .label("read here")
                .help("connect an output to it, here or at any connector that this one is connected to")
                .note("what is an input in one expandable connector is none in another (section 9.1.3)"),
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
                        if !uses.contains_key(&(first, name, Some(k))) && !unfilled(cx, e) {
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

/// Whether the other end of a connection only takes the value: an input of a component, or an output
/// of the class in which the connection stands.
fn reads(cx: &mut Context<'_>, other: &End, connect: &Written, k: usize) -> bool {
    let (At::Instance(id) | At::Element(id)) = other.at else { return false };
    // What is protected is no part of the interface: nothing is known of its direction.
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

/// An expandable connector meets an ordinary one.
fn mismatched(cx: &mut Context<'_>, a: &End, b: &End, connect: &Written) {
    let (At::Instance(x), At::Instance(y)) = (&a.at, &b.at) else { return };
    if is_bus(cx, *x) == is_bus(cx, *y) {
        return;
    }
    let (bus, other) = if is_bus(cx, *x) { (0, *y) } else { (1, *x) };
    let path = cx.path(other);
    let text = cx.sources.text(connect.ends[bus].span).unwrap_or("BUS").to_string();
    let message =
        format!("an expandable connector is connected to `{path}`, which is not expandable");
    cx.problems.push(
        Diagnostic::error("MO0230", connect.span, message)
            .also(connect.ends[bus].span, "expandable")
            .help(format!("name a variable of the expandable connector: `{text}.NAME`"))
            .note(
                "expandable connectors are connected to expandable connectors only (section 9.1.3)",
            ),
    );
}

fn is_bus(cx: &mut Context<'_>, id: InstanceId) -> bool {
    match cx.instances[id].kind {
        InstanceKind::Object(_) | InstanceKind::Array { .. } => {
            let Some(class) = cx.instances[id].class else { return false };
            cx.kind(class) == ClassKind::ExpandableConnector
        }
        _ => false,
    }
}

fn is_parameter(cx: &Context<'_>, id: InstanceId) -> bool {
    matches!(
        cx.instances[id].prefix.variability,
        Some(Variability::Parameter | Variability::Constant)
    )
}
