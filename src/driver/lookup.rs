//! The meaning of a name at a place in a text, for editors.
//!
//! *In:* a request whose text may be unfinished, and a byte offset. *Out:* the declaration that the name there refers to,
//! the names that may be written there, and all places in the text that refer to the same declaration.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::call::tokens;
use super::catalogue::kind;
use super::compile::{Request, Session};
use super::dotted_name::at as word;
use super::hints::value_of;
use super::open_texts::canonical;
use super::subject::find;
use super::target::{
    Meaning, Target, class_named, enclosing, meaning, member, modified_name, resolve,
};

use crate::base::diag::Severity;
use crate::base::name::name;
use crate::base::source::{SourceFile, Span};
use crate::classes::ClassGraph;
use crate::classes::predefined::is_built_in;
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, ArgumentKind, Class, ClassBody, ElementKind, Modification};
use crate::ir::instance::EntryKind;
use crate::parse::lexer::Lexed;
use crate::parse::token::{Token, TokenKind};
use crate::resolve::library::Library;

/// The kinds of declarations.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FoundKind {
    /// A class.
    Class,
    /// A component.
    Component,
    /// A component that is `inner` or `outer`: its counterparts are found by its name.
    Exchanged,
    /// A literal of an enumeration.
    Literal,
}

/// A declaration that a name refers to.
#[derive(Clone, PartialEq, Debug)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: FoundKind,
    /// The name by which the place refers to it, which differs for another name by an import clause.
    pub written: String,
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

/// Places in a text, bytes.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Occurrences {
    /// Those that refer to a declaration.
    pub places: Vec<(u32, u32)>,
    /// Those with the same name whose meaning cannot be found.
    pub unknown: Vec<(u32, u32)>,
}

impl Session {
    /// The declaration that the name at `offset` refers to.
    pub fn look_up(&mut self, request: &Request, offset: u32) -> Option<Found> {
        let (mut found, variable) = self.with_text(request, |cx, file, text| {
            let lexed = tokens(text);
            let (target, token) = target_at(cx, file, text, &lexed, offset)?;
            let variable = variable(cx, file, text, token.start);
            Some((describe(cx, &target)?, variable))
        })??;
        found.value = variable.and_then(|(model, name)| self.value(request, model, &name));
        Some(found)
    }

    /// All places in the text that refer to the same declaration as the name at `offset`.
    pub fn occurrences(&mut self, request: &Request, offset: u32) -> Option<(Found, Occurrences)> {
        self.with_text(request, |cx, file, text| {
            let lexed = tokens(text);
            let (target, token) = target_at(cx, file, text, &lexed, offset)?;
            let mut found = describe(cx, &target)?;
            found.written = text[token.start as usize..token.end as usize].to_owned();
            let places = places(cx, file, text, &found);
            Some((found, places))
        })?
    }

    /// All places in another text that refer to a declaration.
    pub fn occurrences_of(&mut self, request: &Request, found: &Found) -> Occurrences {
        let places = self.with_text(request, |cx, file, text| places(cx, file, text, found));
        places.unwrap_or_default()
    }

    /// Whether the class that declares the name at `offset` has an element `new`, too.
    pub fn is_beside(&mut self, request: &Request, offset: u32, new: &str) -> bool {
        let found = self.with_text(request, |cx, file, text| {
            match target_at(cx, file, text, &tokens(text), offset)?.0 {
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
                Target::Literal(_) => {
                    let (chain, _) = enclosing(file, offset)?;
                    let class = class_named(cx, file, &chain)?;
                    Some(member(cx, class, new).is_some())
                }
            }
        });
        found.flatten().unwrap_or(false)
    }

    /// Whether the language defines a name: `Real`, `time`, `sin`.
    pub fn is_of_language(&mut self, request: &Request, name: &str) -> bool {
        let name = crate::base::name::name(name);
        let found = self.with_text(request, |cx, _, _| cx.predefined.contains_key(&name));
        is_built_in(&name) || found.unwrap_or(false)
    }

    /// The errors in the declarations of all classes of a text: names that are declared twice, base classes and
    /// redeclared elements that do not exist.
    pub fn declaration_errors(&mut self, request: &Request) -> Vec<String> {
        self.with_text(request, |cx, file, _| {
            let mut waiting: Vec<Vec<Arc<Class>>> =
                file.classes.iter().map(|class| vec![Arc::clone(class)]).collect();
            while let Some(chain) = waiting.pop() {
                if let Some(class) = class_named(cx, file, &chain) {
                    cx.table(class);
                }
                let Some(ClassBody::Long(own)) = chain.last().map(|class| &class.body) else {
                    continue;
                };
                for element in &own.elements {
                    if let ElementKind::Class(inner) = &element.kind {
                        waiting.push([chain.as_slice(), &[Arc::clone(inner)]].concat());
                    }
                }
            }
        });
        let errors = self.problems.iter().filter(|d| d.severity == Severity::Error);
        errors.map(|d| d.message.clone()).collect()
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
        let value = found.binding.and_then(|e| value_of(&flat, e));
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

/// The declaration that the word at a place refers to, and the word. Words of comments and strings refer to nothing.
fn target_at(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    text: &str,
    lexed: &Lexed,
    offset: u32,
) -> Option<(Target, Token)> {
    let holds = |t: &Token| t.kind == TokenKind::Ident && t.start <= offset && offset <= t.end;
    let first = lexed.tokens.iter().position(holds)?;
    // Of two words that touch, the second.
    let second = lexed.tokens.get(first + 1).filter(|t| holds(t)).map(|_| first + 1);
    let k = second.unwrap_or(first);
    let token = lexed.tokens[k];
    let target = match meaning(cx, file, token.start, follows_end(&lexed.tokens, k)) {
        Meaning::Declared(target) => Some(target),
        Meaning::Other => None,
        Meaning::Unknown => resolve(cx, file, &word(text, token.start)?, token.start),
    };
    Some((target?, token))
}

fn follows_end(tokens: &[Token], k: usize) -> bool {
    k.checked_sub(1).is_some_and(|k| tokens[k].kind == TokenKind::End)
}

/// The places in a text that refer to a declaration.
fn places(cx: &mut Evaluator<'_>, file: &ast::File, text: &str, found: &Found) -> Occurrences {
    let mut out = Occurrences::default();
    // Tokens, so that strings and comments do not count.
    let tokens = tokens(text).tokens;
    for (k, token) in tokens.iter().enumerate().filter(|(_, t)| t.kind == TokenKind::Ident) {
        let at = token.start;
        if text.get(at as usize..token.end as usize) != Some(found.name.as_str()) {
            continue;
        }
        let target = match meaning(cx, file, at, follows_end(&tokens, k)) {
            Meaning::Declared(target) => Some(target),
            Meaning::Other => continue,
            Meaning::Unknown => word(text, at).and_then(|word| resolve(cx, file, &word, at)),
        };
        match target.and_then(|target| describe(cx, &target)) {
            None => out.unknown.push((at, token.end)),
            Some(same) if same.place == found.place && is_same_file(&same.path, &found.path) => {
                out.places.push((at, token.end));
            }
            Some(_) => {}
        }
    }
    out
}

/// Two paths of one file, as different texts name it.
fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || a.file_name() == b.file_name() && canonical(a) == canonical(b)
}

/// The model around a place, and the variable of it that the name at the place refers to.
fn variable(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    text: &str,
    at: u32,
) -> Option<(String, String)> {
    let (chain, full) = enclosing(file, at)?;
    let class = class_named(cx, file, &chain)?;
    let own = chain.last()?;
    // The name of a modified element is that of a variable of the component.
    let name = match modified_name(cx, class, own, at) {
        Some(_) => modified_variable(own, at)?,
        None => word(text, at)?.parts.join("."),
    };
    Some((full, name))
}

/// The variable of a model whose element is modified at a place.
fn modified_variable(class: &Class, at: u32) -> Option<String> {
    let holds = |span: Span| span.start <= at && at <= span.end;
    let ClassBody::Long(own) = &class.body else { return None };
    for element in own.elements.iter().filter(|e| holds(e.span)) {
        let ElementKind::Components(clause) = &element.kind else { continue };
        for component in clause.components.iter().filter(|c| c.dims.is_empty()) {
            let modification = component.modification.as_deref().filter(|m| holds(m.span));
            if let Some(modification) = modification {
                return Some(format!("{}.{}", component.name.name, argument(modification, at)?));
            }
        }
    }
    None
}

/// The dotted name of the element that a modification modifies at a place.
fn argument(modification: &Modification, at: u32) -> Option<String> {
    let holds = |span: Span| span.start <= at && at <= span.end;
    let found = modification.args.iter().find(|argument| holds(argument.span))?;
    let ArgumentKind::Element { path, modification: inner, .. } = &found.kind else { return None };
    if holds(path.span) {
        return Some(path.to_string());
    }
    let inner = inner.as_deref().filter(|m| holds(m.span))?;
    Some(format!("{path}.{}", argument(inner, at)?))
}

fn describe(cx: &mut Evaluator<'_>, target: &Target) -> Option<Found> {
    let (ident, found_kind, code, description) = match target {
        Target::Class(class) => {
            let text = Arc::clone(cx.definition(*class)?);
            let base = match &text.body {
                ClassBody::Short(_) => cx.sources.text(text.span).unwrap_or_default().to_owned(),
                _ => format!("{} {}", kind(&text), cx.classes[*class].full_name),
            };
            (text.name, FoundKind::Class, base, text.description.clone())
        }
        Target::Literal(literal) => {
            let code = format!("{} (literal of an enumeration)", literal.name.name);
            (literal.name, FoundKind::Literal, code, literal.description.clone())
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
            let dims = dims(cx.sources.get(component.name.span.file)?, component.name.span.end);
            let code = format!("{prefix} {}{dims}{space}{own}", component.name.name);
            let is_exchanged = element.inner || element.outer;
            let kind = if is_exchanged { FoundKind::Exchanged } else { FoundKind::Component };
            (component.name, kind, code, component.description.clone())
        }
    };
    let file = cx.sources.get(ident.span.file)?;
    Some(Found {
        name: ident.name.to_string(),
        kind: found_kind,
        written: ident.name.to_string(),
        code: code.split_whitespace().collect::<Vec<_>>().join(" "),
        description: description.as_deref().unwrap_or_default().to_owned(),
        path: file.path.clone(),
        text: Arc::clone(&file.text),
        place: (ident.span.start, ident.span.end),
        value: None,
    })
}

/// `[3]` after the name of a component.
fn dims(file: &SourceFile, end: u32) -> &str {
    let rest = file.text.get(end as usize..).unwrap_or_default();
    if !rest.starts_with('[') {
        return "";
    }
    rest.find(']').map_or("", |at| &rest[..=at])
}
