//! The meaning of a name at a place in a text, for editors.
//!
//! *In:* a request whose text may be unfinished, and a byte offset. *Out:* the declaration that the name there refers to,
//! the names that may be written there, and all places in the text that refer to the same declaration.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::catalogue::kind;
use super::compile::{Request, Session};
use super::dotted_name::at as word;
use super::subject::find;
use super::target::{Target, class_named, enclosing, modified_name, resolve};

use crate::base::diag::Problems;
use crate::base::name::name;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, ClassBody};
use crate::ir::expr::Const;
use crate::ir::instance::EntryKind;
use crate::parse::lexer::lex;
use crate::parse::token::TokenKind;
use crate::resolve::library::Library;

/// A declaration that a name refers to.
#[derive(Clone, PartialEq, Debug)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// Its declaration without what follows the description, as Modelica.
    pub code: String,
    /// Its description string; may be empty.
    pub description: String,
    /// Its file as diagnostics show it, and the text of that file.
    pub path: PathBuf,
    /// See `path`.
    pub text: Arc<str>,
    /// The place of its name there, bytes.
    pub place: (u32, u32),
    /// Unit and value of a variable in the model around the place, where they are known.
    pub value: Option<String>,
}

impl Session {
    /// The declaration that the name at `offset` refers to.
    pub fn look_up(&mut self, request: &Request, offset: u32) -> Option<Found> {
        let (mut found, variable) = self.with_text(request, |cx, file, text| {
            let word = word(text, offset)?;
            let target = resolve(cx, file, &word, offset)?;
            // The name of a modified element is not that of a variable of the model around it.
            let variable = enclosing(file, offset).and_then(|(chain, full)| {
                let class = class_named(cx, file, &chain)?;
                let is_modified = modified_name(cx, class, chain.last()?, offset).is_some();
                (!is_modified).then(|| (full, word.parts.join(".")))
            });
            Some((describe(cx, &target)?, variable))
        })??;
        found.value = variable.and_then(|(model, name)| self.value(request, model, &name));
        Some(found)
    }

    /// All places in the text that refer to the same declaration as the name at `offset`.
    pub fn occurrences(
        &mut self,
        request: &Request,
        offset: u32,
    ) -> Option<(Found, Vec<(u32, u32)>)> {
        self.with_text(request, |cx, file, text| {
            let target = resolve(cx, file, &word(text, offset)?, offset)?;
            let found = describe(cx, &target)?;
            let places = places(cx, file, text, &found);
            Some((found, places))
        })?
    }

    /// All places in another text that refer to a declaration.
    pub fn occurrences_of(&mut self, request: &Request, found: &Found) -> Vec<(u32, u32)> {
        let places = self.with_text(request, |cx, file, text| places(cx, file, text, found));
        places.unwrap_or_default()
    }

    /// Whether the class that declares the name at `offset` has an element `new`, too.
    pub fn is_beside(&mut self, request: &Request, offset: u32, new: &str) -> bool {
        let found = self.with_text(request, |cx, file, text| {
            match resolve(cx, file, &word(text, offset)?, offset)? {
                Target::Component(entry) => {
                    Some(cx.table(entry.class).index.contains_key(&name(new)))
                }
                Target::Class(class) => {
                    let full = cx.classes[class].full_name.to_string();
                    let beside = full
                        .rsplit_once('.')
                        .map_or(new.to_owned(), |(outer, _)| format!("{outer}.{new}"));
                    Some(find(cx, &beside).is_some())
                }
            }
        });
        found.flatten().unwrap_or(false)
    }

    /// Calls `by` with the classes that the text can see.
    pub(super) fn with_text<T>(
        &mut self,
        request: &Request,
        by: impl FnOnce(&mut Evaluator<'_>, &ast::File, &str) -> T,
    ) -> Option<T> {
        let text = request.text.clone()?;
        let mut library = Library::new(super::files::folders(request));
        let file = self.read(request, &mut library).ok()??;
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        Some(by(&mut cx, &file, &text))
    }

    /// Unit and value of a variable of a model, if the model can be flattened.
    fn value(&self, request: &Request, model: String, variable: &str) -> Option<String> {
        let request = Request { model: Some(model), ..request.clone() };
        let flat = Session::default().flatten(&request).ok()?;
        let found = flat.variables.iter().find(|v| v.name == variable)?;
        let value =
            found.binding.and_then(|e| flat.graph.as_const(e)).and_then(|value| match value {
                Const::Real(bits) => Some(f64::from_bits(bits).to_string()),
                Const::Integer(n) => Some(n.to_string()),
                Const::Boolean(flag) => Some(flag.to_string()),
                _ => None,
            });
        let unit = (!found.unit.is_empty() && &*found.unit != "1").then(|| found.unit.to_string());
        match (value, unit) {
            (None, None) => None,
            (Some(value), unit) => {
                Some(format!("= {value} {}", unit.unwrap_or_default()).trim_end().to_owned())
            }
            (None, Some(unit)) => Some(format!("in {unit}")),
        }
    }
}

/// The places in a text that refer to a declaration.
fn places(cx: &mut Evaluator<'_>, file: &ast::File, text: &str, found: &Found) -> Vec<(u32, u32)> {
    let mut places = Vec::new();
    // Tokens, so that strings and comments do not count.
    let tokens = lex(file.id, text, &mut Problems::new()).tokens;
    for token in tokens.iter().filter(|t| t.kind == TokenKind::Ident) {
        let at = token.start;
        if text.get(at as usize..token.end as usize) != Some(found.name.as_str()) {
            continue;
        }
        let Some(other) = word(text, at) else { continue };
        let same = resolve(cx, file, &other, at).and_then(|target| describe(cx, &target));
        if same
            .is_some_and(|same| same.place == found.place && is_same_file(&same.path, &found.path))
        {
            places.push(other.place);
        }
    }
    places
}

/// Two paths of one file, as different texts name it.
fn is_same_file(a: &Path, b: &Path) -> bool {
    let absolute = |path: &Path| std::path::absolute(path).ok();
    a == b || absolute(a).is_some_and(|a| Some(a) == absolute(b))
}

fn describe(cx: &mut Evaluator<'_>, target: &Target) -> Option<Found> {
    let (ident, code, description) = match target {
        Target::Class(class) => {
            let text = Arc::clone(cx.definition(*class)?);
            let base = match &text.body {
                ClassBody::Short(_) => cx.sources.text(text.span).unwrap_or_default().to_owned(),
                _ => format!("{} {}", kind(&text), cx.classes[*class].full_name),
            };
            (text.name, base, text.description.clone())
        }
        Target::Component(entry) => {
            let EntryKind::Component(declaration) = &entry.kind else { return None };
            let (element, component) = (&declaration.element, declaration.component());
            let first = declaration.clause().components.first()?;
            let prefix = Span { end: first.name.span.start, ..element.span };
            let prefix = cx.sources.text(prefix).unwrap_or_default().trim().to_owned();
            let own = component.modification.as_ref().map(|m| m.span);
            let own =
                own.and_then(|span| cx.sources.text(span)).unwrap_or_default().trim().to_owned();
            let space = if own.starts_with('=') { " " } else { "" };
            let code = format!("{prefix} {}{space}{own}", component.name.name);
            (component.name, code, component.description.clone())
        }
    };
    let file = cx.sources.get(ident.span.file)?;
    Some(Found {
        name: ident.name.to_string(),
        code: code.split_whitespace().collect::<Vec<_>>().join(" "),
        description: description.as_deref().unwrap_or_default().to_owned(),
        path: file.path.clone(),
        text: Arc::clone(&file.text),
        place: (ident.span.start, ident.span.end),
        value: None,
    })
}
