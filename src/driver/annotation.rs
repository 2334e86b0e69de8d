//! The annotations `__mocc` of classes, evaluated: entries `key = "text"`.

use super::compile::{Request, Session};
use super::subject::{find, model};

use crate::base::source::Span;
use crate::classes::{ClassGraph, ROOT};
use crate::evaluate::Evaluator;
use crate::ir::ast::{Argument, ArgumentKind, Modification};
use crate::ir::expr::Const;
use crate::ir::instance::{ClassId, Scope};
use crate::resolve::library::Library;

/// A class with an annotation `__mocc`.
#[derive(Clone, Debug)]
pub struct Annotated {
    /// Its full name.
    pub class: String,
    /// The entries of the annotation, in order.
    pub entries: Vec<Annotation>,
}

/// An entry `key = "text"` of an annotation `__mocc`.
#[derive(Clone, Debug)]
pub struct Annotation {
    /// Its key.
    pub key: String,
    /// Its text.
    pub text: String,
    /// The place of the text.
    pub span: Span,
}

impl Annotated {
    /// The entry with a key.
    pub fn entry(&self, key: &str) -> Option<&Annotation> {
        self.entries.iter().find(|e| e.key == key)
    }
}

impl Session {
    /// Classes of libraries that have an annotation `__mocc`, each with its entries.
    pub fn annotated(&mut self, request: &Request, classes: &[String]) -> Vec<Annotated> {
        let mut library = Library::new(super::files::folders(request));
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        let mut out = Vec::new();
        for full in classes.iter().cloned() {
            let Some(class) = find(&mut cx, &full) else { continue };
            let entries = entries(&mut cx, class);
            if !entries.is_empty() {
                out.push(Annotated { class: full, entries });
            }
        }
        out
    }

    /// The entries of the annotation `__mocc` of the requested model; none if it cannot be found.
    pub fn own_annotation(&mut self, request: &Request) -> Annotated {
        let mut found = Annotated { class: String::new(), entries: Vec::new() };
        let mut library = Library::new(super::files::folders(request));
        let Ok(file) = self.read(request, &mut library) else { return found };
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        if let Ok(class) = model(&mut cx, request, file.as_deref()) {
            found.class = cx.classes[class].full_name.to_string();
            found.entries = entries(&mut cx, class);
        }
        found
    }
}

/// The entries of the annotation `__mocc` of a class.
fn entries(cx: &mut Evaluator<'_>, class: ClassId) -> Vec<Annotation> {
    let Some(annotation) = cx.definition(class).and_then(|t| t.annotation.clone()) else {
        return Vec::new();
    };
    let scope = Scope { instance: ROOT.instance, class };
    let arguments = annotation.args.iter().filter_map(|a| named(a, "__mocc"));
    let mut out = Vec::new();
    for entry in arguments.flat_map(|m| m.args.iter()) {
        let ArgumentKind::Element { path, modification: Some(m), .. } = &entry.kind else {
            continue;
        };
        let Some(binding) = &m.binding else { continue };
        let value = cx.fold(binding, scope).and_then(|v| v.scalar());
        if let Some(Const::String(text)) = value.and_then(|e| cx.graph.as_const(e)) {
            let (key, span) = (path.to_string(), binding.span);
            out.push(Annotation { key, text: text.to_string(), span });
        }
    }
    out
}

fn named<'a>(argument: &'a Argument, name: &str) -> Option<&'a Modification> {
    match &argument.kind {
        ArgumentKind::Element { path, modification: Some(m), .. } if path.to_string() == name => {
            Some(m)
        }
        _ => None,
    }
}
