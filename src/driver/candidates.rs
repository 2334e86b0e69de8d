//! The names that may be written at a place in a text, for editors.

use std::rc::Rc;

use super::call::{called, is_prose, modified, opened, parameters, tokens};
use super::catalogue::kind;
use super::compile::{Request, Session};
use super::dotted_name::at as word;
use super::subject::find;
use super::target::{Target, class_named, class_of, enclosing, resolve};

use crate::base::name::{Name, name};
use crate::classes::predefined::without_row;
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, Class, Variability};
use crate::ir::expr::{Binary, EnumId, Type, Unary};
use crate::ir::instance::{ClassId, EntryKind};
use crate::parse::token::TokenKind;

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
    /// A literal of an enumeration.
    Literal,
    /// A function or an operator of the language.
    Function,
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
    /// It is the name of an argument, which may as well be given by its position.
    pub is_argument: bool,
    /// Its value in the declaration, as written; empty without one.
    pub default: String,
}

impl Session {
    /// The names that may be written at `offset`.
    pub fn candidates(&mut self, request: &Request, offset: u32) -> Vec<Candidate> {
        let Some(text) = request.text.as_deref() else { return Vec::new() };
        let before = &text[..offset as usize];
        let word = before.trim_end_matches(|c: char| c.is_alphanumeric() || c == '_');
        let is_number = before[word.len()..].starts_with(|c: char| c.is_ascii_digit());
        if is_number || is_prose(&tokens(text), text, offset) {
            return Vec::new();
        }
        let start = word.len();
        let is_member = word.ends_with('.');
        let found = self.with_text(request, |cx, file, text| {
            if is_member {
                after_dot(cx, file, text, start)
            } else {
                Some(names(cx, file, text, offset))
            }
        });
        let mut out = found.flatten().unwrap_or_default();
        if !is_member && !out.iter().any(|c| c.is_modifier && !c.is_argument) {
            let keyword = |word: &&str| plain(word, CandidateKind::Keyword, "");
            out.extend(TokenKind::KEYWORDS.iter().map(keyword));
        }
        out
    }
}

/// The names after a dot.
fn after_dot(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    text: &str,
    start: usize,
) -> Option<Vec<Candidate>> {
    let stem = text[..start].strip_suffix('.')?;
    let end = without_subscripts(stem).len() as u32;
    let word = word(text, end)?;
    let target = resolve(cx, file, &word, end)?;
    let class = class_of(cx, &target)?;
    if matches!(target, Target::Class(_))
        && let Some(Type::Enumeration(id)) = cx.table(class).scalar
    {
        return Some(literals(cx, id));
    }
    Some(members(cx, class, matches!(target, Target::Class(_)), false))
}

/// The names of a place that does not follow a dot.
fn names(cx: &mut Evaluator<'_>, file: &ast::File, text: &str, offset: u32) -> Vec<Candidate> {
    let all = opened(&tokens(text), text, offset);
    if all.last().is_some_and(|own| own.begins && !own.head.is_empty())
        && let Some(class) = modified(cx, file, offset, &all)
    {
        return members(cx, class, false, true);
    }
    let mut out = Vec::new();
    // Named arguments.
    if all.last().is_some_and(|own| own.begins)
        && let Some(class) = called(cx, file, offset, &all)
    {
        out.extend(parameters(cx, class).into_iter().map(|p| Candidate {
            description: p.description,
            is_modifier: true,
            is_argument: true,
            ..plain(&p.name, CandidateKind::Parameter, &p.text)
        }));
    }
    let chain = enclosing(file, offset).map(|(chain, _)| chain).unwrap_or_default();
    for k in (1..=chain.len()).rev() {
        let Some(class) = class_named(cx, file, &chain[..k]) else { continue };
        let is_innermost = k == chain.len();
        // Of the classes around it, a class sees the constants and the classes.
        let mut seen = members(cx, class, true, false);
        seen.retain(|c| is_innermost || c.kind != CandidateKind::Component);
        add(&mut out, seen);
        if chain[k - 1].encapsulated {
            break;
        }
    }
    let within = file.package().map(ToString::to_string).unwrap_or_default();
    let mut package = within.as_str();
    while !package.is_empty() {
        if let Some(class) = find(cx, package) {
            let mut seen = entries(cx, class, true, false);
            seen.retain(|c| c.kind != CandidateKind::Component);
            add(&mut out, seen);
            let files = cx.library.child_names(package);
            add(&mut out, files.iter().map(|name| plain(name, CandidateKind::Class, "")));
        }
        package = package.rsplit_once('.').map_or("", |(outer, _)| outer);
    }
    let packages = cx.library.child_names("");
    add(&mut out, packages.iter().map(|name| plain(name, CandidateKind::Package, "package")));
    let types = ["Real", "Integer", "Boolean", "String"];
    add(&mut out, types.map(|name| plain(name, CandidateKind::Class, "type")));
    let rows = Unary::TABLE.iter().flat_map(|op| op.called_names());
    let rows = rows.chain(Binary::TABLE.iter().flat_map(|op| op.called_names())).copied();
    let functions = without_row().chain(rows).filter(|name| !types.contains(name));
    add(&mut out, functions.map(|name| plain(name, CandidateKind::Function, "")));
    out
}

/// Adds the names that are not hidden by those before them.
fn add(out: &mut Vec<Candidate>, more: impl IntoIterator<Item = Candidate>) {
    for one in more {
        if !out.iter().any(|known| known.name == one.name && !known.is_argument) {
            out.push(one);
        }
    }
}

/// A dotted name without the subscripts at its end: `a.b[1]` is `a.b`.
fn without_subscripts(stem: &str) -> &str {
    let mut depth = 0;
    for (at, c) in stem.char_indices().rev() {
        match c {
            ']' => depth += 1,
            '[' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return if c == '[' { &stem[..at] } else { stem };
        }
    }
    stem
}

fn plain(name: &str, kind: CandidateKind, detail: &str) -> Candidate {
    Candidate {
        name: name.to_owned(),
        kind,
        detail: detail.to_owned(),
        description: String::new(),
        is_modifier: false,
        is_argument: false,
        default: String::new(),
    }
}

/// The literals of an enumeration.
fn literals(cx: &Evaluator<'_>, id: EnumId) -> Vec<Candidate> {
    let known = &cx.graph.enumerations[id];
    let literal = |name: &Name| plain(name, CandidateKind::Literal, &known.name);
    known.literals.iter().map(literal).collect()
}

/// The attributes of a predefined type, which are modified.
fn attributes(ty: Type) -> Vec<Candidate> {
    let of = |name: &str, detail: &str| Candidate {
        is_modifier: true,
        ..plain(name, CandidateKind::Parameter, detail)
    };
    let own = match ty {
        Type::Real => "Real",
        Type::Integer => "Integer",
        Type::Boolean => "Boolean",
        Type::String => "String",
        Type::Enumeration(_) => "enumeration",
        Type::Clock => return Vec::new(),
    };
    let mut out = vec![of("start", own), of("fixed", "Boolean")];
    if matches!(ty, Type::Real | Type::Integer | Type::Enumeration(_)) {
        out.extend(["min", "max"].map(|name| of(name, own)));
    }
    if ty == Type::Real {
        out.extend(["unit", "displayUnit"].map(|name| of(name, "String")));
        out.extend([of("nominal", "Real"), of("stateSelect", "StateSelect")]);
    }
    out.push(of("quantity", "String"));
    out
}

/// The elements of a class that may be named from outside, or from inside; those that may be modified.
fn members(cx: &mut Evaluator<'_>, class: ClassId, inside: bool, modified: bool) -> Vec<Candidate> {
    let table: Rc<_> = cx.table(class);
    let mut out = entries(cx, class, inside, modified);
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
    if modified && let Some(ty) = table.scalar {
        return attributes(ty);
    }
    if modified {
        // Parameters are what is modified most.
        out.sort_by_key(|c| c.kind != CandidateKind::Parameter);
    }
    out
}

/// As [`members`], without the classes in files of their own.
fn entries(cx: &mut Evaluator<'_>, class: ClassId, inside: bool, modified: bool) -> Vec<Candidate> {
    let mut out = Vec::new();
    if cx.definition(class).is_none() {
        return out;
    }
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
                    is_argument: false,
                    default,
                });
            }
            EntryKind::Class(text) if inside && !modified => out.push(of_class(text)),
            _ => {}
        }
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
        is_argument: false,
        default: String::new(),
    }
}
