//! Overconstrained connections (Modelica 3.6, section 9.4): a connector may hold a variable or
//! record with more elements than degrees of freedom, such as a rotation matrix. Connections in a
//! loop would then give more equations than unknowns.
//!
//! In: the connections as written, and the calls of `Connections.branch`, `root` and
//! `potentialRoot`. Out: the roots, for `isRoot` and `rooted`, and the connections that are broken:
//! there, the function `equalityConstraint` of the type takes the place of the equality. The graph
//! itself is [`spanning_forest`].

use super::cause::ConnectCause;
use super::expandable::connection_ends::EndTarget;
use super::written::{self, Written, WrittenGraphCall, pairs};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::connection_operator::{GraphRoots, equality_constraint};
use crate::evaluate::reference::Selection;
use crate::evaluate::value::Value;
use crate::graph::spanning_forest::{ConnectionGraph, Fate, SpanningForest, spanning_forest};
use crate::ir::ast::{Expr, ExprKind};
use crate::ir::expr::{Const, ExprId, Type};
use crate::ir::instance::{InstanceId, InstanceKind};

/// The connections of overdetermined variables that are not part of the spanning forest.
#[derive(Default)]
pub(super) struct BrokenConnections(FastMap<(InstanceId, InstanceId), Fate>);

impl BrokenConnections {
    /// The fate of the connection of two overdetermined variables.
    pub(super) fn fate(&self, a: InstanceId, b: InstanceId) -> Fate {
        self.0.get(&(a, b)).copied().unwrap_or(Fate::Kept)
    }
}

/// Selects the roots of the connection graph below `root`, and the connections to break.
pub(super) fn elaborate(cx: &mut Evaluator<'_>, root: InstanceId) -> BrokenConnections {
    if !cx.sources.contents().any(|text| text.contains("equalityConstraint")) {
        cx.builtins.graph_roots = Some(GraphRoots::default());
        return BrokenConnections::default();
    }
    let Written { connects, graph_calls } = written::below(cx, root);
    let mut nodes = Nodes::default();
    let mut graph = ConnectionGraph::default();
    let mut branch_spans = Vec::new();
    for written in &graph_calls {
        add_call(cx, written, &mut nodes, &mut graph, &mut branch_spans);
    }
    let mut ends: Vec<(InstanceId, InstanceId, Span)> = Vec::new();
    for connect in &connects {
        for (a, b) in pairs(cx, connect) {
            if let (EndTarget::Instance(a), EndTarget::Instance(b)) = (a.at, b.at) {
                overdetermined_pairs(cx, a, b, connect.span, &mut ends);
            }
        }
    }
    for &(a, b, span) in &ends {
        graph.breakable.push([nodes.of(a, span), nodes.of(b, span)]);
    }
    graph.nodes = nodes.all.len();
    let forest = spanning_forest(&graph);
    report(cx, root, &forest, &nodes, &branch_spans);
    cx.builtins.graph_roots = Some(roots(&graph, &forest, &nodes));
    let broken = ends.iter().zip(&forest.fates).filter(|(_, fate)| **fate != Fate::Kept);
    BrokenConnections(broken.map(|(&(a, b, _), fate)| ((a, b), *fate)).collect())
}

/// The nodes of the graph, numbered in order of occurrence.
#[derive(Default)]
struct Nodes {
    all: Vec<(InstanceId, Span)>,
    number: FastMap<InstanceId, usize>,
}

impl Nodes {
    fn of(&mut self, id: InstanceId, span: Span) -> usize {
        *self.number.entry(id).or_insert_with(|| {
            self.all.push((id, span));
            self.all.len() - 1
        })
    }
}

/// Adds a call of an operator to the graph.
fn add_call(
    cx: &mut Evaluator<'_>,
    written: &WrittenGraphCall,
    nodes: &mut Nodes,
    graph: &mut ConnectionGraph,
    branch_spans: &mut Vec<Span>,
) -> Option<()> {
    let span = written.call.span;
    let ExprKind::Call { function, args, named } = &written.call.kind else { return None };
    let argument = |cx: &mut Evaluator<'_>, e: &Expr| {
        cx.with_frames(&written.frames, |cx| arguments(cx, e, written))
    };
    match (function.parts[1].name.name.as_str(), args.as_slice()) {
        ("branch", [a, b]) => {
            for (a, b) in argument(cx, a)?.into_iter().zip(argument(cx, b)?) {
                graph.branches.push([nodes.of(a, span), nodes.of(b, span)]);
                branch_spans.push(span);
            }
        }
        ("root", [a]) => {
            for a in argument(cx, a)? {
                graph.roots.push(nodes.of(a, span));
            }
        }
        ("potentialRoot", [a]) | ("potentialRoot", [a, _]) => {
            let by_name = named.iter().find(|(n, _)| n.name == "priority").map(|(_, e)| e);
            let priority = match args.get(1).or(by_name) {
                Some(e) => {
                    let value = cx
                        .with_frames(&written.frames, |cx| cx.fold(e, written.scope))?
                        .scalar()?;
                    cx.graph.as_const(value).and_then(Const::number)? as i64
                }
                None => 0,
            };
            for a in argument(cx, a)? {
                graph.potential_roots.push((nodes.of(a, span), priority));
            }
        }
        _ => {
            let function = function.parts[1].name.name;
            cx.report(ConnectCause::GraphOperator { function }, span);
        }
    }
    Some(())
}

/// The overdetermined variables that an argument names.
fn arguments(
    cx: &mut Evaluator<'_>,
    e: &Expr,
    written: &WrittenGraphCall,
) -> Option<Vec<InstanceId>> {
    let ExprKind::Ref(r) = &e.kind else {
        cx.report(ConnectCause::NotOverdetermined, e.span);
        return None;
    };
    let selection = cx.select(r, written.scope)?;
    let mut found = Vec::new();
    if !overdetermined(cx, &selection, &mut found) {
        cx.report(ConnectCause::NotOverdetermined, e.span);
        return None;
    }
    Some(found)
}

fn overdetermined(cx: &mut Evaluator<'_>, at: &Selection, out: &mut Vec<InstanceId>) -> bool {
    match at {
        Selection::Absent => true,
        Selection::Many(_, all) => all.iter().all(|part| overdetermined(cx, part, out)),
        Selection::Element(..) | Selection::Dynamic(..) => false,
        Selection::Whole(id) => {
            cx.complete(*id);
            match cx.instances[*id].kind.clone() {
                InstanceKind::Outer(inner) => overdetermined(cx, &Selection::Whole(inner), out),
                InstanceKind::Absent | InstanceKind::Broken => true,
                InstanceKind::Array { elements, .. } => {
                    elements.iter().all(|e| overdetermined(cx, &Selection::Whole(*e), out))
                }
                _ if cx.is_overdetermined(*id) => {
                    out.push(*id);
                    true
                }
                _ => false,
            }
        }
    }
}

/// The pairs of overdetermined variables below two connected connectors.
fn overdetermined_pairs(
    cx: &mut Evaluator<'_>,
    x: InstanceId,
    y: InstanceId,
    span: Span,
    out: &mut Vec<(InstanceId, InstanceId, Span)>,
) {
    cx.complete(x);
    cx.complete(y);
    match (cx.instances[x].kind.clone(), cx.instances[y].kind.clone()) {
        (InstanceKind::Outer(inner), _) => overdetermined_pairs(cx, inner, y, span, out),
        (_, InstanceKind::Outer(inner)) => overdetermined_pairs(cx, x, inner, span, out),
        (InstanceKind::Array { elements, .. }, InstanceKind::Array { elements: others, .. }) => {
            for (x, y) in elements.iter().zip(others.iter()) {
                overdetermined_pairs(cx, *x, *y, span, out);
            }
        }
        (InstanceKind::Object(_) | InstanceKind::Variable { .. }, _)
            if cx.is_overdetermined(x) && cx.is_overdetermined(y) =>
        {
            out.push((x, y, span));
        }
        (InstanceKind::Object(children), InstanceKind::Object(others)) => {
            for child in children.iter() {
                let name = cx.instances[*child].name;
                if let Some(other) = others.iter().find(|o| cx.instances[**o].name == name) {
                    overdetermined_pairs(cx, *child, *other, span, out);
                }
            }
        }
        _ => {}
    }
}

/// The answers of `isRoot` and `rooted`.
fn roots(graph: &ConnectionGraph, forest: &SpanningForest, nodes: &Nodes) -> GraphRoots {
    let mut found = GraphRoots::default();
    for (k, (id, _)) in nodes.all.iter().enumerate() {
        if forest.is_root[k] {
            found.roots.insert(*id);
        }
    }
    // `rooted(a)` compares `a` with the other end of its branch, so there must be just one.
    let mut branches = vec![0; nodes.all.len()];
    for &[a, b] in &graph.branches {
        for (own, other) in [(a, b), (b, a)] {
            branches[own] += 1;
            let closer = match (forest.depth[own], forest.depth[other]) {
                (Some(own), Some(other)) => own < other,
                _ => false,
            };
            let id = nodes.all[own].0;
            match branches[own] {
                1 => found.rooted.insert(id, closer),
                _ => found.rooted.remove(&id),
            };
        }
    }
    found
}

fn report(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    forest: &SpanningForest,
    nodes: &Nodes,
    branch_spans: &[Span],
) {
    for &k in &forest.redundant_branches {
        cx.report(ConnectCause::BranchClosesCycle, branch_spans[k]);
    }
    for tree in &forest.rootless {
        // The surroundings of a component that is looked at by itself may hold the root.
        let is_open = tree.iter().any(|k| {
            let mut at = nodes.all[*k].0;
            while let Some(holder) = cx.instances[at].parent.filter(|_| {
                !cx.instances[at]
                    .class
                    .is_some_and(|c| matches!(cx.kind(c), crate::ir::ast::ClassKind::Connector))
            }) {
                at = holder;
            }
            cx.instances[at].parent == Some(root)
        });
        if !is_open {
            let (id, span) = nodes.all[tree[0]];
            let path = cx.path(id);
            cx.problems.push(Diagnostic::new(ConnectCause::NoRoot { path }, span));
        }
    }
}

/// The residuals of a broken connection, which are zero.
pub(super) fn residuals(
    cx: &mut Evaluator<'_>,
    x: InstanceId,
    y: InstanceId,
    span: Span,
) -> Option<Vec<ExprId>> {
    let class = cx.instances[x].class?;
    let function = cx.member_class(class, equality_constraint(), x)?;
    let arguments = vec![cx.instance_value(x, span)?, cx.instance_value(y, span)?];
    let value = cx.call_class(function, arguments, Vec::new(), span)?;
    let scalars: Option<Vec<ExprId>> = value.elements().iter().map(Value::scalar).collect();
    let valid = value.dims().len() == 1
        && scalars.as_ref().is_some_and(|s| s.iter().all(|e| cx.graph.ty(*e) == Type::Real));
    if !valid {
        let class = cx.classes[function].full_name;
        cx.report(ConnectCause::ConstraintType { class }, span);
        return None;
    }
    scalars
}
