//! Expandable connectors: determines the variables of each of them.
//!
//! In: the completed instances. Out: the same instances, with the variables that connections add to
//! expandable connectors and without those that no connection refers to. Modelica 3.6, section
//! 9.1.3.
//!
//! An expandable connector gets a variable if a connection refers to one that it does not have; its
//! type is that of the other end. Expandable connectors that are connected with each other,
//! directly or indirectly, form an *augmentation set*: each of them gets the variables of all
//! others. Both rules are applied until neither adds a variable, because a nested bus may itself be
//! added. After that, the connectors are ordinary ones, and `connect` generates their equations.

mod augment;
pub(crate) mod connection_ends;
mod presence;

use super::cause::ConnectCause;
use super::written::{self, WrittenConnect, pairs};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::ast::ClassKind;
use crate::ir::instance::{InstanceId, InstanceKind};

use connection_ends::EndTarget;

/// The augmentation sets (union-find).
#[derive(Default)]
struct AugmentationSets {
    /// The expandable connectors, in order of discovery.
    all: Vec<InstanceId>,
    number: FastMap<InstanceId, usize>,
    parent: Vec<usize>,
    /// Arrays whose size is determined by connections.
    open: FastSet<InstanceId>,
}

impl AugmentationSets {
    fn add(&mut self, bus: InstanceId) -> usize {
        if let Some(k) = self.number.get(&bus) {
            return *k;
        }
        let k = self.all.len();
        self.all.push(bus);
        self.parent.push(k);
        self.number.insert(bus, k);
        k
    }

    fn root(&self, mut k: usize) -> usize {
        while self.parent[k] != k {
            k = self.parent[k];
        }
        k
    }

    /// Merges the sets of two connectors; true if they were different.
    fn join(&mut self, a: InstanceId, b: InstanceId) -> bool {
        let (a, b) = (self.add(a), self.add(b));
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
        a != b
    }

    /// The members of each set, both in order of discovery.
    fn sets(&self) -> Vec<Vec<InstanceId>> {
        let mut at: Vec<Option<usize>> = vec![None; self.all.len()];
        let mut out: Vec<Vec<InstanceId>> = Vec::new();
        for k in 0..self.all.len() {
            let slot = *at[self.root(k)].get_or_insert_with(|| {
                out.push(Vec::new());
                out.len() - 1
            });
            out[slot].push(self.all[k]);
        }
        out
    }
}

/// Elaborates the expandable connectors below `root`.
pub(crate) fn elaborate(cx: &mut Evaluator<'_>, root: InstanceId) {
    let objects = crate::flatten::objects(cx, root);
    let mut buses = AugmentationSets::default();
    for id in objects.iter().copied().filter(|id| is_expandable(cx, *id)).collect::<Vec<_>>() {
        presence::check_declarations(cx, id);
        buses.add(id);
    }
    if buses.all.is_empty() {
        return;
    }
    let written = written::below(cx, root).connects;
    // Each round adds at least one variable, copied from finitely many declared ones. This
    // terminates because no set contains both a bus and a part of that bus.
    loop {
        let mut changed = false;
        for connect in &written {
            changed |= augment(cx, connect, &mut buses);
        }
        for set in buses.sets() {
            if let Some((inner, outer)) = contained(cx, &set) {
                report_self_containing(cx, inner, outer, &set, &written);
                return;
            }
            changed |= augment::equalize(cx, &set, &mut buses);
        }
        if !changed {
            break;
        }
    }
    presence::apply(cx, &written, &buses, root);
}

fn augment(cx: &mut Evaluator<'_>, connect: &WrittenConnect, buses: &mut AugmentationSets) -> bool {
    let mut changed = false;
    for (a, b) in pairs(cx, connect) {
        changed |= match (&a.at, &b.at) {
            (EndTarget::Missing(missing), there) | (there, EndTarget::Missing(missing)) => {
                augment::add(cx, missing, there, buses)
            }
            (EndTarget::Instance(x), EndTarget::Instance(y)) => join(cx, *x, *y, buses),
            _ => false,
        };
    }
    changed
}

/// A member of a set that is part of another member, and that other member.
fn contained(cx: &Evaluator<'_>, set: &[InstanceId]) -> Option<(InstanceId, InstanceId)> {
    let members: FastSet<InstanceId> = set.iter().copied().collect();
    set.iter().find_map(|&inner| {
        let mut at = cx.instances[inner].parent;
        while let Some(outer) = at.filter(|a| !members.contains(a)) {
            at = cx.instances[outer].parent;
        }
        at.map(|outer| (inner, outer))
    })
}

/// Reports that a bus would contain itself, at the connection that causes it.
fn report_self_containing(
    cx: &mut Evaluator<'_>,
    inner: InstanceId,
    outer: InstanceId,
    set: &[InstanceId],
    written: &[WrittenConnect],
) {
    let mut span = Span::NONE;
    for connect in written {
        let joins = pairs(cx, connect).iter().any(|(a, b)| {
            [a, b].iter().all(|end| matches!(end.at, EndTarget::Instance(id) if set.contains(&id)))
        });
        if joins {
            span = connect.span;
        }
    }
    let [outer, inner] = [outer, inner].map(|id| cx.path(id));
    cx.problems.push(
        Diagnostic::new(ConnectCause::ConnectedToOwnPart { outer, inner }, span)
            .label("each would get the variables of the other, without end"),
    );
}

/// Joins expandable connectors, or arrays of them.
fn join(
    cx: &mut Evaluator<'_>,
    x: InstanceId,
    y: InstanceId,
    buses: &mut AugmentationSets,
) -> bool {
    match (cx.instances[x].kind.clone(), cx.instances[y].kind.clone()) {
        (InstanceKind::Array { elements, .. }, InstanceKind::Array { elements: others, .. }) => {
            let mut changed = false;
            for (x, y) in elements.iter().zip(others.iter()) {
                changed |= join(cx, *x, *y, buses);
            }
            changed
        }
        (InstanceKind::Object(_), InstanceKind::Object(_)) => {
            is_expandable(cx, x) && is_expandable(cx, y) && buses.join(x, y)
        }
        (InstanceKind::Variable { dims, .. }, _) if dims.contains(&0) => {
            augment::resize(cx, x, y, buses)
        }
        (_, InstanceKind::Variable { dims, .. }) if dims.contains(&0) => {
            augment::resize(cx, y, x, buses)
        }
        _ => false,
    }
}

/// True if an instance is part of an expandable connector.
pub(crate) fn is_within(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    let mut at = cx.instances[id].parent;
    while let Some(holder) = at {
        if is_expandable(cx, holder) {
            return true;
        }
        let array = matches!(cx.instances[holder].kind, InstanceKind::Array { .. });
        if !array && !super::is_connector(cx, holder) {
            return false;
        }
        at = cx.instances[holder].parent;
    }
    false
}

/// True if an instance is an expandable connector.
pub(crate) fn is_expandable(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    let Some(class) = cx.instances[id].class else { return false };
    matches!(cx.instances[id].kind, InstanceKind::Object(_))
        && cx.kind(class) == ClassKind::ExpandableConnector
}
