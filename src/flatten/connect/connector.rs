//! What connector classes and connection sets must fulfil: as many flows as potentials, and one source
//! of each signal (sections 9.3 and 9.3.1 of the specification).

use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::instantiate::Context;
use crate::ir::ast::{Causality, ClassKind, ConnectionPrefix, TypePrefix};
use crate::ir::expr::VarId;
use crate::ir::instance::{ClassId, InstanceId, InstanceKind};

/// Numbers of scalars of a connector.
#[derive(Default)]
struct Count {
    potentials: usize,
    flows: usize,
    streams: usize,
    /// Part of an over-constrained graph: its sizes say nothing.
    overdetermined: bool,
}

/// Checks the classes of all connectors among `components`, each class once.
pub(crate) fn check(cx: &mut Context<'_>, root: InstanceId) {
    if cx.problems.has_errors() {
        // What is missing may have been refused for another reason.
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
            let text = cx.text(class).cloned();
            if seen.insert(class) && text.is_some_and(|t| !t.partial) {
                let mut count = Count::default();
                tally(cx, id, &mut count);
                report(cx, id, class, &count);
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

/// What a block has to do with its surroundings are inputs and outputs (section 4.7).
fn check_block(cx: &mut Context<'_>, block: InstanceId) {
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

fn report_undirected(cx: &mut Context<'_>, connector: InstanceId, variable: InstanceId) {
    let message = format!("`{}` of a block is neither input nor output", cx.path(variable));
    cx.problems.push(
        Diagnostic::error("MO0249", cx.declared_at(connector), message)
            .also(cx.declared_at(variable), "declared here")
            .help("use connectors of inputs and outputs, or declare the class as a model")
            .note("section 4.7 of the specification"),
    );
}

/// What is conserved must be summed: a flow that is an operator record needs the operators for that
/// (section 9.2).
fn check_conserved(cx: &mut Context<'_>, id: InstanceId) {
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
    let message = format!(
        "`{}` is a flow, and `{}` has no operator {operator}",
        cx.path(id),
        cx.classes[class].full_name
    );
    cx.problems.push(
        Diagnostic::error("MO0250", cx.declared_at(id), message)
            .help("sums at connections need the operators '0', '+' and '-' of one argument")
            .note("section 9.2 of the specification"),
    );
}

fn tally(cx: &mut Context<'_>, id: InstanceId, count: &mut Count) {
    let equality = crate::base::name::name("equalityConstraint");
    count.overdetermined |= cx.table_of(id).index.contains_key(&equality);
    match cx.instances[id].kind.clone() {
        InstanceKind::Variable { dims, .. } => {
            let n: usize = dims.iter().product();
            match cx.instances[id].prefix {
                TypePrefix { variability: Some(v), .. }
                    if v < crate::ir::ast::Variability::Discrete => {}
                TypePrefix { connection: Some(ConnectionPrefix::Stream), .. } => count.streams += n,
                TypePrefix { connection: Some(ConnectionPrefix::Flow), .. } => count.flows += n,
                TypePrefix { causality: Some(_), .. } => {}
                _ => count.potentials += n,
            }
        }
        InstanceKind::Object(children) => {
            check_conserved(cx, id);
            // A connector inside is counted by itself, but for its prefixes.
            children.iter().for_each(|c| tally(cx, *c, count));
        }
        InstanceKind::Array { elements, .. } => {
            elements.iter().for_each(|c| tally(cx, *c, count));
        }
        _ => {}
    }
}

fn report(cx: &mut Context<'_>, id: InstanceId, class: ClassId, count: &Count) {
    let Count { potentials, flows, streams, overdetermined } = *count;
    let full_name = cx.classes[class].full_name;
    let name = full_name.rsplit('.').next().unwrap_or_default();
    let declared = cx.text(class).map_or(crate::base::source::Span::NONE, |t| t.name.span);
    if streams > 0 && flows != 1 {
        let message = format!(
            "connector `{name}` has {} and {}",
            counted(streams, "`stream` variable"),
            counted(flows, "flow")
        );
        cx.problems.push(
            Diagnostic::error("MO0245", declared, message)
                .also(cx.declared_at(id), "of this class")
                .help("give it one scalar `flow` variable, which carries what the streams say")
                .note("section 15.1 of the specification"),
        );
        return;
    }
    if potentials == flows || overdetermined {
        return;
    }
    let message = format!(
        "connector `{name}` has {} and {}",
        counted(potentials, "potential"),
        counted(flows, "flow")
    );
    let help = match (potentials, flows) {
        (_, 0) => {
            "declare one `flow` variable for each potential, or make them `input` or `output`"
        }
        _ => "give each potential one `flow` variable, and each `flow` variable a potential",
    };
    cx.problems.push(
        Diagnostic::error("MO0245", declared, message)
            .also(cx.declared_at(id), "of this class")
            .help(help)
            .note("section 9.3.1 of the specification"),
    );
}

fn counted(n: usize, what: &str) -> String {
    match n {
        0 => format!("no {what}"),
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
}

/// Whether a variable of a connection set gives the others their value: an output of a component inside,
/// or a public input of the component itself.
pub(crate) fn is_source(cx: &Context<'_>, v: VarId, outside: bool) -> bool {
    let (id, _) = cx.evaluation.instance_of[v.0 as usize];
    match cx.instances[id].prefix.causality {
        Some(Causality::Output) => !outside,
        Some(Causality::Input) => outside && !cx.instances[id].protected,
        None => false,
    }
}
