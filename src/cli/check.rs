//! `mocc check`: all problems of a model or a plan at once, for people or as JSON.

use super::args::inspect::Check;
use super::{Status, modelica_path, print, say};
use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::{SourceMap, Span};
use crate::driver::compile::{CompileError, Session};
use crate::io::json::Json;
use crate::lsp::plans::{Plan, Wrong, check};

/// Checks; status 0 without errors, 1 with some.
pub fn run(options: &Check) -> Status {
    let mut session = Session::default();
    let checked = match options.plan() {
        Some(path) => {
            let plan = Plan { path, text: None, modelica_path: modelica_path() };
            check(&plan, &mut session).map_err(|wrong| match wrong {
                Wrong::Said(error) => error,
                Wrong::Message(why) => {
                    eprintln!("error: {why}");
                    CompileError::Request
                }
            })
        }
        None => session.check(&options.request(), options.severity()),
    };
    if options.json {
        let all = session.problems.sorted().into_iter().map(|d| as_json(d, &session.sources));
        let printed = print(&Json::list(all).pretty());
        if printed != Status::Done {
            return printed;
        }
    } else {
        if options.quiet {
            session.problems.remove(|d| d.severity == Severity::Warning);
        }
        say(&session);
    }
    match checked {
        Ok(()) => Status::Done,
        Err(CompileError::Model) => Status::Model,
        Err(CompileError::Request) => Status::Usage,
    }
}

/// A problem; `file`, `line`, `column` and `end` are null where it has no place in a text. Lines and
/// columns count from 1, columns in characters; `end` is the place after the last character.
fn as_json(d: &Diagnostic, sources: &SourceMap) -> Json {
    let (span, label) = &d.primary;
    let mut members = place(*span, sources);
    members.push(("code", Json::text(d.code)));
    let severity = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    members.push(("severity", Json::text(severity)));
    members.push(("message", Json::text(d.message.as_str())));
    members.push(("label", Json::text(label.as_str())));
    members.push(("notes", Json::list(d.notes.iter().map(|n| Json::text(n.as_str())))));
    members.push(("help", d.help.as_deref().map_or(Json::null(), Json::text)));
    let also = d.secondary.iter().map(|(span, text)| {
        let mut members = place(*span, sources);
        members.push(("label", Json::text(text.as_str())));
        Json::object(members)
    });
    members.push(("also", Json::list(also)));
    Json::object(members)
}

fn place(span: Span, sources: &SourceMap) -> Vec<(&'static str, Json)> {
    let Some(file) = sources.get(span.file).filter(|_| !span.is_none()) else {
        return ["file", "line", "column", "end"].map(|key| (key, Json::null())).to_vec();
    };
    let (line, column) = file.line_column(span.start);
    let (end_line, end_column) = file.line_column(span.end);
    let end = Json::object([("line", Json::count(end_line)), ("column", Json::count(end_column))]);
    vec![
        ("file", Json::text(file.path.display().to_string())),
        ("line", Json::count(line)),
        ("column", Json::count(column)),
        ("end", end),
    ]
}
