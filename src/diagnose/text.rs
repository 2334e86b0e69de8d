//! Models as text: a model with effects attached to it.

use crate::calibrate::modification::{Tree, parts};

use super::effect::Effect;
use super::place::Place;

/// An effect at a place with values for its parameters.
#[derive(Clone, Debug)]
pub struct Attached<'a> {
    /// The effect.
    pub effect: &'a Effect,
    /// Where.
    pub place: &'a Place,
    /// How the component is called.
    pub name: String,
    /// Values of parameters; elements of arrays by their subscripts.
    pub values: Vec<(String, f64)>,
}

/// A modification `name = value`, with a comment behind it.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Dotted name; `start(x)` for a start value.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// What to say about it.
    pub comment: String,
}

/// The model `name` that extends `base` with settings and effects.
pub fn model(
    name: &str,
    base: &str,
    description: &str,
    experiment: Option<&str>,
    settings: &[Setting],
    attached: &[Attached<'_>],
    comments: &[Vec<(String, String)>],
) -> String {
    let mut out = format!("model {name} \"{description}\"\n");
    out.push_str(&format!("  extends {base}"));
    let mut modifications = Tree::default();
    for s in settings {
        modifications.set(&path(&s.name), number(s.value), s.comment.clone());
    }
    for (k, a) in attached.iter().enumerate().filter(|(_, a)| a.effect.built_in) {
        let inner = |parameter: &str| path(&format!("{}.{parameter}", a.name));
        for (parameter, value) in &a.effect.with {
            modifications.set(&inner(parameter), value.clone(), String::new());
        }
        for (parameter, value) in &a.values {
            let said = comments.get(k).and_then(|list| list.iter().find(|(p, _)| p == parameter));
            let comment = said.map_or(String::new(), |(_, c)| c.clone());
            modifications.set(&inner(parameter), number(*value), comment);
        }
    }
    if modifications.is_empty() {
        out.push_str(";\n");
    } else {
        out.push_str("(\n");
        modifications.print(4, &mut out);
        out.push_str("  );\n");
    }
    for (k, a) in attached.iter().enumerate().filter(|(_, a)| !a.effect.built_in) {
        let said = comments.get(k);
        let mut arguments: Vec<(String, String)> = Vec::new();
        for (parameter, value) in grouped(&a.values) {
            let comment = said
                .and_then(|list| list.iter().find(|(p, _)| *p == parameter))
                .map_or(String::new(), |(_, c)| c.clone());
            arguments.push((format!("{parameter} = {value}"), comment));
        }
        for (input, variable) in &a.place.binds {
            arguments.push((format!("{input} = {variable}"), String::new()));
        }
        out.push_str(&format!("  {} {}", a.effect.class, a.name));
        if arguments.is_empty() {
            out.push_str(";\n");
            continue;
        }
        out.push_str("(\n");
        let last = arguments.len() - 1;
        for (k, (argument, comment)) in arguments.iter().enumerate() {
            let comma = if k < last { "," } else { ");" };
            let comment = if comment.is_empty() { String::new() } else { format!(" // {comment}") };
            out.push_str(&format!("    {argument}{comma}{comment}\n"));
        }
    }
    if attached.iter().any(|a| !a.place.connections.is_empty()) {
        out.push_str("equation\n");
    }
    for a in attached {
        for (own, other) in &a.place.connections {
            out.push_str(&format!("  connect({}.{own}, {other});\n", a.name));
        }
    }
    if let Some(experiment) = experiment {
        out.push_str(&format!("  annotation({experiment});\n"));
    }
    out.push_str(&format!("end {name};\n"));
    out
}

/// Where a setting stands among the modifications.
fn path(name: &str) -> Vec<String> {
    match name.strip_prefix("start(").and_then(|rest| rest.strip_suffix(')')) {
        Some(variable) => parts(&format!("{variable}.start")),
        None => parts(name),
    }
}

/// Parameters with their values; elements of an array in braces.
fn grouped(values: &[(String, f64)]) -> Vec<(String, String)> {
    let mut out: Vec<(String, Vec<String>, bool)> = Vec::new();
    for (name, value) in values {
        let (base, element) = match name.split_once('[') {
            Some((base, _)) => (base, true),
            None => (name.as_str(), false),
        };
        match out.iter_mut().find(|(n, ..)| n == base) {
            Some((_, list, _)) => list.push(number(*value)),
            None => out.push((base.to_owned(), vec![number(*value)], element)),
        }
    }
    let text = |(name, list, element): (String, Vec<String>, bool)| {
        (name, if element { format!("{{{}}}", list.join(", ")) } else { list.join(", ") })
    };
    out.into_iter().map(text).collect()
}

/// A literal with all its digits.
pub fn number(value: f64) -> String {
    let plain = format!("{value}");
    let scientific = format!("{value:e}");
    if plain.len() <= scientific.len() + 2 { plain } else { scientific }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_is_a_modification_of_its_variable() {
        assert_eq!(path("start(body.s)"), ["body", "s", "start"]);
        assert_eq!(path("seal_p.friction.F"), ["seal_p", "friction", "F"]);
    }

    #[test]
    fn elements_come_in_braces() {
        let values = [("F[1]".into(), 1.0), ("F[2]".into(), 0.0), ("w".into(), 2e-4)];
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(grouped(&values), [pair("F", "{1, 0}"), pair("w", "0.0002")]);
    }
}
