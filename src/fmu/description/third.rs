//! Variables and structure as FMI 3 lists them: by their value references, with event indicators.

use crate::fmu::interface::{FIRST_INDICATOR, Start};
use crate::ir::expr::Type;

use super::units::convertible;
use super::xml::Xml;
use super::{Description, attributes, derivatives, initial_unknowns, joined, of_type, outputs};

/// Writes variables and structure.
pub(super) fn third(x: &mut Xml, d: &Description<'_>) {
    x.open("ModelVariables", &[]);
    x.empty(
        "Float64",
        &[
            ("name", "time"),
            ("valueReference", "0"),
            ("causality", "independent"),
            ("variability", "continuous"),
        ],
    );
    for s in d.scalars {
        let reference = s.reference.to_string();
        let element = match s.ty {
            Type::Real => "Float64",
            Type::Integer => "Int32",
            Type::Boolean | Type::Clock => "Boolean",
            Type::String => "String",
            Type::Enumeration(_) => "Enumeration",
        };
        let mut list = vec![("name", s.name.clone()), ("valueReference", reference)];
        list.extend(s.description.iter().map(|text| ("description", text.clone())));
        list.extend(attributes(s));
        let mut typed = of_type(s, d);
        let text = match (&s.start, s.ty) {
            (Some(Start::Text(text)), _) => {
                typed.retain(|(name, _)| *name != "start");
                Some(text)
            }
            _ => None,
        };
        list.extend(typed);
        list.extend(s.derivative_of.map(|of| ("derivative", of.to_string())));
        let list: Vec<(&str, &str)> = list.iter().map(|(n, v)| (*n, v.as_str())).collect();
        if s.aliases.is_empty() && text.is_none() {
            x.empty(element, &list);
            continue;
        }
        x.open(element, &list);
        if let Some(text) = text {
            x.empty("Start", &[("value", text)]);
        }
        for alias in &s.aliases {
            let mut list = vec![("name", alias.name.as_str())];
            list.extend(alias.description.as_deref().map(|text| ("description", text)));
            if convertible(&s.unit, &alias.display_unit).is_some() {
                list.push(("displayUnit", &alias.display_unit));
            }
            x.empty("Alias", &list);
        }
        x.close(element);
    }
    for k in 0..d.indicators {
        let (name, reference) = (indicator_name(d, k), (FIRST_INDICATOR + k as u32).to_string());
        x.empty(
            "Float64",
            &[
                ("name", &name),
                ("valueReference", &reference),
                ("causality", "local"),
                ("variability", "continuous"),
                ("initial", "calculated"),
            ],
        );
    }
    x.close("ModelVariables");
    x.open("ModelStructure", &[]);
    let unknown = |x: &mut Xml, element: &str, reference: u32, all: &[(u32, Vec<u32>)]| {
        let own = reference.to_string();
        match all.iter().find(|(r, _)| *r == reference) {
            Some((_, on)) => {
                let on: Vec<usize> = on.iter().map(|r| *r as usize).collect();
                let on = joined(&on);
                x.empty(element, &[("valueReference", &own), ("dependencies", &on)]);
            }
            None => x.empty(element, &[("valueReference", &own)]),
        }
    };
    for s in outputs(d) {
        unknown(x, "Output", s.reference, d.dependencies);
    }
    for s in derivatives(d) {
        unknown(x, "ContinuousStateDerivative", s.reference, d.dependencies);
    }
    for s in initial_unknowns(d.scalars) {
        unknown(x, "InitialUnknown", s.reference, d.initial_dependencies);
    }
    for k in 0..d.indicators {
        let reference = (FIRST_INDICATOR + k as u32).to_string();
        x.empty("EventIndicator", &[("valueReference", &reference)]);
    }
    x.close("ModelStructure");
}

/// A name that no variable of the model has.
fn indicator_name(d: &Description<'_>, k: usize) -> String {
    let mut base = "event_indicator".to_owned();
    while d.scalars.iter().any(|s| s.name.starts_with(&base)) {
        base.push('_');
    }
    format!("{base}[{}]", k + 1)
}
