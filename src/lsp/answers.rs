//! Answers about names: hover, definition, references, rename, completion.

use std::path::{Path, PathBuf};

use crate::driver::catalogue::shipped;
use crate::driver::compile::{Request, Session};
use crate::driver::lookup::{Candidate, CandidateKind, Found};
use crate::io::atomic_file::{create_folder, write_file};
use crate::io::json::Json;

use super::position::{address_of, range};

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
pub fn definition(request: &Request, offset: usize) -> Option<Json> {
    let found = Session::default().look_up(request, offset as u32)?;
    let address = address_of(&readable(&found)?);
    let (start, end) = found.place;
    let place = range(&found.text, start as usize, end as usize);
    Some(Json::object([("uri", Json::text(address)), ("range", place)]))
}

/// A file on disk with the text of a declaration. The shipped library is written to a folder of its version.
fn readable(found: &Found) -> Option<PathBuf> {
    if found.path.is_absolute() {
        return Some(found.path.clone());
    }
    let inside = found.path.strip_prefix("lib").ok()?;
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
    Some(path)
}

/// All places in the text that refer to the same declaration.
pub fn references(request: &Request, offset: usize, address: &str) -> Option<Json> {
    let text = request.text.as_deref()?;
    let (_, places) = Session::default().occurrences(request, offset as u32)?;
    let place = |&(start, end): &(u32, u32)| {
        let place = range(text, start as usize, end as usize);
        Json::object([("uri", Json::text(address)), ("range", place)])
    };
    Some(Json::list(places.iter().map(place)))
}

/// The edits that give a name of this text another one. The error says why there are none.
pub fn rename(request: &Request, offset: usize, address: &str, new: &str) -> Result<Json, String> {
    let text = request.text.as_deref().unwrap_or_default();
    let is_name = new.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && new.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(format!("`{new}` is not a name"));
    }
    let found = Session::default().occurrences(request, offset as u32);
    let (found, places) = found.ok_or("there is no name that can be changed here")?;
    if Some(found.path.as_path()) != request.file.as_deref() {
        return Err(format!("`{}` is declared in {}", found.name, found.path.display()));
    }
    let edit = |&(start, end): &(u32, u32)| {
        let place = range(text, start as usize, end as usize);
        Json::object([("range", place), ("newText", Json::text(new))])
    };
    let edits = Json::list(places.iter().map(edit));
    Ok(Json::object([("changes", Json::object([(address, edits)]))]))
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
        };
        let inserted = if c.is_modifier { format!("{} = ", c.name) } else { c.name.clone() };
        Json::object([
            ("label", Json::text(c.name.as_str())),
            ("kind", Json::count(kind)),
            ("detail", Json::text(c.detail.as_str())),
            ("documentation", Json::text(c.description.as_str())),
            ("insertText", Json::text(inserted)),
            ("sortText", Json::text(format!("{k:06}"))),
        ])
    };
    Json::list(all.iter().enumerate().map(item))
}
