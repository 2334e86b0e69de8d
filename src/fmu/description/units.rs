//! Units, as factors and exponents of base units.

use crate::ir::expr::Type;
use crate::units::unit::Unit;

use super::xml::Xml;
use super::{Description, number};

/// The units of all variables, with those in which they may be shown.
pub(super) fn units(x: &mut Xml, d: &Description<'_>) {
    let mut known: Vec<(&str, Vec<&str>)> = Vec::new();
    for s in d.scalars.iter().filter(|s| s.ty == Type::Real && !s.unit.is_empty()) {
        let displays = s.aliases.iter().map(|a| a.display_unit.as_str()).chain([&*s.display_unit]);
        let at = known.iter().position(|(unit, _)| *unit == s.unit).unwrap_or_else(|| {
            known.push((&s.unit, Vec::new()));
            known.len() - 1
        });
        for display in displays {
            if convertible(&s.unit, display).is_some() && !known[at].1.contains(&display) {
                known[at].1.push(display);
            }
        }
    }
    if known.is_empty() {
        return;
    }
    x.open("UnitDefinitions", &[]);
    for (unit, displays) in known {
        x.open("Unit", &[("name", unit)]);
        if let Some(found) = Unit::of(unit)
            && let (Some(scale), Some(exponents)) = (found.scale, found.dimension.exponents())
        {
            let names = ["kg", "m", "s", "A", "K", "mol", "cd"];
            let mut list: Vec<(&str, String)> = Vec::new();
            for (name, exponent) in names.iter().zip(exponents).filter(|(_, e)| *e != 0) {
                list.push((name, exponent.to_string()));
            }
            if scale.factor != 1.0 {
                list.push(("factor", number(scale.factor)));
            }
            if scale.offset != 0.0 {
                list.push(("offset", number(scale.offset)));
            }
            let list: Vec<(&str, &str)> = list.iter().map(|(n, v)| (*n, v.as_str())).collect();
            x.empty("BaseUnit", &list);
        }
        for display in displays {
            let Some((factor, offset)) = convertible(unit, display) else { continue };
            let (factor, offset) = (number(factor), number(offset));
            x.empty("DisplayUnit", &[("name", display), ("factor", &factor), ("offset", &offset)]);
        }
        x.close("Unit");
    }
    x.close("UnitDefinitions");
}

/// Factor and offset that turn values of a unit into values of another one; `None` if there are none, or if the
/// units are the same.
pub(super) fn convertible(unit: &str, display: &str) -> Option<(f64, f64)> {
    if display.is_empty() || display == unit {
        return None;
    }
    let (a, b) = (Unit::of(unit)?, Unit::of(display)?);
    let (from, to) = (a.scale?, b.scale?);
    (a.dimension == b.dimension)
        .then(|| (from.factor / to.factor, (from.offset - to.offset) / to.factor))
}
