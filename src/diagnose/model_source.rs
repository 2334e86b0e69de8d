//! The source of a model with effects attached.

use crate::calibrate::modification::{Tree, parts};
use crate::calibrate::plan::RECORDING_NUMBER;

use super::adapter::Adapters;
use super::catalogue::Effect;
use super::follower::Follower;
use super::hypothesis::full_name;
use super::place::Place;
use super::terminal_reading::TerminalReading;

/// An effect at a place with values for its parameters.
#[derive(Clone, Debug)]
pub struct Attached<'a> {
    /// The effect.
    pub effect: &'a Effect,
    /// Its place.
    pub place: &'a Place,
    /// Name of its component.
    pub name: String,
    /// Values of parameters; array elements by their subscripts.
    pub values: Vec<(String, f64)>,
    /// Comments on parameters, by their names without subscripts.
    pub comments: Vec<(String, String)>,
}

impl<'a> Attached<'a> {
    /// An effect without comments.
    pub fn new(
        effect: &'a Effect,
        place: &'a Place,
        name: String,
        values: Vec<(String, f64)>,
    ) -> Attached<'a> {
        Attached { effect, place, name, values, comments: Vec::new() }
    }

    fn comment(&self, parameter: &str) -> String {
        let found = self.comments.iter().find(|(p, _)| p == parameter);
        found.map_or(String::new(), |(_, c)| c.clone())
    }

    /// Adds the modifications of the component that the effect is built into.
    fn modify(&self, modifications: &mut Tree) {
        let inner = |parameter: &str| path(&full_name(&self.name, parameter));
        if let Some(r) = self.effect.choice.as_ref().and_then(|c| c.replacement.as_ref()) {
            modifications.redeclare(&path(&r.element), r.keyword, &r.class);
        }
        for (parameter, value) in &self.effect.with {
            modifications.set(&inner(parameter), value.clone(), String::new());
        }
        for (parameter, value) in &self.values {
            modifications.set(&inner(parameter), number(*value), self.comment(parameter));
        }
    }

    /// Writes the declaration of the effect's own component.
    fn declare(&self, out: &mut String) {
        let mut arguments: Vec<(String, String)> = Vec::new();
        for (parameter, value) in grouped(&self.values) {
            let comment = self.comment(&parameter);
            arguments.push((format!("{parameter} = {value}"), comment));
        }
        for (input, variable) in &self.place.binds {
            arguments.push((format!("{input} = {variable}"), String::new()));
        }
        out.push_str(&format!("  {} {}", self.effect.class, self.name));
        if arguments.is_empty() {
            out.push_str(";\n");
            return;
        }
        out.push_str("(\n");
        let last = arguments.len() - 1;
        for (k, (argument, comment)) in arguments.iter().enumerate() {
            let comma = if k < last { "," } else { ");" };
            let comment = if comment.is_empty() { String::new() } else { format!(" // {comment}") };
            out.push_str(&format!("    {argument}{comma}{comment}\n"));
        }
    }
}

/// A modification `name = value` with a comment.
#[derive(Clone, Debug)]
pub struct ParameterValue {
    /// Dotted name; `start(x)` for a start value.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The comment.
    pub comment: String,
}

/// A model that extends another one.
#[derive(Clone, Debug, Default)]
pub struct Extension<'a> {
    /// Its name.
    pub name: &'a str,
    /// Full name of the model that it extends.
    pub base: &'a str,
    /// Its description.
    pub description: &'a str,
    /// Its experiment annotation, if any.
    pub experiment: Option<&'a str>,
    /// The entry of its annotation `__mocc` that names the outputs of sensors, if any.
    pub measured: Option<&'a str>,
    /// Modifications of the base.
    pub values: &'a [ParameterValue],
    /// What sensors read at the terminals of components.
    pub readings: &'a [TerminalReading],
    /// The parts that pull the model to recordings.
    pub followers: &'a [Follower],
}

impl Extension<'_> {
    /// The source of the model with effects attached.
    pub fn source(&self, attached: &[Attached<'_>]) -> String {
        let (built_in, components): (Vec<_>, Vec<_>) =
            attached.iter().partition(|a| a.effect.built_in);
        let mut out = format!("model {} \"{}\"\n", self.name, self.description);
        out.push_str(&format!("  extends {}", self.base));
        let mut modifications = Tree::default();
        for v in self.values {
            modifications.set(&path(&v.name), number(v.value), v.comment.clone());
        }
        built_in.into_iter().for_each(|a| a.modify(&mut modifications));
        if modifications.is_empty() {
            out.push_str(";\n");
        } else {
            out.push_str("(\n");
            modifications.print(4, &mut out);
            out.push_str("  );\n");
        }
        let is_number = |(_, variable): &(String, String)| variable == RECORDING_NUMBER;
        if attached.iter().any(|a| a.place.binds.iter().any(is_number)) {
            let about = "Number of the recording, 1 for the first";
            out.push_str(&format!("  parameter Real {RECORDING_NUMBER} = 1 \"{about}\";\n"));
        }
        let mut classes: Vec<&str> = components
            .iter()
            .filter_map(|a| Some(a.effect.formula.as_ref()?.source.as_str()))
            .collect();
        classes.sort_unstable();
        classes.dedup();
        classes.into_iter().for_each(|class| out.push_str(class));
        components.into_iter().for_each(|a| a.declare(&mut out));
        self.readings.iter().for_each(|r| out.push_str(&r.declaration(attached)));
        self.followers.iter().for_each(|f| f.declare(&mut out));
        out.push_str(&self.connections(attached));
        let entries = [
            variations(attached),
            additions(attached, "adds", |e| e.adds.as_ref()),
            passages(attached),
            additions(attached, "starts", |e| e.starts.as_ref()),
        ];
        let entries = entries.iter().filter_map(Option::as_deref);
        let own: Vec<&str> = self.measured.into_iter().chain(entries).collect();
        let own = (!own.is_empty()).then(|| format!("__mocc({})", own.join(", ")));
        let annotations: Vec<&str> = self.experiment.into_iter().chain(own.as_deref()).collect();
        if !annotations.is_empty() {
            out.push_str(&format!("  annotation({});\n", annotations.join(", ")));
        }
        out.push_str(&format!("end {};\n", self.name));
        out
    }

    /// The adapters that effects need, and all connections.
    fn connections(&self, attached: &[Attached<'_>]) -> String {
        let (mut adapters, mut connections) = (Adapters::default(), String::new());
        for a in attached {
            for (own, other) in &a.place.connections {
                let adapter = a.place.adapters.iter().find(|adapter| adapter.end == *other);
                let other = adapter.map_or(other.clone(), |adapter| adapters.attach(adapter));
                connections.push_str(&format!("  connect({}.{own}, {other});\n", a.name));
            }
        }
        self.followers.iter().for_each(|f| connections.push_str(&f.connection()));
        let mut out = String::new();
        adapters.declare(self.base, &mut out);
        if !connections.is_empty() {
            out.push_str("equation\n");
        }
        adapters.connect(&mut out);
        out + &connections
    }
}

/// The entry of the annotation `__mocc` that lets parameters vary, if an effect does.
fn variations(attached: &[Attached<'_>]) -> Option<String> {
    let of = |a: &Attached<'_>| {
        let factor = a.effect.varies.as_ref().map(|own| format!("{}.{own}", a.name));
        let parameters = if factor.is_some() { a.place.at.clone() } else { Vec::new() };
        let factor = factor.unwrap_or_default();
        parameters.into_iter().map(move |p| format!("{p} = {factor}")).collect::<Vec<_>>()
    };
    let all: Vec<String> = attached.iter().flat_map(of).collect();
    (!all.is_empty()).then(|| format!("varies = \"{}\"", all.join(", ")))
}

/// The entry of the annotation `__mocc` that adds variables of effects to what their places name, if effects have such: terms
/// of equations, offsets of starts.
fn additions(
    attached: &[Attached<'_>],
    key: &str,
    own: impl Fn(&Effect) -> Option<&String>,
) -> Option<String> {
    let of = |a: &Attached<'_>| {
        let (added, to) = (own(a.effect)?, a.place.at.first()?);
        Some(format!("{to} = {}.{added}", a.name))
    };
    let all: Vec<String> = attached.iter().filter_map(of).collect();
    (!all.is_empty()).then(|| format!("{key} = \"{}\"", all.join(", ")))
}

/// The entry of the annotation `__mocc` that leads inputs through effects, if one acts on them.
fn passages(attached: &[Attached<'_>]) -> Option<String> {
    let of = |a: &&Attached<'_>| {
        let (output, (_, input)) = (a.effect.acts.as_ref()?, a.place.binds.first()?);
        Some(format!("{input} = {}.{output}", a.name))
    };
    let (first, others): (Vec<_>, Vec<_>) = attached.iter().partition(|a| a.effect.is_first);
    let all: Vec<String> = first.iter().chain(&others).filter_map(of).collect();
    (!all.is_empty()).then(|| format!("through = \"{}\"", all.join(", ")))
}

/// The path of a parameter in the tree of modifications.
fn path(name: &str) -> Vec<String> {
    match name.strip_prefix("start(").and_then(|rest| rest.strip_suffix(')')) {
        Some(variable) => parts(&format!("{variable}.start")),
        None => parts(name),
    }
}

/// Parameters with their values; array elements are collected in braces.
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
