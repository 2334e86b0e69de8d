//! `terminalsAndIcons.xml` of FMI 3: the connectors of a model as terminals, and where its icon lies.

use super::description::xml::Xml;
use super::interface::Scalar;

/// A connector of the model itself.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Connector {
    /// Its name.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// Its variables: their full names, and whether they are flows into the model.
    pub variables: Vec<(String, bool)>,
}

/// The corners of the icon, as in Modelica.
const CORNERS: [(&str, &str); 4] = [("x1", "-100"), ("y1", "-100"), ("x2", "100"), ("y2", "100")];
/// Millimetres per unit of length of icons in Modelica.
const SCALE: (&str, &str) = ("suggestedScalingFactorTo_mm", "0.1");

/// The text of the file. Variables that the FMU does not list are left out, and so are connectors without any.
pub fn text(connectors: &[Connector], scalars: &[Scalar]) -> String {
    let is_listed = |name: &str| {
        scalars.iter().any(|s| s.name == name || s.aliases.iter().any(|a| a.name == name))
    };
    let mut x = Xml::default();
    x.out.push_str("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    x.open("fmiTerminalsAndIcons", &[("fmiVersion", "3.0")]);
    x.open("GraphicalRepresentation", &[]);
    x.empty("CoordinateSystem", &[&CORNERS[..], &[SCALE]].concat());
    x.empty("Icon", &CORNERS);
    x.close("GraphicalRepresentation");
    let members = |c: &Connector| -> Vec<(String, bool)> {
        c.variables.iter().filter(|(name, _)| is_listed(name)).cloned().collect()
    };
    let all = connectors.iter().map(|c| (c, members(c))).filter(|(_, m)| !m.is_empty());
    x.list("Terminals", all.collect(), |x, (connector, members)| {
        let Connector { name, class, .. } = connector;
        x.open("Terminal", &[("name", name), ("matchingRule", "plug"), ("terminalKind", class)]);
        for (variable, is_flow) in members {
            let own = variable.strip_prefix(name.as_str()).unwrap_or(&variable);
            let own = own.strip_prefix('.').unwrap_or(own).to_owned();
            let kind = if is_flow { "inflow" } else { "signal" };
            let list =
                [("variableName", &*variable), ("memberName", &*own), ("variableKind", kind)];
            x.empty("TerminalMemberVariable", &list);
        }
        x.close("Terminal");
    });
    x.close("fmiTerminalsAndIcons");
    x.out
}
