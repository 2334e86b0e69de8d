//! The meaning of a name at a place in a text, for editors.
//!
//! *In:* a request whose text may be unfinished, and a byte offset. *Out:* the declaration that the name there refers to,
//! the names that may be written there, and all places in the text that refer to the same declaration.

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use super::catalogue::kind;
use super::compile::{Request, Session, find_in};
use super::dotted_name::{DottedName, at as word};
use crate::base::diag::Problems;
use crate::base::name::name;
use crate::base::source::Span;
use crate::classes::{ClassGraph, ROOT};
use crate::evaluate::Evaluator;
use crate::ir::ast::{
    self, Argument, ArgumentKind, Class, ClassBody, ElementKind, Ident, Modification, Variability,
};
use crate::ir::expr::Const;
use crate::ir::instance::{ClassId, Entry, EntryKind, Scope};
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

/// The kinds of names that may be written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CandidateKind {
    /// A variable or a component.
    Component,
    /// A parameter or a constant.
    Parameter,
    /// A class.
    Class,
    /// A package.
    Package,
    /// A keyword.
    Keyword,
}

/// A name that may be written.
#[derive(Clone, PartialEq, Debug)]
pub struct Candidate {
    /// The name.
    pub name: String,
    /// Its kind.
    pub kind: CandidateKind,
    /// Its type, or the kind of the class.
    pub detail: String,
    /// Its description string; may be empty.
    pub description: String,
    /// It is modified here, so ` = ` follows.
    pub is_modifier: bool,
    /// Its value in the declaration, as written; empty without one.
    pub default: String,
}

/// A component of a class, or a class.
#[derive(Clone)]
enum Target {
    Component(Entry),
    Class(ClassId),
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

    /// The names that may be written at `offset`.
    pub fn candidates(&mut self, request: &Request, offset: u32) -> Vec<Candidate> {
        let found = self.with_text(request, |cx, file, text| {
            let before = &text[..offset as usize];
            let start = before
                .rfind(|c: char| !c.is_alphanumeric() && c != '_')
                .map_or(0, |at| at + before[at..].chars().next().map_or(1, char::len_utf8));
            if let Some(stem) = before[..start].strip_suffix('.') {
                let word = word(text, stem.len() as u32)?;
                let target = resolve(cx, file, &word, stem.len() as u32)?;
                let class = class_of(cx, &target)?;
                return Some(members(cx, class, matches!(target, Target::Class(_)), false));
            }
            let (chain, _) = enclosing(file, offset)?;
            let class = class_named(cx, file, &chain)?;
            if let Some(modified) = modified(cx, class, chain.last()?, offset)
                && before[..start].trim_end().ends_with(['(', ','])
            {
                return Some(members(cx, modified, false, true));
            }
            let mut out = members(cx, class, true, false);
            for package in cx.library.child_names("") {
                if !out.iter().any(|known| known.name == package) {
                    out.push(Candidate {
                        name: package,
                        kind: CandidateKind::Package,
                        detail: "package".into(),
                        description: String::new(),
                        is_modifier: false,
                        default: String::new(),
                    });
                }
            }
            Some(out)
        });
        let mut out = found.flatten().unwrap_or_default();
        let is_member = request.text.as_deref().is_some_and(|text| {
            let word =
                text[..offset as usize].trim_end_matches(|c: char| c.is_alphanumeric() || c == '_');
            word.ends_with('.')
        });
        if !is_member && !out.iter().any(|c| c.is_modifier) {
            out.extend(TokenKind::KEYWORDS.iter().map(|word| Candidate {
                name: (*word).to_owned(),
                kind: CandidateKind::Keyword,
                detail: String::new(),
                description: String::new(),
                is_modifier: false,
                default: String::new(),
            }));
        }
        out
    }

    /// Calls `by` with the classes that the text can see.
    fn with_text<T>(
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

/// The classes around a place, from the outermost, and the full name of the innermost.
fn enclosing(file: &ast::File, offset: u32) -> Option<(Vec<Arc<Class>>, String)> {
    let holds = |class: &Class| class.span.start <= offset && offset <= class.span.end;
    let mut chain = vec![Arc::clone(file.classes.iter().find(|class| holds(class))?)];
    while let Some(ClassBody::Long(composition)) = chain.last().map(|class| &class.body) {
        let inner = composition.elements.iter().find_map(|e| match &e.kind {
            ElementKind::Class(class) if holds(class) => Some(Arc::clone(class)),
            _ => None,
        });
        match inner {
            Some(class) => chain.push(class),
            None => break,
        }
    }
    let names: Vec<String> = chain.iter().map(|class| class.name.name.to_string()).collect();
    let full = names.join(".");
    Some((chain, full))
}

fn class_named(cx: &mut Evaluator<'_>, file: &ast::File, chain: &[Arc<Class>]) -> Option<ClassId> {
    let names: Vec<String> = chain.iter().map(|class| class.name.name.to_string()).collect();
    find_in(cx, file, &names.join("."))
}

/// What a name refers to: in the class that is modified there, or in the classes around it.
fn resolve(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    word: &DottedName,
    offset: u32,
) -> Option<Target> {
    let Some((chain, _)) = enclosing(file, offset) else {
        return path(cx, ROOT.class, &word.parts, true);
    };
    let innermost = class_named(cx, file, &chain)?;
    let own = chain.last()?;
    if own.name.span.start <= offset && offset <= own.name.span.end {
        return Some(Target::Class(innermost));
    }
    if let Some(modified) = modified_name(cx, innermost, own, offset) {
        return path(cx, modified, &word.parts, false);
    }
    for k in (1..=chain.len()).rev() {
        let Some(class) = class_named(cx, file, &chain[..k]) else { continue };
        if let Some(found) = path(cx, class, &word.parts, k == chain.len()) {
            return Some(found);
        }
    }
    None
}

/// A dotted name among the elements of a class and, `lexically`, among all classes that it can see.
fn path(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    parts: &[String],
    lexically: bool,
) -> Option<Target> {
    let (first, rest) = parts.split_first()?;
    let mut target = member(cx, class, first).or_else(|| {
        let scope = Scope { instance: cx.classes[class].holder, class };
        let ident = Ident { name: name(first), span: Span::NONE };
        let wanted = ast::Path { global: false, parts: vec![ident], span: Span::NONE };
        lexically.then(|| cx.find_class(&wanted, scope)).flatten().map(Target::Class)
    })?;
    for part in rest {
        let class = class_of(cx, &target)?;
        target = member(cx, class, part)?;
    }
    Some(target)
}

fn member(cx: &mut Evaluator<'_>, class: ClassId, wanted: &str) -> Option<Target> {
    if class != ROOT.class && cx.definition(class).is_some() {
        let table = cx.table(class);
        if let Some(entry) = table.index.get(&name(wanted)).map(|k| table.entries[*k].clone())
            && matches!(entry.kind, EntryKind::Component(_))
        {
            return Some(Target::Component(entry));
        }
    }
    let holder = cx.classes[class].holder;
    cx.member_class(class, name(wanted), holder).map(Target::Class)
}

/// The class of a component, or the class itself.
fn class_of(cx: &mut Evaluator<'_>, target: &Target) -> Option<ClassId> {
    match target {
        Target::Class(class) => Some(*class),
        Target::Component(entry) => {
            let EntryKind::Component(declaration) = &entry.kind else { return None };
            let scope = Scope { instance: cx.classes[entry.class].holder, class: entry.class };
            cx.find_class(&declaration.clause().type_name, scope)
        }
    }
}

/// The class whose elements the arguments at a place modify.
fn modified(cx: &mut Evaluator<'_>, class: ClassId, text: &Class, offset: u32) -> Option<ClassId> {
    let (modification, class) = modification(cx, class, text, offset)?;
    descend(cx, modification, class, offset, false)
}

/// As [`modified`], if the place is in the name of an argument, not in its value.
fn modified_name(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    text: &Class,
    offset: u32,
) -> Option<ClassId> {
    let (modification, class) = modification(cx, class, text, offset)?;
    descend(cx, modification, class, offset, true)
}

/// The modification of a component or base class around a place, and the class that it modifies.
fn modification<'t>(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    text: &'t Class,
    offset: u32,
) -> Option<(&'t Modification, ClassId)> {
    let holds = |span: Span| span.start <= offset && offset <= span.end;
    let scope = Scope { instance: cx.classes[class].holder, class };
    let ClassBody::Long(composition) = &text.body else { return None };
    for element in composition.elements.iter().filter(|e| holds(e.span)) {
        let (of, found): (&ast::Path, _) = match &element.kind {
            ElementKind::Components(clause) => {
                let found = clause
                    .components
                    .iter()
                    .find_map(|c| c.modification.as_deref().filter(|m| holds(m.span)));
                (&clause.type_name, found)
            }
            ElementKind::Extends(extends) => {
                (&extends.base, extends.modification.as_deref().filter(|m| holds(m.span)))
            }
            _ => continue,
        };
        if let Some(found) = found {
            return Some((found, cx.find_class(of, scope)?));
        }
    }
    None
}

fn descend(
    cx: &mut Evaluator<'_>,
    modification: &Modification,
    class: ClassId,
    offset: u32,
    in_name: bool,
) -> Option<ClassId> {
    let holds = |span: Span| span.start <= offset && offset <= span.end;
    if modification.binding.as_ref().is_some_and(|b| holds(b.span)) {
        return None;
    }
    let Some(Argument {
        kind: ArgumentKind::Element { path: own, modification: inner, .. }, ..
    }) = modification.args.iter().find(|arg| holds(arg.span))
    else {
        return (!in_name).then_some(class);
    };
    if holds(own.span) {
        return Some(class);
    }
    let inner = inner.as_deref().filter(|m| holds(m.span))?;
    let parts: Vec<String> = own.parts.iter().map(|part| part.name.to_string()).collect();
    let target = path(cx, class, &parts, false)?;
    let class = class_of(cx, &target)?;
    descend(cx, inner, class, offset, in_name)
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

/// The elements of a class that may be named from outside, or from inside; those that may be modified.
fn members(cx: &mut Evaluator<'_>, class: ClassId, inside: bool, modified: bool) -> Vec<Candidate> {
    let mut out = Vec::new();
    let table: Rc<_> = cx.table(class);
    for entry in &table.entries {
        match &entry.kind {
            EntryKind::Component(declaration) if inside || !entry.protected => {
                let (clause, component) = (declaration.clause(), declaration.component());
                let is_fixed =
                    clause.prefix.variability.is_some_and(|v| v != Variability::Discrete);
                let binding = component.modification.as_ref().and_then(|m| m.binding.clone());
                let binding = binding.and_then(|e| cx.sources.text(e.span).map(str::to_owned));
                let default = binding.unwrap_or_default();
                let kind = match is_fixed {
                    true => CandidateKind::Parameter,
                    false => CandidateKind::Component,
                };
                out.push(Candidate {
                    name: component.name.name.to_string(),
                    kind,
                    detail: clause.type_name.to_string(),
                    description: component.description.as_deref().unwrap_or_default().to_owned(),
                    is_modifier: modified,
                    default,
                });
            }
            EntryKind::Class(text) if inside && !modified => out.push(of_class(text)),
            _ => {}
        }
    }
    if inside && !modified {
        let full = cx.classes[class].full_name.to_string();
        for file in cx.library.child_names(&full) {
            if out.iter().any(|known| known.name == file) {
                continue;
            }
            let holder = cx.classes[class].holder;
            let found = cx.member_class(class, name(&file), holder);
            if let Some(text) = found.and_then(|class| cx.definition(class).cloned()) {
                out.push(of_class(&text));
            }
        }
    }
    if modified {
        // Parameters are what is modified most.
        out.sort_by_key(|c| c.kind != CandidateKind::Parameter);
    }
    out
}

fn of_class(text: &Class) -> Candidate {
    let detail = kind(text);
    Candidate {
        name: text.name.name.to_string(),
        kind: if detail == "package" { CandidateKind::Package } else { CandidateKind::Class },
        detail: detail.to_owned(),
        description: text.description.as_deref().unwrap_or_default().to_owned(),
        is_modifier: false,
        default: String::new(),
    }
}
