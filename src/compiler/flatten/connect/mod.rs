//! Connections: sets of connected variables, equal potentials, flows that sum to zero (Modelica
//! 3.6, chapter 9).

pub(crate) mod cardinality;
pub mod cause;
pub(crate) mod connector;
mod equations;
pub(crate) mod expandable;
mod overconstrained;
mod sets;
pub(in crate::flatten) mod streams;
pub(crate) mod written;

use std::sync::Arc;

use self::connector::check_connectable;
use self::overconstrained::BrokenConnections;
use self::sets::ConnectionSets;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::reference::Selection;
use crate::graph::spanning_forest::Fate;
use crate::ir::ast::{ClassKind, ComponentRef, ConnectionPrefix, Variability};
use crate::ir::expr::{Binary, Const, ExprId, VarId};
use crate::ir::flat::{Assert, AssertionLevel, Origin};
use crate::ir::instance::{InstanceId, InstanceKind, Scope};
use cause::{ConnectCause, Mismatch};

/// The connections of a model.
#[derive(Default)]
pub struct Connections {
    potentials: ConnectionSets,
    flows: ConnectionSets,
    streams: ConnectionSets,
    /// Connections of overdetermined variables that close a cycle.
    broken: BrokenConnections,
    /// The residuals that are zero in the place of these connections.
    residuals: Vec<(ExprId, Origin)>,
    /// Assertions that connected parameters are equal.
    equalities: Vec<(Assert, Origin)>,
    /// Each `connect` of two connectors, if they are recorded.
    pub(super) recorded: Option<Vec<RecordedConnect>>,
}

/// A `connect` of two connectors as it occurs in the source.
pub(super) struct RecordedConnect {
    /// The component whose class contains it.
    pub(super) holder: InstanceId,
    /// The connectors.
    pub(super) ends: [InstanceId; 2],
    /// The equation.
    pub(super) span: Span,
}

impl Connections {
    /// No connections; each `connect` that is added will also be recorded.
    pub(super) fn recording() -> Self {
        Connections { recorded: Some(Vec::new()), ..Connections::default() }
    }

    /// Finds the connections of overdetermined variables that close a cycle.
    pub(super) fn break_cycles(&mut self, cx: &mut Evaluator<'_>, root: InstanceId) {
        self.broken = overconstrained::elaborate(cx, root);
    }

    /// The number of the set that contains a variable of an inside connector; the sets of
    /// potentials and of flows have different numbers.
    pub(super) fn node(&mut self, v: VarId) -> Option<usize> {
        for (k, sets) in [&mut self.potentials, &mut self.flows].into_iter().enumerate() {
            if let Some(member) = sets.number((v, false)) {
                return Some(2 * sets.root(member) + k);
            }
        }
        None
    }

    /// Adds `connect(a, b)` in the class of `scope.instance`.
    pub(super) fn connect(
        &mut self,
        cx: &mut Evaluator<'_>,
        a: &ComponentRef,
        b: &ComponentRef,
        span: Span,
        scope: Scope,
        component: &Arc<str>,
    ) -> Option<()> {
        if is_disabled(cx, a, scope) || is_disabled(cx, b, scope) {
            return Some(());
        }
        let (left, right) = (cx.select(a, scope), cx.select(b, scope));
        let (left, right) = (left?, right?);
        for (selection, end) in [(&left, a.span), (&right, b.span)] {
            check_connectable(cx, selection, scope, end)?;
        }
        if !connector::is_within_reach(cx, a, scope) || !connector::is_within_reach(cx, b, scope) {
            return None;
        }
        let outside = (is_outside(cx, a, scope), is_outside(cx, b, scope));
        let origin = Origin { span, component: component.clone() };
        let of = [&left, &right].map(first_instance);
        let pair =
            ConnectedPair { outside, origin, ends: (a.span, b.span), of, holder: scope.instance };
        self.pair(cx, &left, &right, &pair)
    }

    fn pair(
        &mut self,
        cx: &mut Evaluator<'_>,
        a: &Selection,
        b: &Selection,
        pair: &ConnectedPair,
    ) -> Option<()> {
        match (a, b) {
            (Selection::Absent, _) | (_, Selection::Absent) => Some(()),
            (Selection::Whole(x), Selection::Whole(y)) => self.instances(cx, *x, *y, pair),
            (Selection::Element(..), Selection::Element(..) | Selection::Whole(_))
            | (Selection::Whole(_), Selection::Element(..)) => {
                match (scalar(cx, a), scalar(cx, b)) {
                    (Some(x), Some(y)) => {
                        self.record(cx, x.0, y.0, pair);
                        self.scalars(cx, x, y, pair)
                    }
                    _ => mismatch(cx, pair, Mismatch::Kind),
                }
            }
            _ => {
                let (left, right) = (Elements::of(cx, a), Elements::of(cx, b));
                if left.are_absent() || right.are_absent() {
                    return Some(());
                }
                if left.all.len() != right.all.len() {
                    return mismatch(cx, pair, Mismatch::Sizes);
                }
                for (x, y) in left.all.iter().zip(&right.all) {
                    if is_absent(x) || is_absent(y) {
                        continue;
                    }
                    match (scalar(cx, x), scalar(cx, y)) {
                        (Some(x), Some(y)) => {
                            self.record(cx, x.0, y.0, pair);
                            self.scalars(cx, x, y, pair)?;
                        }
                        (None, None) => self.pair(cx, x, y, pair)?,
                        _ => return mismatch(cx, pair, Mismatch::Kind),
                    }
                }
                Some(())
            }
        }
    }

    fn instances(
        &mut self,
        cx: &mut Evaluator<'_>,
        x: InstanceId,
        y: InstanceId,
        pair: &ConnectedPair,
    ) -> Option<()> {
        cx.complete(x);
        cx.complete(y);
        match self.broken.fate(x, y) {
            Fate::Kept => {}
            Fate::Implied => return Some(()),
            Fate::Broken => {
                for e in overconstrained::residuals(cx, x, y, pair.origin.span)? {
                    self.residuals.push((e, pair.origin.clone()));
                }
                return Some(());
            }
        }
        let (kind_x, kind_y) = (cx.instances[x].kind.clone(), cx.instances[y].kind.clone());
        match (kind_x, kind_y) {
            (InstanceKind::Outer(inner), _) => self.instances(cx, inner, y, pair),
            (_, InstanceKind::Outer(inner)) => self.instances(cx, x, inner, pair),
            (InstanceKind::Absent | InstanceKind::Broken, _)
            | (_, InstanceKind::Absent | InstanceKind::Broken) => Some(()),
            (InstanceKind::Variable { dims: d, .. }, InstanceKind::Variable { dims: e, .. }) => {
                if d != e {
                    return mismatch(cx, pair, Mismatch::Sizes);
                }
                self.record(cx, x, y, pair);
                for k in 0..d.iter().product() {
                    self.scalars(cx, (x, k), (y, k), pair)?;
                }
                Some(())
            }
            (InstanceKind::Object(children), InstanceKind::Object(others)) => {
                if !is_connector(cx, x) || !is_connector(cx, y) {
                    let (which, end) =
                        if is_connector(cx, x) { (y, pair.ends.1) } else { (x, pair.ends.0) };
                    let path = cx.path(which);
                    let records = [x, y].into_iter().all(|i| is_record(cx, i));
                    if !records {
                        cx.report(ConnectCause::NotAConnector { path }, end);
                        return None;
                    }
                }
                let expandable = [x, y].map(|i| expandable::is_expandable(cx, i));
                if expandable[0] != expandable[1] {
                    // The elaboration has already reported this.
                    return None;
                }
                self.record(cx, x, y, pair);
                if expandable == [true; 2]
                    && children.len() != others.len()
                    && cx.problems.has_errors()
                {
                    // The expansion would not terminate, which has already been reported.
                    return None;
                }
                for child in children.iter() {
                    let name = cx.instances[*child].name;
                    match others.iter().find(|o| cx.instances[**o].name == name) {
                        Some(other) => self.instances(cx, *child, *other, pair)?,
                        None => {
                            return mismatch(cx, pair, Mismatch::OnlyOne(name));
                        }
                    }
                }
                if children.len() != others.len() {
                    return mismatch(cx, pair, Mismatch::Variables);
                }
                Some(())
            }
            (
                InstanceKind::Array { dims: d, elements },
                InstanceKind::Array { dims: e, elements: others },
            ) => {
                if d != e {
                    return mismatch(cx, pair, Mismatch::Sizes);
                }
                for (x, y) in elements.iter().zip(others.iter()) {
                    self.instances(cx, *x, *y, pair)?;
                }
                Some(())
            }
            // An array assembled from connections, and a declared one.
            (InstanceKind::Array { dims: d, .. }, InstanceKind::Variable { dims: e, .. })
            | (InstanceKind::Variable { dims: d, .. }, InstanceKind::Array { dims: e, .. })
                if d == e =>
            {
                let [left, right] = [x, y].map(|id| Elements::of(cx, &Selection::Whole(id)));
                for (x, y) in left.all.iter().zip(&right.all) {
                    self.pair(cx, x, y, pair)?;
                }
                Some(())
            }
            _ => mismatch(cx, pair, Mismatch::Kind),
        }
    }

    /// Records a pair of connectors, but not the connectors nested in them.
    fn record(
        &mut self,
        cx: &mut Evaluator<'_>,
        x: InstanceId,
        y: InstanceId,
        pair: &ConnectedPair,
    ) {
        let Some(recorded) = &mut self.recorded else { return };
        let inside = cx.instances[x].parent.is_some_and(|p| is_connector(cx, p));
        if !inside {
            recorded.push(RecordedConnect {
                holder: pair.holder,
                ends: [x, y],
                span: pair.origin.span,
            });
        }
    }

    fn scalars(
        &mut self,
        cx: &mut Evaluator<'_>,
        x: (InstanceId, usize),
        y: (InstanceId, usize),
        pair: &ConnectedPair,
    ) -> Option<()> {
        let connection = |i: InstanceId| cx.instances[i].prefix.connection;
        let prefix = connection(x.0);
        if prefix != connection(y.0) {
            return mismatch(cx, pair, Mismatch::FlowWithPotential);
        }
        let ty = |i: InstanceId| match cx.instances[i].kind {
            InstanceKind::Variable { ty, .. } => Some(ty),
            _ => None,
        };
        if ty(x.0) != ty(y.0) {
            return mismatch(cx, pair, Mismatch::Types);
        }
        // Signals must be connected to signals.
        let causal = [x.0, y.0].map(|i| cx.instances[i].prefix.causality.is_some());
        let bus = [x.0, y.0].into_iter().any(|i| expandable::is_within(cx, i));
        if causal[0] != causal[1] && !bus {
            let (signal, other) = if causal[0] { (x.0, y.0) } else { (y.0, x.0) };
            let (signal, other) = (cx.path(signal), cx.path(other));
            return mismatch(cx, pair, Mismatch::SignalWithOther { signal, other });
        }
        let fixed = |i: InstanceId| {
            matches!(
                cx.instances[i].prefix.variability,
                Some(Variability::Parameter | Variability::Constant)
            )
        };
        if fixed(x.0) || fixed(y.0) {
            let of = |i: InstanceId| cx.instances[i].prefix.variability.filter(|_| fixed(i));
            if of(x.0) != of(y.0) {
                let word = |v: Option<Variability>| match v {
                    Some(Variability::Constant) => "a constant",
                    Some(_) => "a parameter",
                    None => "a variable",
                };
                let both = [x.0, y.0].map(|i| (cx.path(i), word(of(i))));
                return mismatch(cx, pair, Mismatch::Variability(both));
            }
            return self.equal(cx, x, y, pair);
        }
        let number = |(i, k): (InstanceId, usize)| match cx.instances[i].kind {
            InstanceKind::Variable { first: Some(first), .. } => Some(VarId(first.0 + k as u32)),
            _ => None,
        };
        let (a, b) = ((number(x)?, pair.outside.0), (number(y)?, pair.outside.1));
        let sets = match prefix {
            Some(ConnectionPrefix::Flow) => &mut self.flows,
            Some(ConnectionPrefix::Stream) => &mut self.streams,
            None => &mut self.potentials,
        };
        sets.join(a, b, &pair.origin);
        Some(())
    }

    /// Requires that connected parameters and constants have the same value (Modelica 3.6, section
    /// 9.3).
    fn equal(
        &mut self,
        cx: &mut Evaluator<'_>,
        x: (InstanceId, usize),
        y: (InstanceId, usize),
        pair: &ConnectedPair,
    ) -> Option<()> {
        let mut read = |(i, k): (InstanceId, usize)| -> Option<ExprId> {
            let value = cx.instance_value(i, pair.origin.span)?;
            value.elements().get(k)?.scalar()
        };
        let (a, b) = (read(x)?, read(y)?);
        let same = cx.graph.binary(Binary::Equal, a, b);
        let names = [cx.path(x.0), cx.path(y.0)];
        match cx.graph.as_const(same) {
            Some(Const::Boolean(true)) => {}
            Some(Const::Boolean(false)) => {
                let show = |e| crate::symbolic::print::print(&cx.graph, e, &|_| String::new());
                let values = [show(a), show(b)];
                report_pair(cx, pair, ConnectCause::ValuesDiffer { names, values });
                return None;
            }
            _ => {
                let message =
                    format!("connected parameters differ: `{}` and `{}`", names[0], names[1]);
                let message = cx.graph.string(&message);
                let assert = Assert { condition: same, message, level: AssertionLevel::Error };
                self.equalities.push((assert, pair.origin.clone()));
            }
        }
        Some(())
    }
}

/// The context of a `connect`.
struct ConnectedPair {
    holder: InstanceId,
    outside: (bool, bool),
    origin: Origin,
    ends: (Span, Span),
    /// The connected instances, for messages.
    of: [Option<InstanceId>; 2],
}

fn mismatch(cx: &mut Evaluator<'_>, pair: &ConnectedPair, why: Mismatch) -> Option<()> {
    report_pair(cx, pair, ConnectCause::ConnectorsDiffer { why });
    None
}

fn report_pair(cx: &mut Evaluator<'_>, pair: &ConnectedPair, cause: ConnectCause) {
    let class = |id: Option<InstanceId>, otherwise: &str| {
        let class = id.and_then(|id| cx.instances[id].class);
        class.map_or(otherwise.to_string(), |c| format!("`{}`", cx.classes[c].full_name))
    };
    let (one, other) = (class(pair.of[0], "one"), class(pair.of[1], "the other"));
    cx.problems.push(
        Diagnostic::new(cause, pair.origin.span).also(pair.ends.0, one).also(pair.ends.1, other),
    );
}

/// Whether an end is a component whose condition is false. The connection goes with it, and with
/// the connection the variable that it would have added to an expandable connector at the other end
/// (sections 4.4.5 and 9.1.3).
fn is_disabled(cx: &mut Evaluator<'_>, end: &ComponentRef, scope: Scope) -> bool {
    let name = end.parts[0].name.name;
    cx.child(scope.instance, name).is_some_and(|first| {
        cx.complete(first);
        matches!(cx.instances[first].kind, InstanceKind::Absent)
    })
}

/// The first of the selected instances.
fn first_instance(s: &Selection) -> Option<InstanceId> {
    match s {
        Selection::Whole(id) | Selection::Element(id, _) => Some(*id),
        Selection::Many(_, all) | Selection::Dynamic(_, all) => {
            all.first().and_then(first_instance)
        }
        Selection::Absent => None,
    }
}

/// The elements of an array, of a slice, and of the arrays that are selected from each component of
/// an array, row by row.
#[derive(Default)]
struct Elements {
    all: Vec<Selection>,
}

impl Elements {
    fn of(cx: &mut Evaluator<'_>, selection: &Selection) -> Elements {
        let mut found = Elements::default();
        found.add(cx, selection);
        found
    }

    /// Whether no component has them, which then may have any size.
    fn are_absent(&self) -> bool {
        !self.all.is_empty() && self.all.iter().all(is_absent)
    }

    fn add(&mut self, cx: &mut Evaluator<'_>, selection: &Selection) {
        let Selection::Whole(id) = selection else {
            match selection {
                Selection::Many(_, all) => all.iter().for_each(|s| self.add(cx, s)),
                other => self.all.push(other.clone()),
            }
            return;
        };
        cx.complete(*id);
        match cx.instances[*id].kind.clone() {
            InstanceKind::Array { elements, .. } => {
                elements.iter().for_each(|e| self.add(cx, &Selection::Whole(*e)));
            }
            InstanceKind::Variable { dims, .. } if !dims.is_empty() => {
                let count = dims.iter().product();
                self.all.extend((0..count).map(|k| Selection::Element(*id, k)));
            }
            _ => self.all.push(selection.clone()),
        }
    }
}

fn is_absent(selection: &Selection) -> bool {
    matches!(selection, Selection::Absent)
}

/// The instance and element number of a scalar variable.
fn scalar(cx: &mut Evaluator<'_>, s: &Selection) -> Option<(InstanceId, usize)> {
    match s {
        Selection::Element(id, k) => Some((*id, *k)),
        Selection::Whole(id) => match &cx.instances[*id].kind {
            InstanceKind::Variable { dims, .. } if dims.is_empty() => Some((*id, 0)),
            _ => None,
        },
        _ => None,
    }
}

/// True for an *outside* connector: a connector of the class that contains the `connect`.
fn is_outside(cx: &mut Evaluator<'_>, r: &ComponentRef, scope: Scope) -> bool {
    match cx.child(scope.instance, r.parts[0].name.name) {
        Some(first) => is_connector(cx, first),
        None => false,
    }
}

pub(super) fn is_connector(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    cx.complete(id);
    if let InstanceKind::Outer(inner) = cx.instances[id].kind {
        return is_connector(cx, inner);
    }
    let Some(class) = cx.instances[id].class else { return false };
    matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector)
}

pub(in crate::flatten) fn is_record(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    let Some(class) = cx.instances[id].class else { return false };
    matches!(cx.kind(class), ClassKind::Record | ClassKind::OperatorRecord)
}
