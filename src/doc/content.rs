//! The content of the page of a class, whatever the format of the pages.

use super::classes::Classes;
use crate::driver::catalogue::kind;
use crate::ir::ast::{
    Argument, ArgumentKind, Causality, Class, ClassBody, Component, ComponentClause, Composition,
    ConnectionPrefix, ElementKind, ExprKind, Extends, Modification, Path, Variability,
};

/// Classes that extend each other in a row.
const DEEPEST: usize = 12;

/// A class as its page shows it.
#[derive(Clone, PartialEq, Debug)]
pub struct Content {
    /// `model`, `partial model`.
    pub kind: String,
    /// Its description.
    pub description: String,
    /// The comment at its head, line by line; formulas are indented by two spaces.
    pub comment: Vec<String>,
    /// The classes that it extends, or the one that a short definition names.
    pub bases: Vec<Named>,
    /// Its parameters and constants, those of its bases first.
    pub parameters: Vec<Row>,
    /// Its other public variables and components, likewise.
    pub components: Vec<Row>,
    /// The literals of an enumeration, with their descriptions.
    pub literals: Vec<(String, String)>,
    /// The unit of a type.
    pub unit: String,
    /// What an effect of the catalogue explains, and how it is attached.
    pub effect: Option<(String, String)>,
}

/// A class as it is written in another.
#[derive(Clone, PartialEq, Debug)]
pub struct Named {
    /// The text.
    pub text: String,
    /// The class that it means, if that is known.
    pub class: Option<usize>,
}

/// A component.
#[derive(Clone, PartialEq, Debug)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// `input`, `output`, `flow`, `constant`; may be empty.
    pub prefix: &'static str,
    /// Its type.
    pub of: Named,
    /// The text of its value; may be empty.
    pub value: String,
    /// Its unit; may be empty.
    pub unit: String,
    /// Its description.
    pub description: String,
    /// The base that declares it.
    pub from: Option<usize>,
}

/// The content of a class.
pub fn content(classes: &Classes, k: usize) -> Content {
    let parsed = &classes.all[k];
    let class = &parsed.class;
    let partial = if class.partial { "partial " } else { "" };
    let mut content = Content {
        kind: format!("{partial}{}", kind(class)),
        description: class.description.as_deref().unwrap_or_default().to_owned(),
        comment: comment(&parsed.file, class),
        bases: Vec::new(),
        parameters: Vec::new(),
        components: Vec::new(),
        literals: Vec::new(),
        unit: String::new(),
        effect: effect(class),
    };
    match &class.body {
        ClassBody::Long(composition) => {
            content.bases = extended(composition).map(|e| named(classes, k, &e.base)).collect();
            let mut rows = Vec::new();
            collect(classes, k, DEEPEST, &mut rows);
            rows.iter_mut().for_each(|(row, _)| row.from = row.from.filter(|from| *from != k));
            let (fixed, others): (Vec<_>, Vec<_>) = rows.into_iter().partition(|(_, fixed)| *fixed);
            content.parameters = fixed.into_iter().map(|(row, _)| row).collect();
            content.components = others.into_iter().map(|(row, _)| row).collect();
        }
        ClassBody::Short(short) => {
            content.bases = vec![named(classes, k, &short.base)];
            content.unit = classes.unit(k, &short.base, short.modification.as_deref());
        }
        ClassBody::Enumeration(literals) => {
            let text = |d: &Option<std::sync::Arc<str>>| d.as_deref().unwrap_or("").to_owned();
            let all = literals.iter().flatten();
            content.literals =
                all.map(|l| (l.name.name.to_string(), text(&l.description))).collect();
        }
        ClassBody::PartialDerivative { .. } => {}
    }
    content
}

/// A name that is written in a class.
fn named(classes: &Classes, k: usize, path: &Path) -> Named {
    Named { text: path.to_string(), class: classes.find(k, path) }
}

fn extended(composition: &Composition) -> impl Iterator<Item = &Extends> {
    composition.elements.iter().filter_map(|e| match &e.kind {
        ElementKind::Extends(extends) => Some(extends),
        _ => None,
    })
}

/// The public components of a class, those of its bases first, and whether they are parameters or constants.
fn collect(classes: &Classes, k: usize, depth: usize, out: &mut Vec<(Row, bool)>) {
    let ClassBody::Long(composition) = &classes.all[k].class.body else { return };
    for extends in extended(composition) {
        let Some(base) = classes.find(k, &extends.base).filter(|b| *b != k && depth > 0) else {
            continue;
        };
        let first = out.len();
        collect(classes, base, depth - 1, out);
        if let Some(modification) = &extends.modification {
            let file = &classes.all[k].file;
            out[first..].iter_mut().for_each(|(row, _)| modify(row, modification, file));
        }
    }
    for element in composition.elements.iter().filter(|e| !e.protected) {
        let ElementKind::Components(clause) = &element.kind else { continue };
        let is_fixed = matches!(
            clause.prefix.variability,
            Some(Variability::Parameter | Variability::Constant)
        );
        out.extend(clause.components.iter().map(|c| (row(classes, k, clause, c), is_fixed)));
    }
}

/// The value that an `extends` clause gives a component of the base.
fn modify(row: &mut Row, modification: &Modification, file: &str) {
    let own = modification.args.iter().filter_map(|argument| match &argument.kind {
        ArgumentKind::Element { path, modification: Some(inner), .. } => Some((path, inner)),
        _ => None,
    });
    for (_, inner) in own.filter(|(path, _)| path.to_string() == row.name) {
        if let Some(value) = value(inner, file) {
            row.value = value;
        }
        if let Some(unit) = text_of(inner, "unit") {
            row.unit = unit;
        }
    }
}

fn row(classes: &Classes, k: usize, clause: &ComponentClause, component: &Component) -> Row {
    let file = &classes.all[k].file;
    let own = component.modification.as_deref();
    let prefix = match (clause.prefix.variability, clause.prefix.causality) {
        (Some(Variability::Constant), _) => "constant",
        (_, Some(Causality::Input)) => "input",
        (_, Some(Causality::Output)) => "output",
        _ => match clause.prefix.connection {
            Some(ConnectionPrefix::Flow) => "flow",
            Some(ConnectionPrefix::Stream) => "stream",
            None => "",
        },
    };
    Row {
        name: component.name.name.to_string(),
        prefix,
        of: named(classes, k, &clause.type_name),
        value: own.and_then(|m| value(m, file)).unwrap_or_default(),
        unit: classes.unit(k, &clause.type_name, own),
        description: component.description.as_deref().unwrap_or_default().to_owned(),
        from: Some(k),
    }
}

/// The text of a binding, on one line.
fn value(modification: &Modification, file: &str) -> Option<String> {
    let span = modification.binding.as_deref()?.span;
    let text = file.get(span.start as usize..span.end as usize)?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The entries `explains` and `effect` of the annotation of a class of the catalogue.
fn effect(class: &Class) -> Option<(String, String)> {
    let own = inner(class.annotation.as_deref()?, "__mocc")?;
    Some((text_of(own, "explains").unwrap_or_default(), text_of(own, "effect")?))
}

fn inner<'m>(modification: &'m Modification, name: &str) -> Option<&'m Modification> {
    let find = |argument: &'m Argument| match &argument.kind {
        ArgumentKind::Element { path, modification: Some(inner), .. }
            if path.to_string() == name =>
        {
            Some(&**inner)
        }
        _ => None,
    };
    modification.args.iter().find_map(find)
}

/// The string that a modification gives a name.
fn text_of(modification: &Modification, name: &str) -> Option<String> {
    match inner(modification, name)?.binding.as_deref().map(|e| &e.kind) {
        Some(ExprKind::String(text)) => Some(text.to_string()),
        _ => None,
    }
}

/// The comment lines at the head of a class.
fn comment(file: &str, class: &Class) -> Vec<String> {
    let own = file.get(class.name.span.end as usize..class.span.end as usize).unwrap_or_default();
    let lines = own.lines().skip(1).map(str::trim);
    let taken = lines.take_while(|line| line.starts_with("//"));
    let text = taken.map(|line| line.trim_start_matches('/'));
    let without_rules = text.filter(|line| !line.contains("----"));
    without_rules.map(|line| line.strip_prefix(' ').unwrap_or(line).to_owned()).collect()
}
