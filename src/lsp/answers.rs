//! Answers about names: hover, definition, references, highlights, completion.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use crate::driver::candidates::{Candidate, CandidateKind};
use crate::driver::catalogue::shipped;
use crate::driver::compile::{Request, Session};
use crate::io::atomic_file::{create_folder, write_file};
use crate::io::json::Json;

use super::position::Lines;
use super::workspace::{Referring, Workspace, referring};

/// The declaration of a name, as Markdown.
pub fn hover(request: &Request, offset: usize) -> Option<Json> {
    let found = Session::default().look_up(request, offset as u32)?;
    let mut text = format!("```modelica\n{}\n```", found.code);
    if let Some(value) = &found.value {
        text += &format!("\n`{} {value}`", found.name);
    }
    if !found.description.is_empty() {
        text += &format!("\n\n{}", found.description);
    }
    text += &format!("\n\n*{}*", found.path.display());
    let contents = Json::object([("kind", Json::text("markdown")), ("value", Json::text(text))]);
    Some(Json::object([("contents", contents)]))
}

/// The place of the declaration of a name.
pub fn definition(workspace: &Workspace, request: &Request, offset: usize) -> Option<Json> {
    let found = Session::default().look_up(request, offset as u32)?;
    let address = workspace.address(&on_disk(&found.path)?);
    let place = Lines::of(&found.text).place(found.place);
    Some(Json::object([("uri", Json::text(address)), ("range", place)]))
}

/// A file on disk with the text of a source. Sources of an editor have absolute paths; those of the shipped library have
/// not, and are written to a folder of its version.
pub(super) fn on_disk(path: &Path) -> Option<PathBuf> {
    if path.is_absolute() {
        return Some(path.to_owned());
    }
    let inside = path.strip_prefix("lib").ok()?;
    let version = env!("CARGO_PKG_VERSION");
    let folder = crate::io::atomic_file::shared_folder(&format!("mocc-library-{version}"));
    let path = folder.join(inside);
    if !path.is_file() {
        for (name, bytes) in shipped() {
            let path = folder.join(name);
            create_folder(path.parent().unwrap_or(Path::new(""))).ok()?;
            write_file(&path, &bytes).ok()?;
        }
    }
    path.is_file().then_some(path)
}

/// All places that refer to the same declaration, in this text and in other files. `declared`: that of the declaration,
/// too.
pub fn references(
    workspace: &Workspace,
    request: &Request,
    offset: usize,
    declared: bool,
    is_cancelled: &AtomicBool,
) -> Option<Json> {
    let all = referring(workspace, request, offset, None, is_cancelled)?;
    let of = |file: &Referring| {
        let address = workspace.address(&file.path);
        let lines = Lines::of(&file.text);
        let wanted = |place: &&(u32, u32)| {
            declared || file.path != all.found.path || **place != all.found.place
        };
        let place = |place: &(u32, u32)| {
            let range = lines.place(*place);
            Json::object([("uri", Json::text(address.as_str())), ("range", range)])
        };
        file.occurrences.places.iter().filter(wanted).map(place).collect::<Vec<_>>()
    };
    Some(Json::list(all.files.iter().flat_map(of)))
}

/// The places in this text that refer to the same declaration.
pub fn highlights(request: &Request, offset: usize) -> Option<Json> {
    let (_, occurrences) = Session::default().occurrences(request, offset as u32)?;
    let lines = Lines::of(request.text.as_deref().unwrap_or_default());
    let one = |place: &(u32, u32)| Json::object([("range", lines.place(*place))]);
    Some(Json::list(occurrences.places.iter().map(one)))
}

/// The names that may be written.
pub fn completion(request: &Request, offset: usize) -> Json {
    let all = Session::default().candidates(request, offset as u32);
    let item = |(k, c): (usize, &Candidate)| {
        let kind = match c.kind {
            CandidateKind::Component => 6,
            CandidateKind::Parameter => 21,
            CandidateKind::Class => 7,
            CandidateKind::Package => 9,
            CandidateKind::Keyword => 14,
            CandidateKind::Literal => 20,
            CandidateKind::Function => 3,
        };
        let inserted = if c.is_modifier { format!("{} = ", c.name) } else { c.name.clone() };
        let detail = match c.default.as_str() {
            "" => c.detail.clone(),
            default => format!("{} = {default}", c.detail),
        };
        Json::object([
            ("label", Json::text(c.name.as_str())),
            ("kind", Json::count(kind)),
            ("detail", Json::text(detail)),
            ("documentation", Json::text(c.description.as_str())),
            ("insertText", Json::text(inserted)),
            ("sortText", Json::text(format!("{k:06}"))),
        ])
    };
    Json::list(all.iter().enumerate().map(item))
}
