//! Variables and structure as FMI 2 lists them: by their positions.

use crate::ir::expr::Type;

use super::units::convertible;
use super::xml::Xml;
use super::{Description, attributes, derivatives, initial_unknowns, joined, of_type, outputs};

/// Writes variables and structure.
pub(super) fn second(x: &mut Xml, d: &Description<'_>) {
    // Positions count from 1. Time is not listed: FMI 2 does not ask for it, and some importers ask it for a start
    // value.
    let mut position = 0;
    let mut positions: Vec<(u32, usize)> = Vec::new();
    for s in d.scalars {
        position += 1;
        positions.push((s.reference, position));
        position += s.aliases.len();
    }
    let positions: std::collections::BTreeMap<u32, usize> = positions.into_iter().collect();
    let at = |reference: u32| positions.get(&reference).copied().unwrap_or(0).to_string();
    x.open("ModelVariables", &[]);
    for s in d.scalars {
        let reference = s.reference.to_string();
        let element = match s.ty {
            Type::Real => "Real",
            Type::Integer => "Integer",
            Type::Boolean | Type::Clock => "Boolean",
            Type::String => "String",
            Type::Enumeration(_) => "Enumeration",
        };
        let shared = attributes(s);
        let mut typed = of_type(s, d);
        if let Some(of) = s.derivative_of {
            typed.push(("derivative", at(of)));
        }
        let description = s.description.clone();
        x.scalar(&s.name, &reference, description.as_deref(), &shared, element, &typed);
        for alias in &s.aliases {
            // Only one of the names has a start value.
            let typed: Vec<_> = of_type(s, d)
                .into_iter()
                .filter(|(name, _)| *name != "start" && *name != "displayUnit")
                .chain(
                    convertible(&s.unit, &alias.display_unit)
                        .map(|_| ("displayUnit", alias.display_unit.clone())),
                )
                .collect();
            let shared = [
                ("causality", "local".to_owned()),
                ("variability", shared[1].1.clone()),
                ("initial", "calculated".to_owned()),
            ];
            let description = alias.description.as_deref();
            x.scalar(&alias.name, &reference, description, &shared, element, &typed);
        }
    }
    x.close("ModelVariables");
    x.open("ModelStructure", &[]);
    let unknown = |x: &mut Xml, reference: u32, dependencies: &[(u32, Vec<u32>)]| {
        let index = at(reference);
        match dependencies.iter().find(|(r, _)| *r == reference) {
            Some((_, on)) => {
                let mut on: Vec<usize> =
                    on.iter().filter_map(|r| positions.get(r).copied()).collect();
                on.sort_unstable();
                let on = joined(&on);
                x.empty("Unknown", &[("index", &index), ("dependencies", &on)]);
            }
            None => x.empty("Unknown", &[("index", &index)]),
        }
    };
    x.list("Outputs", outputs(d), |x, s| unknown(x, s.reference, d.dependencies));
    x.list("Derivatives", derivatives(d), |x, s| unknown(x, s.reference, d.dependencies));
    x.list("InitialUnknowns", initial_unknowns(d.scalars), |x, s| {
        unknown(x, s.reference, d.initial_dependencies);
    });
    x.close("ModelStructure");
}
