//! The names that may be written at a place in a text, for editors.

use std::rc::Rc;

use super::catalogue::kind;
use super::compile::{Request, Session};
use super::dotted_name::at as word;
use super::target::{Target, class_named, class_of, enclosing, modified, resolve};

use crate::base::name::name;
use crate::evaluate::Evaluator;
use crate::ir::ast::{Class, Variability};
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
