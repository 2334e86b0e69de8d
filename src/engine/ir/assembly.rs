//! The composition of a model for diagrams: nested components, their connectors and connections.
//!
//! *Holds:* every component with components, depth first in order of declaration, the model itself
//! first; every `connect` between two connectors, and every input that reads another component.
//! *Never holds:* scalar variables, equations, components that a condition leaves out.
//! *Made by:* `flatten::assembly`. *Read by:* `report`.

use crate::base::source::Span;

/// A model and its parts.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Assembly {
    /// The model, then its components, each after the one that holds it.
    pub parts: Vec<AssemblyPart>,
    /// In order of declaration, level by level.
    pub links: Vec<Link>,
}

/// A component.
#[derive(Clone, PartialEq, Debug)]
pub struct AssemblyPart {
    /// Full dotted name, as in results; empty for the model itself.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// The description of its declaration; may be empty.
    pub description: String,
    /// The description of its class; may be empty.
    pub meaning: String,
    /// Where it is declared.
    pub place: Span,
    /// The component that holds it, by position; none for the model itself.
    pub parent: Option<usize>,
    /// Its connectors in order of declaration.
    pub ports: Vec<Port>,
    /// `annotation(Placement(...))`: the corners of its icon, left, bottom, right and top, in the
    /// coordinates of the class that holds it.
    pub placement: Option<[f64; 4]>,
}

/// A connector of a component.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Port {
    /// Its name in the component.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// The quantity that flows through it.
    pub domain: Domain,
}

/// The quantity that flows through a connector, by the unit of its flow variable.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Domain {
    /// A force or a torque.
    Mechanical,
    /// A mass flow or a volume flow.
    Fluid,
    /// A current.
    Electrical,
    /// A flow of heat.
    Thermal,
    /// Nothing flows.
    Signal,
    /// A flow of another unit.
    Other,
}

impl Domain {
    /// All of them.
    pub const ALL: [Domain; 6] = [
        Domain::Mechanical,
        Domain::Fluid,
        Domain::Electrical,
        Domain::Thermal,
        Domain::Signal,
        Domain::Other,
    ];

    /// By the units of the flow variables of a connector.
    pub fn of_flows<'a>(units: impl IntoIterator<Item = &'a str>) -> Domain {
        let mut domain = Domain::Signal;
        for unit in units {
            domain = match unit {
                "N" | "N.m" | "Nm" => Domain::Mechanical,
                "kg/s" | "m3/s" => Domain::Fluid,
                "A" => Domain::Electrical,
                "W" => Domain::Thermal,
                _ => Domain::Other,
            };
            if domain != Domain::Other {
                break;
            }
        }
        domain
    }

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Domain::Mechanical => "mechanical",
            Domain::Fluid => "fluid",
            Domain::Electrical => "electrical",
            Domain::Thermal => "thermal",
            Domain::Signal => "signal",
            Domain::Other => "other",
        }
    }
}

/// Two connected connectors, or an input and its source.
#[derive(Clone, PartialEq, Debug)]
pub struct Link {
    /// The component in whose class it is written.
    pub holder: usize,
    /// The connectors; the source of an input comes first.
    pub ends: [LinkEnd; 2],
    /// The quantity that flows through it.
    pub domain: Domain,
    /// Written as `connect`; otherwise an input with a value.
    pub connect: bool,
    /// Where it is written.
    pub place: Span,
}

/// One end of a link.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LinkEnd {
    /// The component: the holder itself, or one that it holds directly.
    pub part: usize,
    /// Name of the connector or variable in that component.
    pub port: String,
}

impl Assembly {
    /// The components that a component holds directly.
    pub fn children(&self, part: usize) -> Vec<usize> {
        (0..self.parts.len()).filter(|&k| self.parts[k].parent == Some(part)).collect()
    }

    /// Of each component whether it holds others.
    pub fn holders(&self) -> Vec<bool> {
        let mut holds = vec![false; self.parts.len()];
        for parent in self.parts.iter().filter_map(|p| p.parent) {
            holds[parent] = true;
        }
        holds
    }

    /// The last part of a component's name, with its subscripts.
    pub fn short(&self, part: usize) -> &str {
        let full = self.parts[part].name.as_str();
        match self.parts[part].parent.map(|p| self.parts[p].name.as_str()) {
            None | Some("") => full,
            Some(around) => full.strip_prefix(around).map_or(full, |s| s.trim_start_matches('.')),
        }
    }

    /// Whether a component lies in another, at any depth, or is it.
    pub fn within(&self, mut part: usize, around: usize) -> bool {
        loop {
            if part == around {
                return true;
            }
            match self.parts[part].parent {
                Some(p) => part = p,
                None => return false,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_says_the_domain() {
        assert_eq!(Domain::of_flows(["N"]), Domain::Mechanical);
        assert_eq!(Domain::of_flows(["kg/s"]), Domain::Fluid);
        assert_eq!(Domain::of_flows(["mol/s", "W"]), Domain::Thermal);
        assert_eq!(Domain::of_flows(["mol/s"]), Domain::Other);
        assert_eq!(Domain::of_flows([]), Domain::Signal);
    }
}
