//! The names that may be written at a place in a text, for editors.

use std::rc::Rc;

use super::catalogue::kind;
use super::compile::{Request, Session};
use super::dotted_name::at as word;
use super::target::{Target, class_named, class_of, enclosing, modified, resolve};

use crate::base::name::{Name, name};
use crate::evaluate::Evaluator;
use crate::ir::ast::{Class, Variability};
use crate::ir::expr::{EnumId, Type};
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

impl Session {
    /// The names that may be written at `offset`.
    pub fn candidates(&mut self, request: &Request, offset: u32) -> Vec<Candidate> {
        let found = self.with_text(request, |cx, file, text| {
            let before = &text[..offset as usize];
            let start = before
                .rfind(|c: char| !c.is_alphanumeric() && c != '_')
                .map_or(0, |at| at + before[at..].chars().next().map_or(1, char::len_utf8));
            if let Some(stem) = before[..start].strip_suffix('.') {
                let end = without_subscripts(stem).len() as u32;
                let word = word(text, end)?;
                let target = resolve(cx, file, &word, end)?;
                let class = class_of(cx, &target)?;
                if matches!(target, Target::Class(_))
                    && let Some(Type::Enumeration(id)) = cx.table(class).scalar
                {
                    return Some(literals(cx, id));
                }
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
                    out.push(plain(&package, CandidateKind::Package, "package"));
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
            let keyword = |word: &&str| plain(word, CandidateKind::Keyword, "");
            out.extend(TokenKind::KEYWORDS.iter().map(keyword));
        }
        out
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
    if modified && let Some(ty) = table.scalar {
        return attributes(ty);
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
