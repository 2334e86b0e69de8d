//! The class that a request is about: by its name, or the last model of a file.

use super::cause::RequestCause;
use super::compile::{CompileError, Request};

use crate::base::diag::{Diagnostic, did_you_mean};
use crate::base::name::name;
use crate::base::source::Span;
use crate::classes::ROOT;
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, ClassBody, ClassKind, ElementKind};
use crate::ir::instance::ClassId;

/// The class of a request.
pub(super) fn model(
    cx: &mut Evaluator<'_>,
    request: &Request,
    file: Option<&ast::File>,
) -> Result<ClassId, CompileError> {
    let wanted = match (&request.model, file) {
        (Some(text), _) => text.clone(),
        (None, Some(file)) => match last_model(file) {
            Some(full_name) => full_name,
            None => {
                let place = Span::new(file.id, 0, 0);
                cx.problems.push(Diagnostic::new(RequestCause::NoModelInFile, place));
                return Err(CompileError::Model);
            }
        },
        (None, None) => {
            cx.problems.push(Diagnostic::new(RequestCause::NothingNamed, Span::NONE));
            return Err(CompileError::Request);
        }
    };
    let found = match file {
        Some(file) => find_in(cx, file, &wanted),
        None => find(cx, &wanted),
    };
    if let Some(class) = found {
        let text = cx.definition(class).cloned();
        let kind = cx.kind(class);
        if let Some(text) = text {
            let name = wanted.clone();
            let cause = if text.partial {
                Some(RequestCause::PartialModel { name })
            } else if matches!(kind, ClassKind::Package | ClassKind::Function { .. }) {
                Some(RequestCause::NotAModel { name })
            } else {
                None
            };
            if let Some(cause) = cause {
                cx.problems.push(Diagnostic::new(cause, text.name.span));
                return Err(CompileError::Model);
            }
        }
        return Ok(class);
    }
    if !cx.problems.has_errors() {
        let mut names: Vec<String> = file.map(models).unwrap_or_default();
        names.extend(cx.library.child_names(""));
        // The last part of a full name is what many take for the name.
        let inside = names.iter().find(|name| name.rsplit('.').next() == Some(wanted.as_str()));
        let alike = || did_you_mean(&wanted, names.iter().map(String::as_str)).map(str::to_owned);
        let near = inside.cloned().or_else(alike);
        let cause = RequestCause::UnknownModel { name: wanted, near };
        cx.problems.push(Diagnostic::new(cause, Span::NONE));
        // Its name is in the command line.
        return Err(CompileError::Request);
    }
    Err(CompileError::Model)
}

/// A class of a file, which may be named without the packages that contain the file.
pub(super) fn find_in(cx: &mut Evaluator<'_>, file: &ast::File, wanted: &str) -> Option<ClassId> {
    let full = file.package().and_then(|package| find(cx, &format!("{package}.{wanted}")));
    full.or_else(|| find(cx, wanted))
}

pub(super) fn find(cx: &mut Evaluator<'_>, full_name: &str) -> Option<ClassId> {
    let mut class = ROOT.class;
    for part in split(full_name) {
        let holder = cx.classes[class].holder;
        class = cx.member_class(class, name(part), holder)?;
    }
    (class != ROOT.class).then_some(class)
}

/// The parts of a dotted name; dots in quoted identifiers do not separate.
fn split(full_name: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut quoted = false;
    for (i, c) in full_name.char_indices() {
        match c {
            '\'' => quoted = !quoted,
            '.' if !quoted => {
                parts.push(&full_name[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(&full_name[start..]);
    parts
}

fn last_model(file: &ast::File) -> Option<String> {
    models(file).pop()
}

/// Full names of the models of a file that are not partial, in order of the text.
pub(super) fn models(file: &ast::File) -> Vec<String> {
    let mut out = Vec::new();
    for class in &file.classes {
        collect(class, "", &mut out);
    }
    out
}

fn collect(class: &ast::Class, around: &str, out: &mut Vec<String>) {
    let full = if around.is_empty() {
        class.name.name.to_string()
    } else {
        format!("{around}.{}", class.name.name)
    };
    let runs = matches!(class.kind, ClassKind::Model | ClassKind::Block | ClassKind::Class);
    if class.kind == ClassKind::Package
        && let ClassBody::Long(composition) = &class.body
    {
        for e in &composition.elements {
            if let ElementKind::Class(c) = &e.kind {
                collect(c, &full, out);
            }
        }
    }
    if runs && !class.partial {
        out.push(full);
    }
}
