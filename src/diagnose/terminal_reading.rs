//! Sensors of flows through a component, read at its terminals.
//!
//! Some laws say that a component itself is another one: brushes that lose a voltage, a coupling with play, iron that
//! saturates. They are attached in parallel, so that they vanish with their amplitude, while the sensor of the component's
//! current or torque reads what flows through both. In a model with such laws, the sensor reads a variable of its own: the
//! flow of the component and those of the laws at its terminals.

use crate::calibrate::plan::Plan;
use crate::flatten::inventory::Inventory;
use crate::ir::expr::{ExprId, Node, Unary, VarId};
use crate::ir::flat::{EquationKind, FlatModel};

use super::model_source::Attached;
use super::place::Place;

/// A sensor of the flow through a component.
#[derive(Clone, PartialEq, Debug)]
pub struct TerminalReading {
    /// The signal, by its position in the plan.
    pub signal: usize,
    /// The variable that the plan compares.
    pub variable: String,
    /// The variable that the sensor reads in a model with effects.
    pub name: String,
    /// Its unit.
    unit: String,
    /// The connector whose flow the variable is, as `COMPONENT.CONNECTOR`.
    end: String,
    /// The variable is the flow into the component, or out of it.
    is_into: bool,
}

/// The sensors of a plan that read the flow at a connector of a component.
pub fn terminal_readings(
    flat: &FlatModel,
    plan: &Plan,
    inventory: &Inventory,
) -> Vec<TerminalReading> {
    let mut out: Vec<TerminalReading> = Vec::new();
    for (signal, s) in plan.signals.iter().enumerate() {
        let Some((v, x)) = flat.variables.enumerate().find(|(_, x)| x.name == s.variable) else {
            continue;
        };
        let Some((end, is_into)) = end_of_flow(flat, inventory, v) else { continue };
        let plain: String =
            s.column.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        let mut name = format!("reading_of_{plain}");
        let is_taken = |name: &String| {
            flat.variables.iter().any(|x| x.name == *name) || out.iter().any(|r| r.name == *name)
        };
        while is_taken(&name) {
            name.push('_');
        }
        let (variable, unit) = (s.variable.clone(), x.unit.to_string());
        out.push(TerminalReading { signal, variable, name, unit, end, is_into });
    }
    out
}

/// The connector whose flow a variable equals, but for its sign.
fn end_of_flow(flat: &FlatModel, inventory: &Inventory, v: VarId) -> Option<(String, bool)> {
    let end_of = |v: VarId| {
        let name = flat.variables[v].name.as_str();
        inventory.parts.iter().filter(|p| !p.name.is_empty()).find_map(|part| {
            let inner = name.strip_prefix(part.name.as_str())?.strip_prefix('.')?;
            let own = part.connectors.iter().find(|c| {
                let flow = c.pair.as_ref().map(|pair| pair.flow.name.as_str());
                inner.strip_prefix(c.name.as_str()).and_then(|rest| rest.strip_prefix('.')) == flow
            })?;
            own.pair.as_ref()?;
            Some(format!("{}.{}", part.name, own.name))
        })
    };
    if let Some(end) = end_of(v) {
        return Some((end, true));
    }
    let signed = |e: ExprId| match flat.graph.node(e) {
        Node::Var(v) => Some((v, true)),
        Node::Unary(Unary::Neg, inner) => match flat.graph.node(inner) {
            Node::Var(v) => Some((v, false)),
            _ => None,
        },
        _ => None,
    };
    let of_equations = flat.equations.iter().filter_map(|e| match e.kind {
        EquationKind::Equal(a, b) => Some((signed(a)?, signed(b)?)),
        _ => None,
    });
    let of_bindings =
        flat.variables.enumerate().filter_map(|(v, x)| Some(((v, true), signed(x.binding?)?)));
    let mut others = of_equations.chain(of_bindings).filter_map(|(a, b)| match () {
        () if a.0 == v && b.0 != v => Some((b.0, a.1 == b.1)),
        () if b.0 == v && a.0 != v => Some((a.0, a.1 == b.1)),
        () => None,
    });
    others.find_map(|(other, has_same_sign)| Some((end_of(other)?, has_same_sign)))
}

impl TerminalReading {
    /// The flows of effects that the sensor reads besides, as the terms of a sum.
    fn terms(&self, attached: &[Attached<'_>]) -> String {
        let of = |a: &Attached<'_>| {
            let (own, _) = a.place.connections.iter().find(|(_, other)| *other == self.end)?;
            let connector = a.effect.connectors.iter().find(|c| c.name == *own)?;
            let flow = &connector.pair.as_ref()?.flow.name;
            let sign = if self.is_into { '+' } else { '-' };
            Some(format!(" {sign} {}.{own}.{flow}", a.name))
        };
        attached.iter().filter(|a| a.effect.in_series).filter_map(of).collect()
    }

    /// The declaration of what the sensor reads.
    pub fn declaration(&self, attached: &[Attached<'_>]) -> String {
        let unit = match self.unit.is_empty() {
            true => String::new(),
            false => format!("(unit = \"{}\")", self.unit),
        };
        let (name, variable, terms) = (&self.name, &self.variable, self.terms(attached));
        format!("  Real {name}{unit} = {variable}{terms} \"Flow at {}\";\n", self.end)
    }

    /// True if an effect at a place changes what the sensor reads.
    pub fn is_changed_by(&self, place: &Place) -> bool {
        place.members().iter().any(|p| p.connections.iter().any(|(_, other)| *other == self.end))
    }
}
