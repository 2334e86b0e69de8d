//! The component diagram of a model: its components with their connectors, the links of `connect`,
//! and the links from components to the inputs that read them.

use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::assembly::{Assembly, AssemblyPart, Domain, Link, LinkEnd, Port};
use crate::ir::ast::{
    ArgumentKind, Causality, ClassKind, ConnectionPrefix, Modification, Variability,
};
use crate::ir::expr::{Const, VarId};
use crate::ir::flat::FlatModel;
use crate::ir::instance::{InstanceId, InstanceKind, Scope};

use super::connect::Connections;

/// The assembly of the model at `root`, whose variables are numbered and whose connections are
/// recorded.
pub(super) fn of(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    connections: &Connections,
    flat: &FlatModel,
) -> Assembly {
    let mut found = AssemblyBuilder::default();
    for object in super::objects(cx, root) {
        if !is_connector(cx, object) {
            found.part(cx, object, flat);
        }
    }
    for recorded in connections.recorded.iter().flatten() {
        found.connect(cx, recorded.holder, recorded.ends, recorded.span);
    }
    found.inputs(cx, flat);
    found.assembly
}

#[derive(Default)]
struct AssemblyBuilder {
    assembly: Assembly,
    position: FastMap<InstanceId, usize>,
}

impl AssemblyBuilder {
    fn part(&mut self, cx: &mut Evaluator<'_>, id: InstanceId, flat: &FlatModel) {
        let InstanceKind::Object(children) = cx.instances[id].kind.clone() else { return };
        let mut ports = Vec::new();
        for &child in children.iter() {
            for element in elements(cx, child) {
                if !is_connector(cx, element) {
                    continue;
                }
                let name = within(cx, element, id);
                let class = class_of(cx, element);
                let domain = domain(cx, element, flat);
                ports.push(Port { name, class, domain });
            }
        }
        let description = cx.instances[id].declaration.as_ref().and_then(|d| {
            let own = d.component().description.clone();
            own.or_else(|| d.clause().components.last().and_then(|c| c.description.clone()))
        });
        let class = cx.instances[id].class;
        let meaning = class.and_then(|c| cx.definition(c)).and_then(|t| t.description.clone());
        let parent = self.holder(cx, id);
        let part = AssemblyPart {
            name: cx.path(id),
            class: class_of(cx, id),
            description: description.as_deref().unwrap_or_default().to_owned(),
            meaning: meaning.as_deref().unwrap_or_default().to_owned(),
            place: cx.declared_at(id),
            parent,
            ports,
            placement: placement(cx, id),
        };
        self.position.insert(id, self.assembly.parts.len());
        self.assembly.parts.push(part);
    }

    /// The nearest enclosing component of an instance.
    fn holder(&self, cx: &Evaluator<'_>, id: InstanceId) -> Option<usize> {
        let mut at = cx.instances[id].parent;
        while let Some(parent) = at {
            if let Some(&k) = self.position.get(&parent) {
                return Some(k);
            }
            at = cx.instances[parent].parent;
        }
        None
    }

    /// The end of a link at the connector or variable `id`, seen from the class of `holder`.
    fn end(&self, cx: &Evaluator<'_>, id: InstanceId, holder: usize) -> Option<LinkEnd> {
        let mut part = self.holder(cx, id)?;
        if !self.assembly.within(part, holder) {
            return None;
        }
        while part != holder && self.assembly.parts[part].parent != Some(holder) {
            part = self.assembly.parts[part].parent?;
        }
        let full = cx.path(id);
        let owner = &self.assembly.parts[part].name;
        let port = full.strip_prefix(owner.as_str()).unwrap_or(&full).trim_start_matches('.');
        Some(LinkEnd { part, port: port.to_owned() })
    }

    fn connect(
        &mut self,
        cx: &Evaluator<'_>,
        holder: InstanceId,
        ends: [InstanceId; 2],
        place: Span,
    ) -> Option<()> {
        let holder = *self.position.get(&holder)?;
        let ends = [self.end(cx, ends[0], holder)?, self.end(cx, ends[1], holder)?];
        let port = |e: &LinkEnd| {
            self.assembly.parts[e.part].ports.iter().find(|p| p.name == e.port).map(|p| p.domain)
        };
        let domain = port(&ends[0]).or_else(|| port(&ends[1])).unwrap_or(Domain::Signal);
        self.assembly.links.push(Link { holder, ends, domain, connect: true, place });
        Some(())
    }

    /// Adds links to inputs whose bindings read variables of other components.
    fn inputs(&mut self, cx: &mut Evaluator<'_>, flat: &FlatModel) {
        let mut known: FastSet<(usize, String, usize, String)> = FastSet::default();
        for (v, variable) in flat.variables.enumerate() {
            let Some(value) = variable.binding else { continue };
            let (input, _) = cx.instance_of[v.0 as usize];
            if cx.instances[input].prefix.causality != Some(Causality::Input) {
                continue;
            }
            let Some(reader) = self.holder(cx, input) else { continue };
            for read in cx.graph.variables(value) {
                if flat.variables[read].variability <= Variability::Parameter {
                    continue;
                }
                let Some(link) = self.input(cx, input, reader, read, variable.span) else {
                    continue;
                };
                let [from, to] = &link.ends;
                let pair = (from.part, from.port.clone(), to.part, to.port.clone());
                if known.insert(pair) {
                    self.assembly.links.push(link);
                }
            }
        }
    }

    fn input(
        &self,
        cx: &mut Evaluator<'_>,
        input: InstanceId,
        reader: usize,
        read: VarId,
        declared: Span,
    ) -> Option<Link> {
        let (read, _) = *cx.instance_of.get(read.0 as usize)?;
        let source = self.holder(cx, read)?;
        let mut holder = source;
        while !self.assembly.within(reader, holder) {
            holder = self.assembly.parts[holder].parent?;
        }
        // Reading a variable of the component itself or of the enclosing one is not a link between
        // components, unless the variable belongs to a connector.
        if holder == reader {
            return None;
        }
        let through = cx.instances[read].parent.filter(|p| is_connector(cx, *p));
        if source == holder && through.is_none() {
            return None;
        }
        let ends = [self.end(cx, through.unwrap_or(read), holder)?, self.end(cx, input, holder)?];
        let place = cx.binding(input).map_or(declared, |b| b.value.span);
        Some(Link { holder, ends, domain: Domain::Signal, connect: false, place })
    }
}

/// A component itself, or the elements of an array of components.
fn elements(cx: &mut Evaluator<'_>, id: InstanceId) -> Vec<InstanceId> {
    cx.complete(id);
    match &cx.instances[id].kind {
        InstanceKind::Array { elements, .. } => elements.to_vec(),
        InstanceKind::Absent | InstanceKind::Broken | InstanceKind::Outer(_) => Vec::new(),
        _ => vec![id],
    }
}

fn within(cx: &Evaluator<'_>, id: InstanceId, holder: InstanceId) -> String {
    let (full, owner) = (cx.path(id), cx.path(holder));
    full.strip_prefix(&owner).unwrap_or(&full).trim_start_matches('.').to_owned()
}

fn class_of(cx: &Evaluator<'_>, id: InstanceId) -> String {
    cx.instances[id].class.map_or_else(String::new, |c| cx.classes[c].full_name.to_string())
}

fn is_connector(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    let Some(class) = cx.instances[id].class else { return false };
    matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector)
}

/// The physical domain of a connector, by the unit of its flow.
fn domain(cx: &Evaluator<'_>, connector: InstanceId, flat: &FlatModel) -> Domain {
    let InstanceKind::Object(children) = &cx.instances[connector].kind else {
        return Domain::Signal;
    };
    let flows = children.iter().filter_map(|c| match cx.instances[*c].kind {
        InstanceKind::Variable { first: Some(first), .. }
            if cx.instances[*c].prefix.connection == Some(ConnectionPrefix::Flow) =>
        {
            Some(flat.variables.get(first)?.unit.as_str())
        }
        _ => None,
    });
    Domain::of_flows(flows)
}

/// `Placement(transformation(origin = {x, y}, extent = {{x1, y1}, {x2, y2}}))`, without rotation.
fn placement(cx: &mut Evaluator<'_>, id: InstanceId) -> Option<[f64; 4]> {
    let declaration = cx.instances[id].declaration.clone()?;
    let annotation = declaration.component().annotation.clone()?;
    let scope = cx.instances[id].scope;
    let transformation = inner(inner(&annotation, "Placement")?, "transformation")?;
    let extent = numbers(cx, transformation, "extent", scope)?;
    let origin = numbers(cx, transformation, "origin", scope).unwrap_or_else(|| vec![0.0, 0.0]);
    let ([x1, y1, x2, y2], [x, y]) = (extent[..].try_into().ok()?, origin[..].try_into().ok()?);
    let (x1, y1, x2, y2): (f64, f64, f64, f64) = (x1, y1, x2, y2);
    Some([x + x1.min(x2), y + y1.min(y2), x + x1.max(x2), y + y1.max(y2)])
}

fn inner<'a>(modification: &'a Modification, name: &str) -> Option<&'a Modification> {
    modification.args.iter().find_map(|a| match &a.kind {
        ArgumentKind::Element { path, modification: Some(m), .. } if path.to_string() == name => {
            Some(&**m)
        }
        _ => None,
    })
}

/// All numbers of an array, row by row.
fn numbers(
    cx: &mut Evaluator<'_>,
    modification: &Modification,
    name: &str,
    scope: Scope,
) -> Option<Vec<f64>> {
    let binding = inner(modification, name)?.binding.clone()?;
    let value = cx.fold(&binding, scope)?;
    let mut all = Vec::new();
    value.for_each_scalar(&mut |e| all.push(e));
    all.into_iter().map(|e| cx.graph.as_const(e).and_then(Const::number)).collect()
}
