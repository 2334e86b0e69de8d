//! What an editor shows between the words of a model: the value of a parameter after all modifications, and units.
//!
//! *In:* a request whose text may be unfinished, and a part of it. *Out:* texts and the places after which they stand. A
//! literal says its value itself, so only its unit is shown.

use std::sync::Arc;

use super::catalogue::kind;
use super::compile::{Request, Session};
use crate::base::diag::Problems;
use crate::base::index::FastMap;
use crate::base::source::SourceMap;
use crate::ir::ast::{ArgumentKind, Class, ClassBody, ElementKind, Expr, ExprKind, Modification};
use crate::ir::expr::{Const, ExprId, Node, Type};
use crate::ir::flat::{FlatModel, Variability};
use crate::parse::grammar::parse;
use crate::symbolic::eval::{binary, unary};

/// Operators and parameters that a value is computed from, one in the other.
const DEEPEST: usize = 200;

/// A text after a place.
#[derive(Clone, PartialEq, Debug)]
pub struct Hint {
    /// The place, bytes.
    pub at: u32,
    /// What stands there.
    pub text: String,
}

/// A class that can be simulated.
#[derive(Clone, PartialEq, Debug)]
pub struct Runnable {
    /// Its full name.
    pub name: String,
    /// The place of its name, bytes.
    pub place: (u32, u32),
}

/// The models of a text that are not partial, nested ones too.
pub fn runnable(text: &str) -> Vec<Runnable> {
    let mut out = Vec::new();
    for (name, class) in models(text) {
        out.push(Runnable { name, place: (class.name.span.start, class.name.span.end) });
    }
    out
}

fn models(text: &str) -> Vec<(String, Arc<Class>)> {
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let id = sources.add("text.mo", text);
    let file = parse(id, text, &mut problems);
    let within = file.within.as_ref().map(ToString::to_string).unwrap_or_default();
    let mut out = Vec::new();
    let mut open: Vec<(String, Arc<Class>)> = file
        .classes
        .iter()
        .map(|class| {
            let full = match within.as_str() {
                "" => class.name.name.to_string(),
                package => format!("{package}.{}", class.name.name),
            };
            (full, Arc::clone(class))
        })
        .collect();
    while let Some((full, class)) = open.pop() {
        let ClassBody::Long(composition) = &class.body else { continue };
        for element in &composition.elements {
            if let ElementKind::Class(inner) = &element.kind {
                open.push((format!("{full}.{}", inner.name.name), Arc::clone(inner)));
            }
        }
        if matches!(kind(&class), "model" | "block") && !class.partial {
            out.push((full, class));
        }
    }
    out.sort_by_key(|(_, class)| class.span.start);
    out
}

impl Session {
    /// The hints in the part `from..to` of the text.
    pub fn hints(request: &Request, (from, to): (u32, u32)) -> Vec<Hint> {
        let Some(text) = request.text.as_deref() else { return Vec::new() };
        let mut out = Vec::new();
        for (name, class) in models(text) {
            if class.span.end < from || class.span.start > to {
                continue;
            }
            let own = Request { model: Some(name), ..request.clone() };
            // A model with errors has its diagnostics.
            let Ok(flat) = Session::default().flatten(&own) else { continue };
            Known::of(&flat).class(&class, &mut out);
        }
        out.retain(|hint| (from..=to).contains(&hint.at));
        out.sort_by_key(|hint| hint.at);
        out.dedup();
        out
    }
}

/// Unit and value of each variable.
struct Known<'f> {
    variables: FastMap<&'f str, (&'f str, Option<String>)>,
}

impl<'f> Known<'f> {
    fn of(flat: &'f FlatModel) -> Known<'f> {
        let value = |e| value_of(flat, e);
        let of = |v: &'f crate::ir::flat::Variable| {
            let unit = if v.unit.as_str() == "1" { "" } else { v.unit.as_str() };
            (v.name.as_str(), (unit, v.binding.and_then(value)))
        };
        Known { variables: flat.variables.iter().map(of).collect() }
    }

    fn class(&self, class: &Class, out: &mut Vec<Hint>) {
        let ClassBody::Long(composition) = &class.body else { return };
        for element in &composition.elements {
            let ElementKind::Components(clause) = &element.kind else { continue };
            for component in &clause.components {
                let name = component.name.name.to_string();
                let own = component.modification.as_deref();
                let binding = own.and_then(|m| m.binding.as_deref());
                if let Some((unit, value)) = self.variables.get(name.as_str()) {
                    let end = binding.map_or(component.name.span.end, |b| b.span.end);
                    out.extend(hint(end, unit, value.as_deref(), binding));
                }
                if let Some(own) = own {
                    self.modified(&name, own, out);
                }
            }
        }
    }

    /// The arguments of the modification of a component.
    fn modified(&self, prefix: &str, modification: &Modification, out: &mut Vec<Hint>) {
        for argument in &modification.args {
            let ArgumentKind::Element { path, modification: Some(inner), .. } = &argument.kind
            else {
                continue;
            };
            let name = format!("{prefix}.{path}");
            if let (Some(binding), Some((unit, value))) =
                (inner.binding.as_deref(), self.variables.get(name.as_str()))
            {
                out.extend(hint(binding.span.end, unit, value.as_deref(), Some(binding)));
            }
            self.modified(&name, inner, out);
        }
    }
}

/// The value of an expression of literals and parameters.
pub(super) fn value_of(flat: &FlatModel, e: ExprId) -> Option<String> {
    match flat.graph.as_const(e) {
        Some(Const::Integer(n)) => Some(n.to_string()),
        Some(Const::Boolean(flag)) => Some(flag.to_string()),
        _ => None,
    }
    .or_else(|| {
        let x = number(flat, e, 0)?;
        Some(if flat.graph.ty(e) == Type::Boolean { (x != 0.0).to_string() } else { x.to_string() })
    })
}

fn number(flat: &FlatModel, e: ExprId, depth: usize) -> Option<f64> {
    if depth > DEEPEST {
        return None;
    }
    let of = |e| number(flat, e, depth + 1);
    match flat.graph.node(e) {
        Node::Const(Const::Real(bits)) => Some(f64::from_bits(bits)),
        Node::Const(Const::Integer(n)) => Some(n as f64),
        Node::Var(v) if flat.variables[v].variability <= Variability::Parameter => {
            of(flat.variables[v].binding?)
        }
        Node::Unary(op, a) => Some(unary(op, of(a)?, flat.graph.externals())),
        Node::Binary(op, a, b) => Some(binary(op, of(a)?, of(b)?, flat.graph.externals())),
        _ => None,
    }
    .filter(|x| x.is_finite())
}

/// ` = 0.03 kg` after a formula, ` kg` after a literal or a name without a value.
fn hint(at: u32, unit: &str, value: Option<&str>, binding: Option<&Expr>) -> Option<Hint> {
    let text = match (value, binding) {
        (Some(value), Some(binding)) if !is_literal(binding) => format!("= {value} {unit}"),
        _ => unit.to_owned(),
    };
    let text = text.trim_end().to_owned();
    (!text.is_empty()).then_some(Hint { at, text })
}

fn is_literal(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Real(_) | ExprKind::Integer(_) | ExprKind::Boolean(_) | ExprKind::String(_) => {
            true
        }
        ExprKind::Unary(_, inner) => is_literal(inner),
        _ => false,
    }
}
