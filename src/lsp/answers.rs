//! Answers about names: hover, definition, references, rename, completion.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::driver::candidates::{Candidate, CandidateKind};
use crate::driver::catalogue::shipped;
use crate::driver::compile::{Request, Session};
use crate::driver::lookup::Found;
use crate::io::atomic_file::{create_folder, write_file};
use crate::io::json::Json;
use crate::parse::token::TokenKind;

use super::position::{address_of, range};
use super::workspace::{Referring, referring};

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

/// All places that refer to the same declaration, in this text and in other files.
pub fn references(
    request: &Request,
    offset: usize,
    open: &BTreeMap<PathBuf, String>,
) -> Option<Json> {
    let (_, all) = referring(request, offset, open)?;
    let of = |file: &Referring| {
        let address = address_of(&file.path);
        let place = |&(start, end): &(u32, u32)| {
            let place = range(&file.text, start as usize, end as usize);
            Json::object([("uri", Json::text(address.as_str())), ("range", place)])
        };
        file.places.iter().map(place).collect::<Vec<_>>()
    };
    Some(Json::list(all.iter().flat_map(of)))
}

/// The edits that give a name another one, in this text and in other files. The error says why there are none.
pub fn rename(
    request: &Request,
    offset: usize,
    new: &str,
    open: &BTreeMap<PathBuf, String>,
) -> Result<Json, String> {
    let is_name = new.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && new.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(format!("`{new}` is not a name"));
    }
    if TokenKind::KEYWORDS.contains(&new) {
        return Err(format!("`{new}` is a keyword"));
    }
    if Session::default().is_beside(request, offset as u32, new) {
        return Err(format!("there is already a `{new}` in this class"));
    }
    let found = referring(request, offset, open);
    let (found, all) = found.ok_or("there is no name that can be changed here")?;
    // A declaration outside of the files that are searched would keep its name.
    let declared = all.iter().find(|file| file.path == found.path);
    if declared.is_none_or(|file| !file.places.contains(&found.place)) {
        return Err(format!("`{}` is declared in {}", found.name, found.path.display()));
    }
    let of = |file: &Referring| {
        let edit = |&(start, end): &(u32, u32)| {
            let place = range(&file.text, start as usize, end as usize);
            Json::object([("range", place), ("newText", Json::text(new))])
        };
        (address_of(&file.path), Json::list(file.places.iter().map(edit)))
    };
    Ok(Json::object([("changes", Json::object(all.iter().map(of)))]))
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
