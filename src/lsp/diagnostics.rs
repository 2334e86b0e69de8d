//! Diagnostics of a text, as `mocc check` reports them.

use std::path::Path;

use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::Span;
use crate::driver::compile::{Request, Session};
use crate::io::json::Json;

use super::plans::{self, Plan};
use super::position::{address_of, range};

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

/// The diagnostics of the text of a request; those of other files are at its start.
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

fn placed(session: &Session, own: Option<&Path>) -> Vec<Placed> {
    let is_own = |span: Span| {
        let file = session.sources.get(span.file).map(|file| file.path.as_path());
        file == own
    };
    let place = |d: &&Diagnostic| {
        let span = d.primary.0;
        let (start, end) =
            if is_own(span) { (span.start as usize, span.end as usize) } else { (0, 0) };
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
pub fn json(all: &[Placed], text: &str, session: &Session) -> Json {
    let one = |placed: &Placed| {
        let d = &placed.diagnostic;
        let mut message = d.message.to_string();
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
        let related = d.secondary.iter().filter_map(|(span, label)| {
            let file = session.sources.get(span.file).filter(|file| file.path.is_absolute())?;
            let location = Json::object([
                ("uri", Json::text(address_of(&file.path))),
                ("range", range(&file.text, span.start as usize, span.end as usize)),
            ]);
            Some(Json::object([("location", location), ("message", Json::text(label.as_str()))]))
        });
        Json::object([
            ("range", range(text, placed.start, placed.end)),
            ("severity", Json::count(severity)),
            ("code", Json::text(d.code)),
            ("source", Json::text("mocc")),
            ("message", Json::text(message)),
            ("relatedInformation", Json::list(related)),
        ])
    };
    Json::list(all.iter().map(one))
}
