//! Effects at connectors of other classes than their own: which connectors mean the same, and the adapter between
//! two of them.
//!
//! *In:* connectors of the inventory. *Out:* whether an effect can be attached, and the source of the adapter.
//!
//! Two connectors mean the same if each consists of one potential and one flow of the same quantities. Their units
//! tell, or if one of them has none, equal names. A flow is positive into the component that owns the connector, as
//! everywhere in Modelica, so the two sides of an adapter have opposite flows. Both are connectors of a component of
//! its own, and none is a connector of the model, so no rule of outside connectors applies (Modelica Language
//! Specification 3.6, section 9.2).

use crate::flatten::inventory::{ConnectorVariable, InventoryConnector, PotentialFlow};

/// An adapter between a connector of a model and the class of connectors that an effect has.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Adapter {
    /// The connector of the model, as `COMPONENT.CONNECTOR`.
    pub end: String,
    /// Class and variables of the effect's connector.
    pub effect: (String, PotentialFlow),
    /// Class and variables of the model's connector.
    pub model: (String, PotentialFlow),
}

/// The adapters of a model: each connector has one for all effects attached to it.
#[derive(Clone, Default, Debug)]
pub struct Adapters {
    classes: Vec<(Adapter, String)>,
    components: Vec<(Adapter, String)>,
}

/// The connector of effects for connections of which no domain of the library knows.
const ANY: &str = "Effects.AnyPort";

/// The domains of the library whose effects are attached by what their connectors mean: potential and flow, each with
/// its name and unit.
const DOMAINS: [[(&str, &str); 2]; 5] = [
    [("p", "Pa"), ("m_flow", "kg/s")],
    [("s", "m"), ("f", "N")],
    [("phi", "rad"), ("tau", "N.m")],
    [("v", "V"), ("i", "A")],
    [("T", "K"), ("Q_flow", "W")],
];

/// Whether a connector of an effect can be attached to a connector of a model, perhaps by an adapter.
pub fn is_compatible(effect: &InventoryConnector, model: &InventoryConnector) -> bool {
    if effect.class == ANY {
        return model.pair.as_ref().is_some_and(|pair| !has_domain(pair));
    }
    let of_pairs = |a: &PotentialFlow, b: &PotentialFlow| {
        is_same_quantity(&a.potential, &b.potential) && is_same_quantity(&a.flow, &b.flow)
    };
    effect.class == model.class
        || effect.pair.as_ref().zip(model.pair.as_ref()).is_some_and(|(a, b)| of_pairs(a, b))
}

/// The adapter that an effect needs at a connector, unless both are of one class.
pub fn adapter(
    effect: &InventoryConnector,
    model: &InventoryConnector,
    end: String,
) -> Option<Adapter> {
    if effect.class == model.class {
        return None;
    }
    let of = |c: &InventoryConnector| Some((c.class.clone(), c.pair.clone()?));
    Some(Adapter { end, effect: of(effect)?, model: of(model)? })
}

/// Whether two connectors can be the ends of one effect.
pub fn is_alike(
    effect: &InventoryConnector,
    a: &InventoryConnector,
    b: &InventoryConnector,
) -> bool {
    effect.class != ANY || a.class == b.class
}

fn has_domain(pair: &PotentialFlow) -> bool {
    let is = |(name, unit): (&str, &str), own: &ConnectorVariable| {
        is_same_quantity(&ConnectorVariable { name: name.to_owned(), unit: unit.to_owned() }, own)
    };
    DOMAINS.iter().any(|[potential, flow]| is(*potential, &pair.potential) && is(*flow, &pair.flow))
}

fn is_same_quantity(a: &ConnectorVariable, b: &ConnectorVariable) -> bool {
    let unit = |v: &ConnectorVariable| v.unit.replace('*', ".");
    match a.unit.is_empty() || b.unit.is_empty() {
        true => a.name == b.name,
        false => unit(a) == unit(b),
    }
}

impl Adapters {
    /// The connector to connect an effect with in place of the adapter's end.
    pub fn attach(&mut self, adapter: &Adapter) -> String {
        let same = |a: &Adapter| (&a.effect, &a.model) == (&adapter.effect, &adapter.model);
        if !self.classes.iter().any(|(known, _)| same(known)) {
            let base = format!("{}For{}", short(&adapter.effect.0), short(&adapter.model.0));
            let name = unused(base, self.classes.iter().map(|(_, name)| name));
            self.classes.push((adapter.clone(), name));
        }
        let known = self.components.iter().find(|(a, _)| a.end == adapter.end && same(a));
        let component = match known {
            Some((_, name)) => name.clone(),
            None => {
                let plain: String = adapter
                    .end
                    .chars()
                    .map(|c| if c.is_alphanumeric() { c } else { '_' })
                    .collect();
                let name =
                    unused(format!("at_{plain}"), self.components.iter().map(|(_, name)| name));
                self.components.push((adapter.clone(), name.clone()));
                name
            }
        };
        format!("{component}.of_effect")
    }

    /// Writes the adapters and their classes in a model that extends `base`.
    pub fn declare(&self, base: &str, out: &mut String) {
        for (adapter, name) in &self.components {
            let same = |a: &Adapter| (&a.effect, &a.model) == (&adapter.effect, &adapter.model);
            let Some((_, class)) = self.classes.iter().find(|(a, _)| same(a)) else { continue };
            out.push_str(&format!("  {class} {name};\n"));
        }
        for (Adapter { effect, model, .. }, name) in &self.classes {
            let inherited = model.0.strip_prefix(base).and_then(|rest| rest.strip_prefix('.'));
            let class = inherited.unwrap_or(&model.0);
            let (own, other) = (&effect.1, &model.1);
            out.push_str(&format!(
                "  model {name} \"Attaches effects with a {} to a {class}\"\n    \
                   {} of_effect;\n    \
                   {class} of_model;\n  \
                 equation\n    \
                   of_effect.{} = of_model.{};\n    \
                   of_effect.{} + of_model.{} = 0;\n  \
                 end {name};\n",
                effect.0,
                effect.0,
                own.potential.name,
                other.potential.name,
                own.flow.name,
                other.flow.name
            ));
        }
    }

    /// Writes the connections between the adapters and the model.
    pub fn connect(&self, out: &mut String) {
        for (adapter, name) in &self.components {
            out.push_str(&format!("  connect({name}.of_model, {});\n", adapter.end));
        }
    }
}

fn short(class: &str) -> &str {
    class.rsplit('.').next().unwrap_or(class)
}

/// The name, with a number if it is taken.
fn unused<'a>(name: String, taken: impl Iterator<Item = &'a String>) -> String {
    let taken: Vec<&String> = taken.collect();
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut all = std::iter::once(name.clone()).chain(numbered);
    all.find(|n| !taken.contains(&n)).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connector(class: &str, potential: (&str, &str), flow: (&str, &str)) -> InventoryConnector {
        let variable = |(name, unit): (&str, &str)| ConnectorVariable {
            name: name.to_owned(),
            unit: unit.to_owned(),
        };
        let pair = PotentialFlow { potential: variable(potential), flow: variable(flow) };
        let (name, class) = ("c".to_owned(), class.to_owned());
        InventoryConnector { name, class, node: 0, pair: Some(pair), has_streams: false }
    }

    #[test]
    fn units_tell_and_names_where_there_are_none() {
        let flange = connector("Rotational.Flange", ("phi", "rad"), ("tau", "N.m"));
        let fits = |potential, flow| is_compatible(&flange, &connector("Shaft", potential, flow));
        assert!(fits(("phi", "rad"), ("tau", "N*m")));
        assert!(fits(("angle", "rad"), ("torque", "N.m")));
        assert!(fits(("phi", ""), ("tau", "")));
        assert!(fits(("phi", "rad"), ("tau", "")));
        assert!(!fits(("angle", ""), ("tau", "N.m")));
        assert!(!fits(("phi", "deg"), ("tau", "N.m")));
        assert!(!fits(("s", "m"), ("f", "N")));
        let none = InventoryConnector { pair: None, ..flange.clone() };
        assert!(is_compatible(&flange, &none), "the same class");
        let other = InventoryConnector { class: "Other".to_owned(), ..none };
        assert!(!is_compatible(&flange, &other));
    }

    #[test]
    fn connections_of_other_domains_have_effects_of_any_kind() {
        let any = connector(ANY, ("e", ""), ("f", ""));
        let fits = |potential, flow| is_compatible(&any, &connector("Port", potential, flow));
        assert!(fits(("h", "m"), ("q", "m3/s")));
        assert!(fits(("p", "Pa"), ("q", "m3/s")));
        assert!(fits(("c", ""), ("r", "")));
        assert!(!fits(("T", "K"), ("Q", "W")));
        assert!(!fits(("v", ""), ("i", "")));
    }

    #[test]
    fn a_connector_has_one_adapter_for_all_effects() {
        let flange = connector("Rotational.Flange", ("phi", "rad"), ("tau", "N.m"));
        let shaft = connector("Motor.Shaft", ("angle", "rad"), ("torque", "N.m"));
        assert_eq!(adapter(&flange, &flange, "rotor.flange".to_owned()), None);
        let mut adapters = Adapters::default();
        for end in ["rotor.shaft", "load[1].shaft", "rotor.shaft"] {
            adapters.attach(&adapter(&flange, &shaft, end.to_owned()).unwrap());
        }
        let mut text = String::new();
        adapters.declare("Motor", &mut text);
        adapters.connect(&mut text);
        insta::assert_snapshot!(text, @r#"
          FlangeForShaft at_rotor_shaft;
          FlangeForShaft at_load_1__shaft;
          model FlangeForShaft "Attaches effects with a Rotational.Flange to a Shaft"
            Rotational.Flange of_effect;
            Shaft of_model;
          equation
            of_effect.phi = of_model.angle;
            of_effect.tau + of_model.torque = 0;
          end FlangeForShaft;
          connect(at_rotor_shaft.of_model, rotor.shaft);
          connect(at_load_1__shaft.of_model, load[1].shaft);
        "#);
    }
}
