//! Connection equations (Modelica 3.6, section 9.2).

use std::sync::Arc;

use super::cause::ConnectCause;
use super::connector::check_single_source;
use super::{Connections, expandable, is_connector};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::evaluate::Evaluator;
use crate::ir::ast::ConnectionPrefix;
use crate::ir::expr::{Binary, ExprId, Graph, Node, Unary, VarId};
use crate::ir::flat::{Equation, EquationKind, FlatModel, Origin};
use crate::ir::instance::{InstanceId, InstanceKind};

impl Connections {
    /// Generates the connection equations: equal potentials, flows that sum to zero, and zero flows
    /// of unconnected connectors.
    pub(in crate::flatten) fn equations(
        &mut self,
        cx: &mut Evaluator<'_>,
        root: InstanceId,
        flat: &mut FlatModel,
    ) {
        let (mut seen, mut seen_in) = (vec![0; self.potentials.number.len()], 0_u32);
        for (members, origin) in self.potentials.sets() {
            check_single_source(cx, flat, &members, origin.span);
            // A variable may occur twice, as an inside and as an outside connector.
            seen_in += 1;
            let mut variables = members
                .iter()
                .map(|m| m.0)
                .filter(|v| std::mem::replace(&mut seen[v.0 as usize], seen_in) != seen_in);
            let Some(first) = variables.next() else { continue };
            let a = read(cx, flat, first);
            for v in variables {
                let b = read(cx, flat, v);
                let kind = EquationKind::Equal(a, b);
                flat.equations.push(Equation { kind, origin: origin.clone() });
            }
        }
        for (members, origin) in self.flows.sets() {
            let mut terms = Vec::with_capacity(members.len());
            for (v, outside) in members {
                let e = read(cx, flat, v);
                terms.push(if outside { cx.graph.neg(e) } else { e });
            }
            let sum = cx.graph.sum(terms);
            let zero = cx.graph.real(0.0);
            flat.equations.push(Equation { kind: EquationKind::Equal(sum, zero), origin });
        }
        for (residual, origin) in self.residuals.drain(..) {
            let zero = cx.graph.real(0.0);
            let kind = EquationKind::Equal(zero, residual);
            flat.equations.push(Equation { kind, origin });
        }
        self.stream_equations(cx, flat);
        for (assert, origin) in self.equalities.drain(..) {
            flat.equations.push(Equation { kind: EquationKind::Assert(assert), origin });
        }
        let mut in_connector: FastMap<InstanceId, bool> = FastMap::default();
        // For each component with flows, whether one of them is connected.
        let mut connected: FastMap<InstanceId, bool> = FastMap::default();
        let mut any_connected = false;
        // The flows of connectors, whether they are connected.
        let mut ends: FastMap<VarId, bool> = FastMap::default();
        for v in flat.variables.ids() {
            let (instance, _) = cx.instance_of[v.0 as usize];
            if cx.instances[instance].prefix.connection != Some(ConnectionPrefix::Flow) {
                continue;
            }
            // Variables that connections have added to a bus also need a zero flow on the inside
            // (Modelica 3.6, section 9.2).
            let inside = self.flows.number((v, false)).is_some();
            let outside = self.flows.number((v, true)).is_some();
            any_connected |= inside || outside;
            if is_in_connector(cx, instance, &mut in_connector) {
                let component = component_of(cx, instance, root);
                *connected.entry(component).or_default() |= inside || outside;
                ends.insert(v, inside || outside);
            }
            if inside && (outside || !expandable::is_within(cx, instance))
                || !is_in_connector(cx, instance, &mut in_connector)
            {
                continue;
            }
            let e = read(cx, flat, v);
            let zero = cx.graph.real(0.0);
            let component = match cx.instances[instance].parent {
                Some(p) => cx.path(p).into(),
                None => Arc::from(""),
            };
            let origin = Origin { span: flat.variables[v].span, component };
            flat.equations.push(Equation { kind: EquationKind::Equal(e, zero), origin });
        }
        if any_connected && !cx.problems.has_errors() {
            report_isolated(cx, root, &connected);
            report_open_ends(cx, root, &ends, flat);
        }
    }
}

/// Warns of components that flows alone could connect with others, and none does: one that was
/// forgotten in the connections computes something all the same.
fn report_isolated(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    connected: &FastMap<InstanceId, bool>,
) {
    let acts_otherwise = |cx: &Evaluator<'_>, component: InstanceId| {
        let mut open = vec![component];
        while let Some(id) = open.pop() {
            let instance = &cx.instances[id];
            let is_inner = instance.declaration.as_ref().is_some_and(|d| d.element.inner);
            if instance.prefix.causality.is_some() || is_inner {
                return true;
            }
            match &cx.instances[id].kind {
                InstanceKind::Object(parts) | InstanceKind::Array { elements: parts, .. } => {
                    open.extend(parts.iter());
                }
                _ => {}
            }
        }
        false
    };
    let mut isolated: Vec<InstanceId> =
        connected.iter().filter(|(_, is_connected)| !**is_connected).map(|(id, _)| *id).collect();
    isolated.sort_unstable();
    for component in isolated {
        // Within components, connectors may be left open on purpose.
        let is_own = cx.instances[component].parent == Some(root);
        if component == root || !is_own || acts_otherwise(cx, component) {
            continue;
        }
        let cause = ConnectCause::IsolatedComponent { path: cx.path(component) };
        let span = cx.declared_at(component);
        cx.problems.push(Diagnostic::new(cause, span));
    }
}

/// Warns of components with an open end through which nothing flows for this reason: their equations say
/// that the flow of an end without connection, which is zero, is that of one with a connection.
fn report_open_ends(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    ends: &FastMap<VarId, bool>,
    flat: &FlatModel,
) {
    // Variables that are equal up to their signs.
    let mut equal: FastMap<VarId, Vec<VarId>> = FastMap::default();
    for equation in &flat.equations {
        let EquationKind::Equal(a, b) = equation.kind else { continue };
        let Some([v, w]) = signed_pair(&cx.graph, a, b) else { continue };
        equal.entry(v).or_default().push(w);
        equal.entry(w).or_default().push(v);
    }
    let mut open: Vec<VarId> = ends.iter().filter(|(_, is)| !**is).map(|(v, _)| *v).collect();
    open.sort_unstable();
    for v in open {
        let (instance, _) = cx.instance_of[v.0 as usize];
        let component = component_of(cx, instance, root);
        // Within components, connectors may be left open on purpose.
        if component == root || cx.instances[component].parent != Some(root) {
            continue;
        }
        let (mut found, mut todo) = (vec![v], vec![v]);
        let mut is_stopped = false;
        while let Some(at) = todo.pop() {
            for next in equal.get(&at).into_iter().flatten() {
                let Some((of, _)) = cx.instance_of.get(next.0 as usize).copied() else { continue };
                if found.contains(next) || component_of(cx, of, root) != component {
                    continue;
                }
                is_stopped |= ends.get(next) == Some(&true);
                found.push(*next);
                todo.push(*next);
            }
        }
        if is_stopped {
            let parent = cx.instances[instance].parent;
            let of = parent.filter(|_| !is_connector(cx, instance)).unwrap_or(instance);
            let connector = cx.path(of);
            let cause = ConnectCause::OpenEnd { connector, path: cx.path(component) };
            let span = cx.declared_at(component);
            cx.problems.push(Diagnostic::new(cause, span));
        }
    }
}

/// The variables of `a = b`, `a = -b` and `a + b = 0`.
fn signed_pair(graph: &Graph, a: ExprId, b: ExprId) -> Option<[VarId; 2]> {
    let mut open = vec![a, b];
    open.retain(|side| graph.as_number(*side) != Some(0.0));
    let mut found = Vec::with_capacity(2);
    while let Some(e) = open.pop() {
        if open.len() + found.len() >= 2 {
            return None;
        }
        match graph.node(e) {
            Node::Var(v) => found.push(v),
            Node::Unary(Unary::Neg, a) => open.push(a),
            Node::Binary(Binary::Add | Binary::Sub, a, b) => open.extend([a, b]),
            _ => return None,
        }
    }
    <[VarId; 2]>::try_from(found).ok()
}

/// The component that holds a connector with this variable.
fn component_of(cx: &mut Evaluator<'_>, instance: InstanceId, root: InstanceId) -> InstanceId {
    let mut at = instance;
    while at != root {
        let Some(parent) = cx.instances[at].parent else { return root };
        at = parent;
        let is_array = matches!(cx.instances[at].kind, InstanceKind::Array { .. });
        if !is_array && !is_connector(cx, at) && !super::is_record(cx, at) {
            break;
        }
    }
    at
}

/// True if a flow variable belongs to a connector; others are ordinary variables.
fn is_in_connector(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    known: &mut FastMap<InstanceId, bool>,
) -> bool {
    if let Some(known) = known.get(&id) {
        return *known;
    }
    let parent = cx.instances[id].parent;
    let found =
        is_connector(cx, id) || parent.is_some_and(|parent| is_in_connector(cx, parent, known));
    known.insert(id, found);
    found
}

fn read(cx: &mut Evaluator<'_>, flat: &FlatModel, v: VarId) -> ExprId {
    cx.graph.var(v, flat.variables[v].ty)
}
