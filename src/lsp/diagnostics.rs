//! Diagnostics of a text, as `mocc check` reports them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::Span;
use crate::driver::compile::{Request, Session};
use crate::io::json::Json;
use crate::ir::ast::{self, ClassBody, ElementKind};

use super::answers::on_disk;
use super::outline::tree;
use super::plans::{self, Plan};
use super::position::Lines;
use super::workspace::Workspace;

/// A diagnostic of the text itself: its place, bytes, and the rest.
#[derive(Clone, Debug)]
pub struct Placed {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
    /// The diagnostic.
    pub diagnostic: Diagnostic,
}

/// The diagnostics of the text of a request; those of other files are at the component that has them, or at its start.
pub fn check(request: &Request) -> (Vec<Placed>, Session) {
    let mut session = Session::default();
    // The diagnostics say whether it failed.
    let _ = session.check(request, Severity::Warning);
    (placed(&session, request.file.as_deref()), session)
}

/// The diagnostics of a plan, of tests or of settings.
pub fn check_plan(plan: &Plan<'_>) -> (Vec<Placed>, Session) {
    let mut session = Session::default();
    // What is no diagnostic is about files that cannot be read, which come and go.
    let _ = plans::check(plan, &mut session);
    (placed(&session, Some(plan.path)), session)
}

/// The files that a session has read.
pub fn files_of(session: &Session) -> BTreeSet<PathBuf> {
    session.sources.files().map(|file| file.path.clone()).collect()
}

/// The place in a text of a diagnostic of another file: a span that it has there, too, or the component that the message
/// names first.
fn place_here(session: &Session, own: &Path, d: &Diagnostic) -> Option<(usize, usize)> {
    let file = |span: Span| session.sources.get(span.file).filter(|file| file.path == own);
    if let Some((span, _)) = d.secondary.iter().find(|(span, _)| file(*span).is_some()) {
        return Some((span.start as usize, span.end as usize));
    }
    let named = d.message.split('`').nth(1).unwrap_or_default();
    let name = named.split(['.', '[']).next()?;
    // Else the only component whose class has the name of that file, or its base class.
    let stem = session.sources.get(d.primary.0.file)?.path.file_stem()?.to_string_lossy();
    let is_stem = |path: &ast::Path| path.parts.last().is_some_and(|part| *part.name == *stem);
    let text = &session.sources.files().find(|file| file.path == own)?.text;
    let tree = tree(text);
    let (mut places, mut uses) = (Vec::new(), Vec::new());
    let mut waiting: Vec<_> = tree.classes.iter().collect();
    while let Some(class) = waiting.pop() {
        let ClassBody::Long(own) = &class.body else { continue };
        for element in &own.elements {
            match &element.kind {
                ElementKind::Class(inner) => waiting.push(inner),
                ElementKind::Extends(e) if is_stem(&e.base) => uses.push(e.base.span),
                ElementKind::Components(c) if is_stem(&c.type_name) => uses.push(c.type_name.span),
                _ => {}
            }
            let is_class = matches!(element.kind, ElementKind::Class(_));
            let names = element.names().into_iter().filter(|(n, _)| !is_class && **n == *name);
            places.extend(names.map(|(_, span)| span));
        }
    }
    // Of several components with this name, it may be any.
    match (places.as_slice(), uses.as_slice()) {
        ([span], _) | ([], [span]) => Some((span.start as usize, span.end as usize)),
        _ => None,
    }
}

fn placed(session: &Session, own: Option<&Path>) -> Vec<Placed> {
    let is_own = |span: Span| {
        let file = session.sources.get(span.file).map(|file| file.path.as_path());
        file == own
    };
    let place = |d: &&Diagnostic| {
        let span = d.primary.0;
        let here = || own.and_then(|own| place_here(session, own, d)).unwrap_or((0, 0));
        let (start, end) =
            if is_own(span) { (span.start as usize, span.end as usize) } else { here() };
        Placed { start, end, diagnostic: (*d).clone() }
    };
    let mut out: Vec<Placed> = Vec::new();
    for one in session.problems.sorted().iter().map(place) {
        // The same mistake is found in each component of a class; once is enough where it was made.
        let is_same = |known: &Placed| {
            let (a, b) = (&known.diagnostic, &one.diagnostic);
            (known.start, known.end, a.code, &a.help) == (one.start, one.end, b.code, &b.help)
                && one.end > 0
        };
        if !out.iter().any(is_same) {
            out.push(one);
        }
    }
    out
}

/// Diagnostics as the protocol writes them.
pub fn json(all: &[Placed], own: &Path, text: &str, session: &Session, of: &Workspace) -> Json {
    let lines = Lines::of(text);
    let one = |placed: &Placed| {
        let d = &placed.diagnostic;
        let primary = d.primary.0;
        let elsewhere = session.sources.get(primary.file).filter(|file| file.path != own);
        let mut message = match elsewhere {
            Some(file) => {
                let line = file.line_column(primary.start).0;
                format!("in {}, line {line}: {}", shown(&file.path, own), d.message)
            }
            None => d.message.to_string(),
        };
        for note in &d.notes {
            message += &format!("\nnote: {note}");
        }
        if let Some(help) = &d.help {
            message += &format!("\nhelp: {help}");
        }
        let severity = match d.severity {
            Severity::Error => 1,
            Severity::Warning => 2,
        };
        let first = elsewhere.map(|_| (primary, "here".to_owned()));
        let related = first.iter().chain(&d.secondary).filter_map(|(span, label)| {
            let file = session.sources.get(span.file)?;
            let path = on_disk(&file.path)?;
            let location = Json::object([
                ("uri", Json::text(of.address(&path))),
                ("range", Lines::of(&file.text).place((span.start, span.end))),
            ]);
            Some(Json::object([("location", location), ("message", Json::text(label.as_str()))]))
        });
        Json::object([
            ("range", lines.range(placed.start, placed.end)),
            ("severity", Json::count(severity)),
            ("code", Json::text(d.code)),
            ("source", Json::text("mocc")),
            ("message", Json::text(message)),
            ("relatedInformation", Json::list(related)),
        ])
    };
    Json::list(all.iter().map(one))
}

/// A file of a message: from the folder of the text, if it is below it or beside it.
fn shown(path: &Path, own: &Path) -> String {
    let folders = own.parent().into_iter().flat_map(Path::ancestors).take(2);
    let near = folders.filter(|f| f.parent().is_some()).find_map(|f| path.strip_prefix(f).ok());
    near.unwrap_or(path).display().to_string()
}
