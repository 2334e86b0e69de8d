//! Inventory of a model: its components, their connectors, and the nodes that connections form.
//!
//! For tools that attach components to a model: two connectors of the same class at the same node
//! are equivalent places to attach to. Connectors of different classes can be compared by the names and units of
//! their variables.

use crate::evaluate::Evaluator;
use crate::ir::ast::{Causality, ClassKind, ConnectionPrefix, Variability};
use crate::ir::expr::Type;
use crate::ir::flat::FlatModel;
use crate::ir::instance::{InstanceId, InstanceKind};

use super::connect::Connections;

/// The components of a model and its free inputs.
#[derive(Clone, Debug, Default)]
pub struct Inventory {
    /// Components in order of declaration; the first is the model itself, with an empty name.
    pub parts: Vec<InventoryPart>,
    /// Inputs of the model itself without a value.
    pub inputs: Vec<String>,
}

/// A component of a model.
#[derive(Clone, Debug)]
pub struct InventoryPart {
    /// Its name.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// Its connectors.
    pub connectors: Vec<InventoryConnector>,
}

/// A connector of a component.
#[derive(Clone, Debug)]
pub struct InventoryConnector {
    /// Its name within the component.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// The node that it belongs to: connectors are connected if their nodes are equal.
    pub node: usize,
    /// Its potential and its flow, if it consists of one of each.
    pub pair: Option<PotentialFlow>,
    /// It has stream variables.
    pub has_streams: bool,
}

/// The variables of a connector that consists of one potential and one flow, both real numbers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PotentialFlow {
    /// The variable that is equal in connected connectors.
    pub potential: ConnectorVariable,
    /// The variable whose sum over connected connectors is zero.
    pub flow: ConnectorVariable,
}

/// A variable of a connector.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ConnectorVariable {
    /// Its name.
    pub name: String,
    /// Its unit; empty where not declared.
    pub unit: String,
}

/// Takes the inventory of the model at `root`, whose connections have been collected.
pub(super) fn of(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    connections: &mut Connections,
    flat: &FlatModel,
) -> Inventory {
    let mut inventory = Inventory::default();
    let InstanceKind::Object(children) = cx.instances[root].kind.clone() else { return inventory };
    let mut parts = vec![(root, String::new(), children.clone())];
    for &child in children.iter() {
        cx.complete(child);
        let name = cx.instances[child].name.to_string();
        let instance = &cx.instances[child];
        if instance.prefix.causality == Some(Causality::Input) && cx.binding(child).is_none() {
            inventory.inputs.push(name.clone());
        }
        for (element, name) in elements(cx, child, name) {
            if let InstanceKind::Object(inner) = cx.instances[element].kind.clone() {
                parts.push((element, name, inner));
            }
        }
    }
    let mut free = usize::MAX;
    for (id, name, inner) in parts {
        let mut connectors = Vec::new();
        for &end in inner.iter() {
            let Some(class) = connector_class(cx, end) else { continue };
            let node = first_variable(cx, end).and_then(|v| connections.node(v));
            // An unconnected connector has a node of its own.
            let node = node.unwrap_or_else(|| {
                free -= 1;
                free
            });
            let name = cx.instances[end].name.to_string();
            let pair = pair(cx, end, flat);
            let has_streams = has_streams(cx, end);
            connectors.push(InventoryConnector { name, class, node, pair, has_streams });
        }
        let class = cx.instances[id].class;
        let class = class.map_or_else(String::new, |c| cx.classes[c].full_name.to_string());
        if name.is_empty() || connector_class(cx, id).is_none() {
            inventory.parts.push(InventoryPart { name, class, connectors });
        }
    }
    inventory
}

/// A component, or the elements of an array of components, with their names.
fn elements(cx: &mut Evaluator<'_>, id: InstanceId, name: String) -> Vec<(InstanceId, String)> {
    let InstanceKind::Array { dims, elements } = cx.instances[id].kind.clone() else {
        return vec![(id, name)];
    };
    let subscripts = |mut k: usize| {
        let mut all: Vec<String> = Vec::new();
        for size in dims.iter().rev() {
            all.push((k % size + 1).to_string());
            k /= size;
        }
        all.reverse();
        all.join(",")
    };
    let mut named = Vec::new();
    for (k, element) in elements.iter().enumerate() {
        cx.complete(*element);
        named.push((*element, format!("{name}[{}]", subscripts(k))));
    }
    named
}

/// Whether a connector has stream variables.
fn has_streams(cx: &Evaluator<'_>, connector: InstanceId) -> bool {
    let InstanceKind::Object(children) = &cx.instances[connector].kind else { return false };
    let prefix = |child: &InstanceId| cx.instances[*child].prefix.connection;
    children.iter().any(|child| prefix(child) == Some(ConnectionPrefix::Stream))
}

/// The potential and the flow of a connector that has nothing else.
fn pair(cx: &Evaluator<'_>, connector: InstanceId, flat: &FlatModel) -> Option<PotentialFlow> {
    let InstanceKind::Object(children) = &cx.instances[connector].kind else { return None };
    let (mut potentials, mut flows) = (Vec::new(), Vec::new());
    for &child in children.iter() {
        let instance = &cx.instances[child];
        if instance.prefix.variability.is_some_and(|v| v < Variability::Discrete) {
            continue;
        }
        let InstanceKind::Variable { ty: Type::Real, dims, first } = &instance.kind else {
            return None;
        };
        if !dims.is_empty() || instance.prefix.causality.is_some() {
            return None;
        }
        let unit = first.map_or(String::new(), |v| flat.variables[v].unit.to_string());
        let variable = ConnectorVariable { name: instance.name.to_string(), unit };
        match instance.prefix.connection {
            None => potentials.push(variable),
            Some(ConnectionPrefix::Flow) => flows.push(variable),
            Some(ConnectionPrefix::Stream) => return None,
        }
    }
    let (potential, flow) = (potentials.pop()?, flows.pop()?);
    (potentials.is_empty() && flows.is_empty()).then_some(PotentialFlow { potential, flow })
}

fn connector_class(cx: &mut Evaluator<'_>, id: InstanceId) -> Option<String> {
    cx.complete(id);
    if !matches!(cx.instances[id].kind, InstanceKind::Object(_)) {
        return None;
    }
    let class = cx.instances[id].class?;
    let is = matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector);
    is.then(|| cx.classes[class].full_name.to_string())
}

fn first_variable(cx: &Evaluator<'_>, connector: InstanceId) -> Option<crate::ir::expr::VarId> {
    let InstanceKind::Object(children) = &cx.instances[connector].kind else { return None };
    children.iter().find_map(|c| match cx.instances[*c].kind {
        InstanceKind::Variable { first, .. } => first,
        _ => None,
    })
}
