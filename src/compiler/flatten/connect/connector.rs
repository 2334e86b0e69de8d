//! Checks of connector classes and connection sets: as many flows as potentials, and one source of
//! each signal (Modelica 3.6, sections 9.3 and 9.3.1).

use super::cause::ConnectCause;
use super::sets::SetMember;
use super::{expandable, is_connector};
use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::reference::Selection;
use crate::ir::ast::{Causality, ClassKind, ComponentRef, ConnectionPrefix, TypePrefix};
use crate::ir::expr::VarId;
use crate::ir::flat::FlatModel;
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};

/// Numbers of scalar variables of a connector by kind.
#[derive(Default)]
struct ScalarCounts {
    potentials: usize,
    flows: usize,
    /// Streams and flows of this connector or one nested in it whose streams are not transported by one flow.
    untransported: Option<Transport>,
    /// Part of an overconstrained connection graph, where the numbers need not match.
    overdetermined: bool,
}

/// Numbers of scalar variables of a connector, without those of connectors nested in it.
#[derive(Clone, Copy, Default)]
struct Transport {
    streams: usize,
    flows: usize,
}

/// Checks the classes of all connectors among `components`, each class once.
pub(crate) fn check(cx: &mut Evaluator<'_>, root: InstanceId) {
    if cx.problems.has_errors() {
        // A missing variable may be the consequence of an earlier error.
        return;
    }
    let mut seen: FastSet<ClassId> = FastSet::default();
    let mut stack = vec![root];
    while let Some(id) = stack.pop() {
        let below: Vec<InstanceId> = match &cx.instances[id].kind {
            InstanceKind::Object(children) => children.to_vec(),
            InstanceKind::Array { elements, .. } => elements.iter().take(1).copied().collect(),
            InstanceKind::Variable { .. } => Vec::new(),
            _ => continue,
        };
        if let Some(class) = cx.instances[id].class
            && cx.kind(class) == ClassKind::Block
            && seen.insert(class)
        {
            check_block(cx, id);
        }
        if id != root
            && let Some(class) = cx.instances[id].class
            && !matches!(cx.instances[id].kind, InstanceKind::Array { .. })
            && cx.kind(class) == ClassKind::Connector
        {
            let text = cx.definition(class).cloned();
            if seen.insert(class) && text.is_some_and(|t| !t.partial) {
                let mut counts = ScalarCounts::default();
                count_of_connector(cx, id, &mut counts);
                report(cx, id, class, &counts);
            }
            continue;
        }
        if let Some(class) = cx.instances[id].class
            && cx.kind(class) == ClassKind::ExpandableConnector
        {
            continue;
        }
        stack.extend(below.into_iter().rev());
    }
}

/// Checks that all public connectors of a block consist of inputs and outputs (Modelica 3.6,
/// section 4.6).
fn check_block(cx: &mut Evaluator<'_>, block: InstanceId) {
    let InstanceKind::Object(children) = cx.instances[block].kind.clone() else { return };
    for child in children.iter().copied() {
        let class = cx.instances[child].class;
        if cx.instances[child].protected
            || !class.is_some_and(|c| cx.kind(c) == ClassKind::Connector)
        {
            continue;
        }
        let mut stack = vec![child];
        while let Some(id) = stack.pop() {
            match cx.instances[id].kind.clone() {
                InstanceKind::Object(parts) | InstanceKind::Array { elements: parts, .. } => {
                    stack.extend(parts.iter());
                }
                InstanceKind::Variable { .. } => {
                    let prefix = cx.instances[id].prefix;
                    let fixed = prefix
                        .variability
                        .is_some_and(|v| v < crate::ir::ast::Variability::Discrete);
                    if prefix.causality.is_none() && !fixed {
                        report_undirected(cx, child, id);
                        return;
                    }
                }
                _ => {}
            }
        }
    }
}

fn report_undirected(cx: &mut Evaluator<'_>, connector: InstanceId, variable: InstanceId) {
    let cause = ConnectCause::UndirectedInBlock { variable: cx.path(variable) };
    cx.class_graph.problems.push(
        Diagnostic::new(cause, cx.declared_at(connector))
            .also(cx.declared_at(variable), "declared here"),
    );
}

/// Checks that a flow variable of an operator record type has the operators that its sum needs
/// (Modelica 3.6, section 9.2).
fn check_conserved(cx: &mut Evaluator<'_>, id: InstanceId) {
    let Some(class) = cx.instances[id].class else { return };
    if cx.instances[id].prefix.connection != Some(ConnectionPrefix::Flow)
        || cx.kind(class) != ClassKind::OperatorRecord
    {
        return;
    }
    let missing = [("'0'", 0), ("'+'", 2), ("'-'", 1)]
        .into_iter()
        .find(|(operator, inputs)| !cx.has_operator(class, operator, *inputs));
    let Some((operator, _)) = missing else { return };
    let (path, class) = (cx.path(id), cx.classes[class].full_name);
    let span = cx.declared_at(id);
    cx.report(ConnectCause::FlowWithoutOperator { path, class, operator }, span);
}

/// Counts the variables of a connector. Those of nested connectors count as well, but each has its own streams.
fn count_of_connector(cx: &mut Evaluator<'_>, id: InstanceId, counts: &mut ScalarCounts) {
    let mut own = Transport::default();
    count_scalars(cx, id, counts, &mut own);
    if own.streams > 0 && own.flows != 1 {
        counts.untransported.get_or_insert(own);
    }
}

fn count_scalars(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    counts: &mut ScalarCounts,
    own: &mut Transport,
) {
    counts.overdetermined |= cx.is_overdetermined(id);
    match cx.instances[id].kind.clone() {
        InstanceKind::Variable { dims, .. } => {
            let n: usize = dims.iter().product();
            match cx.instances[id].prefix {
                TypePrefix { variability: Some(v), .. }
                    if v < crate::ir::ast::Variability::Discrete => {}
                TypePrefix { connection: Some(ConnectionPrefix::Stream), .. } => own.streams += n,
                TypePrefix { connection: Some(ConnectionPrefix::Flow), .. } => {
                    counts.flows += n;
                    own.flows += n;
                }
                TypePrefix { causality: Some(_), .. } => {}
                _ => counts.potentials += n,
            }
        }
        InstanceKind::Object(children) => {
            check_conserved(cx, id);
            children.iter().for_each(|part| count_part(cx, *part, counts, own));
        }
        InstanceKind::Array { elements, .. } => {
            elements.iter().for_each(|part| count_part(cx, *part, counts, own));
        }
        _ => {}
    }
}

fn count_part(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    counts: &mut ScalarCounts,
    own: &mut Transport,
) {
    let is_nested =
        is_connector(cx, id) && matches!(cx.instances[id].kind, InstanceKind::Object(_));
    match is_nested {
        true => count_of_connector(cx, id, counts),
        false => count_scalars(cx, id, counts, own),
    }
}

fn report(cx: &mut Evaluator<'_>, id: InstanceId, class: ClassId, counts: &ScalarCounts) {
    let ScalarCounts { potentials, flows, untransported, overdetermined } = *counts;
    let full_name = cx.classes[class].full_name;
    let name = full_name.rsplit('.').next().unwrap_or_default();
    let declared = cx.definition(class).map_or(Span::NONE, |t| t.name.span);
    if let Some(Transport { streams, flows }) = untransported {
        let cause = ConnectCause::StreamFlows { connector: name.to_string(), streams, flows };
        cx.class_graph
            .problems
            .push(Diagnostic::new(cause, declared).also(cx.declared_at(id), "of this class"));
        return;
    }
    if potentials == flows || overdetermined {
        return;
    }
    let cause =
        ConnectCause::UnbalancedConnector { connector: name.to_string(), potentials, flows };
    cx.class_graph
        .problems
        .push(Diagnostic::new(cause, declared).also(cx.declared_at(id), "of this class"));
}

/// True if a variable determines the value of its connection set: an output of an inside component,
/// or a public input of the component itself.
pub(crate) fn is_source(cx: &Evaluator<'_>, v: VarId, outside: bool) -> bool {
    let (id, _) = cx.instance_of[v.0 as usize];
    match cx.instances[id].prefix.causality {
        Some(Causality::Output) => !outside,
        Some(Causality::Input) => outside && !cx.instances[id].protected,
        None => false,
    }
}

/// Checks that an end of a connection is a connector or part of one (Modelica 3.6, section 9.1).
pub(super) fn check_connectable(
    cx: &mut Evaluator<'_>,
    selection: &Selection,
    scope: Scope,
    span: Span,
) -> Option<()> {
    let mut selection = selection;
    while let Selection::Many(_, all) = selection {
        selection = all.first()?;
    }
    let (Selection::Whole(id) | Selection::Element(id, _)) = selection else { return Some(()) };
    if !matches!(cx.instances[*id].kind, InstanceKind::Variable { .. }) {
        return Some(());
    }
    let mut at = Some(*id).filter(|id| *id != scope.instance);
    while let Some(id) = at {
        if is_connector(cx, id) {
            return Some(());
        }
        at = cx.instances[id].parent;
    }
    let path = cx.path(*id);
    cx.report(ConnectCause::NotAConnector { path }, span);
    None
}

/// The state of a state machine that holds a variable.
fn state_around<'f>(flat: &'f FlatModel, variable: &str) -> Option<&'f str> {
    let of_transitions = flat.transitions.iter().flat_map(|t| [&t.from, &t.to]);
    let mut all = of_transitions.chain(flat.initial_states.iter().map(|(state, _)| state));
    let holds = |state: &str| variable.strip_prefix(state).is_some_and(|r| r.starts_with('.'));
    all.find(|state| holds(state)).map(|state| &**state)
}

/// Checks that a connection set has at most one source of its signal.
pub(super) fn check_single_source(
    cx: &mut Evaluator<'_>,
    flat: &FlatModel,
    members: &[SetMember],
    span: Span,
) {
    let mut sources = members.iter().filter(|(v, outside)| is_source(cx, *v, *outside));
    let (Some((a, _)), Some((b, _))) = (sources.next(), sources.next()) else { return };
    let expandable =
        members.iter().any(|(v, _)| expandable::is_within(cx, cx.instance_of[v.0 as usize].0));
    let (first, second) = (&flat.variables[*a], &flat.variables[*b]);
    // Of several states, the active one gives the value (section 17.3.6).
    let states = [first, second].map(|v| state_around(flat, &v.name));
    let alternate = states[0].is_some() && states[1].is_some() && states[0] != states[1];
    if a == b || expandable || alternate {
        return;
    }
    let (a, b) = (first, second);
    let cause = ConnectCause::TwoSources { first: a.name.to_string(), second: b.name.to_string() };
    cx.problems.push(
        Diagnostic::new(cause, span)
            .also(a.span, format!("`{}`", a.name))
            .also(b.span, format!("`{}`", b.name))
            .note("outputs of components and inputs of the model itself give values"),
    );
}

/// `connect(a.b.c, ...)`: everything but the first name must be a connector (section 9.1).
pub(super) fn is_within_reach(cx: &mut Evaluator<'_>, r: &ComponentRef, scope: Scope) -> bool {
    let Some(mut at) = cx.child(scope.instance, r.parts[0].name.name) else { return true };
    for (k, part) in r.parts.iter().enumerate().skip(1) {
        while let InstanceKind::Array { elements, .. } = &cx.instances[at].kind {
            let Some(first) = elements.first() else { return true };
            at = *first;
        }
        cx.complete(at);
        let Some(class) = cx.instances[at].class else { return true };
        let connector =
            matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector);
        if k > 1 && matches!(cx.kind(class), ClassKind::Model | ClassKind::Block) && !connector {
            let cause = ConnectCause::ConnectedTooDeep { name: part.name.name };
            cx.problems.push(
                Diagnostic::new(cause, r.span).note(
                    "a connection names a connector of the class or of one of its components",
                ),
            );
            return false;
        }
        match cx.child(at, part.name.name) {
            Some(child) => at = child,
            None => return true,
        }
    }
    true
}
