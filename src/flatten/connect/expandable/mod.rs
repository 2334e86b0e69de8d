//! Expandable connectors: which variables each of them has.
//!
//! In: the completed instances. Out: the same, with what connections add to expandable connectors, and
//! without what no connection reaches. Modelica specification, section 9.1.3.
//!
//! An expandable connector gets a variable where a connection names one that it does not have; its
//! type is that of the other end. Expandable connectors that are connected with each other, directly or
//! through others, form an *augmentation set*: each of them gets what any of them has. Both rules
//! are applied until neither adds anything, because a bus inside a bus may itself be added. After that
//! the connectors are like any others, and `connect` makes equations of them.

mod augment;
pub(crate) mod connection_ends;
mod presence;

use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::evaluate::implicit_ranges::Body;
use crate::evaluate::value::Value;
use crate::instantiate::Context;
use crate::ir::ast::{ClassKind, ComponentRef, Equation, EquationKind, Expr};
use crate::ir::instance::{InstanceId, InstanceKind, Scope, SectionKind};

use connection_ends::{At, End};

/// A `connect` of the text, with the iterators around it.
pub(crate) struct Written {
    ends: [ComponentRef; 2],
    scope: Scope,
    locals: Vec<(Name, Value)>,
    span: Span,
}

/// What is known of the augmentation sets.
#[derive(Default)]
struct Buses {
    /// The expandable connectors, in order of discovery.
    all: Vec<InstanceId>,
    number: FastMap<InstanceId, usize>,
    parent: Vec<usize>,
    /// Arrays that have as many elements as connections name.
    open: FastSet<InstanceId>,
}

impl Buses {
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

    /// Puts two connectors into one set; true if they were in two.
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
pub(crate) fn elaborate(cx: &mut Context<'_>, root: InstanceId) {
    let objects = crate::flatten::objects(cx, root);
    let mut buses = Buses::default();
    for id in objects.iter().copied().filter(|id| is_expandable(cx, *id)).collect::<Vec<_>>() {
        presence::check_declarations(cx, id);
        buses.add(id);
    }
    if buses.all.is_empty() {
        return;
    }
    let mut written = Vec::new();
    for object in objects {
        let table = cx.table_of(object);
        for section in table.sections.iter().filter(|s| !s.initial) {
            if let SectionKind::Equations(list) = &section.kind {
                collect(cx, list, Scope { instance: object, class: section.class }, &mut written);
            }
        }
    }
    // Each round adds at least one variable, and they come from finitely many declared ones: no bus has
    // what a bus inside it has.
    loop {
        let mut changed = false;
        for connect in &written {
            changed |= augment(cx, connect, &mut buses);
        }
        for set in buses.sets() {
            if let Some((inner, around)) = contained(cx, &set) {
                report_endless(cx, inner, around, &set, &written);
                return;
            }
            changed |= augment::even_out(cx, &set, &mut buses);
        }
        if !changed {
            break;
        }
    }
    presence::settle(cx, &written, &buses, root);
}

/// The connections of a list of equations that stand under conditions which hold.
pub(crate) fn collect(
    cx: &mut Context<'_>,
    list: &[Equation],
    scope: Scope,
    out: &mut Vec<Written>,
) {
    for e in list {
        match &e.kind {
            EquationKind::Connect(a, b) => out.push(Written {
                ends: [a.clone(), b.clone()],
                scope,
                locals: cx.evaluation.locals.clone(),
                span: e.span,
            }),
            EquationKind::For { iterators, body } if holds_connect(body) => {
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

fn branch_connects(branches: &[(Expr, Vec<Equation>)], otherwise: &[Equation]) -> bool {
    branches.iter().any(|(_, body)| holds_connect(body)) || holds_connect(otherwise)
}

fn holds_connect(list: &[Equation]) -> bool {
    list.iter().any(|e| match &e.kind {
        EquationKind::Connect(..) => true,
        EquationKind::For { body, .. } => holds_connect(body),
        EquationKind::If { branches, otherwise } => branch_connects(branches, otherwise),
        _ => false,
    })
}

/// The two ends of a connection, element by element.
pub(crate) fn pairs(cx: &mut Context<'_>, connect: &Written) -> Vec<(End, End)> {
    let before = std::mem::replace(&mut cx.evaluation.locals, connect.locals.clone());
    let [a, b] = &connect.ends;
    let left = connection_ends::of(cx, a, connect.scope);
    let right = connection_ends::of(cx, b, connect.scope);
    cx.evaluation.locals = before;
    match (left, right) {
        (Some(left), Some(right)) if left.len() == right.len() => {
            left.into_iter().zip(right).collect()
        }
        // `connect` itself says what is wrong with the sizes or names.
        _ => Vec::new(),
    }
}

fn augment(cx: &mut Context<'_>, connect: &Written, buses: &mut Buses) -> bool {
    let mut changed = false;
    for (a, b) in pairs(cx, connect) {
        changed |= match (&a.at, &b.at) {
            (At::Missing(missing), there) | (there, At::Missing(missing)) => {
                augment::add(cx, missing, there, buses)
            }
            (At::Instance(x), At::Instance(y)) => join(cx, *x, *y, buses),
            _ => false,
        };
    }
    changed
}

/// A member of a set that stands in another one, and that.
fn contained(cx: &Context<'_>, set: &[InstanceId]) -> Option<(InstanceId, InstanceId)> {
    let members: FastSet<InstanceId> = set.iter().copied().collect();
    set.iter().find_map(|&inner| {
        let mut at = cx.instances[inner].parent;
        while let Some(around) = at.filter(|a| !members.contains(a)) {
            at = cx.instances[around].parent;
        }
        at.map(|around| (inner, around))
    })
}

/// Says that a bus would have itself, at a connection that makes it so.
fn report_endless(
    cx: &mut Context<'_>,
    inner: InstanceId,
    around: InstanceId,
    set: &[InstanceId],
    written: &[Written],
) {
    let mut span = Span::NONE;
    for connect in written {
        let joins = pairs(cx, connect).iter().any(|(a, b)| {
            [a, b].iter().all(|end| matches!(end.at, At::Instance(id) if set.contains(&id)))
        });
        if joins {
            span = connect.span;
        }
    }
    let [around, inner] = [around, inner].map(|id| cx.path(id));
    let message = format!("`{around}` is connected with `{inner}`, which is a part of it");
    cx.problems.push(
        Diagnostic::error("MO0276", span, message)
            .label("each would have what the other has, without an end")
            .help("connect a bus with buses that stand outside of it, or with variables in it")
            .note("section 9.1.3 of the specification"),
    );
}

/// Joins expandable connectors, or arrays of them.
fn join(cx: &mut Context<'_>, x: InstanceId, y: InstanceId, buses: &mut Buses) -> bool {
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

/// Whether an instance is a part of an expandable connector.
pub(crate) fn is_within(cx: &mut Context<'_>, id: InstanceId) -> bool {
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

/// Whether an instance is an expandable connector.
pub(crate) fn is_expandable(cx: &mut Context<'_>, id: InstanceId) -> bool {
    let Some(class) = cx.instances[id].class else { return false };
    matches!(cx.instances[id].kind, InstanceKind::Object(_))
        && cx.kind(class) == ClassKind::ExpandableConnector
}
