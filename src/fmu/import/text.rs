//! An FMU as a Modelica model, whose parameters are those of the FMU and whose other variables are inputs. The compiler
//! reads it in place of the FMU, so that overrides, sweeps, measures and plans see names, units and types.

use crate::ir::foreign::{ForeignInterface, ForeignRole, ForeignType, ForeignVariable};

/// The text of the model.
pub fn model(interface: &ForeignInterface) -> String {
    let name = identifier(&interface.name);
    let mut out = format!("model {name}{}\n", comment(&interface.description));
    for v in &interface.variables {
        out.push_str(&declaration(v));
    }
    let [start, stop, step, tolerance] = interface.experiment;
    let entries =
        [("StartTime", start), ("StopTime", stop), ("Interval", step), ("Tolerance", tolerance)];
    let entries: Vec<String> =
        entries.iter().filter_map(|(key, x)| Some(format!("{key}={}", (*x)?))).collect();
    if !entries.is_empty() {
        out.push_str(&format!("  annotation(experiment({}));\n", entries.join(", ")));
    }
    out.push_str(&format!("end {name};\n"));
    out
}

fn declaration(v: &ForeignVariable) -> String {
    let ty = match v.ty {
        ForeignType::Real => "Real",
        ForeignType::Integer => "Integer",
        ForeignType::Boolean => "Boolean",
    };
    let start = literal(v.ty, v.start.unwrap_or(0.0));
    let mut attributes = Vec::new();
    if v.ty == ForeignType::Real {
        for (key, text) in [("unit", &v.unit), ("displayUnit", &v.display_unit)] {
            if !text.is_empty() {
                attributes.push(format!("{key}={}", quoted(text)));
            }
        }
    }
    let is_fixed = matches!(v.role, ForeignRole::Parameter | ForeignRole::Constant);
    if is_fixed && v.ty != ForeignType::Boolean {
        for (key, x) in [("min", v.range.0), ("max", v.range.1)] {
            attributes.extend(x.map(|x| format!("{key}={}", literal(v.ty, x))));
        }
    }
    if !is_fixed {
        attributes.push(format!("start={start}"));
    }
    let attributes = match attributes.as_slice() {
        [] => String::new(),
        list => format!("({})", list.join(", ")),
    };
    let (prefix, value) = match v.role {
        ForeignRole::Parameter => ("parameter", format!(" = {start}")),
        ForeignRole::Constant => ("final parameter", format!(" = {start}")),
        ForeignRole::Input | ForeignRole::Output | ForeignRole::Computed => {
            ("input", String::new())
        }
    };
    let (name, text) = (identifier(&v.name), comment(&v.description));
    format!("  {prefix} {ty} {name}{attributes}{value}{text};\n")
}

pub(super) fn literal(ty: ForeignType, x: f64) -> String {
    match ty {
        ForeignType::Boolean => (x != 0.0).to_string(),
        ForeignType::Integer => format!("{}", x.round()),
        ForeignType::Real => format!("{x:e}"),
    }
}

pub(super) fn quoted(text: &str) -> String {
    let escaped: String = text
        .chars()
        .map(|c| match c {
            '"' => "\\\"".to_owned(),
            '\\' => "\\\\".to_owned(),
            c => c.to_string(),
        })
        .collect();
    format!("\"{escaped}\"")
}

pub(super) fn comment(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(" {}", quoted(text)) }
}

/// Keywords of Modelica, which cannot be names.
const KEYWORDS: &str = " algorithm and annotation block break class connect connector constant constrainedby der discrete \
     each else elseif elsewhen encapsulated end enumeration equation expandable extends external false final flow for \
     function if import impure in initial inner input loop model not operator or outer output package parameter partial \
     protected public pure record redeclare replaceable return stream then true type when while within ";
/// Names with a meaning of their own.
const RESERVED: [&str; 6] = ["time", "Real", "Integer", "Boolean", "String", "Clock"];

/// A name as an identifier of Modelica: in quotes, unless it is one.
pub fn identifier(name: &str) -> String {
    let mut letters = name.chars();
    let is_plain = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && letters.all(|c| c.is_ascii_alphanumeric() || c == '_');
    let is_keyword = KEYWORDS.contains(&format!(" {name} ")) || RESERVED.contains(&name);
    if is_plain && !is_keyword {
        return name.to_owned();
    }
    let escaped = name.replace('\\', "\\\\").replace('\'', "\\'");
    format!("'{escaped}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_modelica_cannot_write_are_quoted() {
        assert_eq!(identifier("h_1"), "h_1");
        assert_eq!(identifier("body.x[1]"), "'body.x[1]'");
        assert_eq!(identifier("der(h)"), "'der(h)'");
        assert_eq!(identifier("end"), "'end'");
        assert_eq!(identifier("it's"), "'it\\'s'");
    }
}
