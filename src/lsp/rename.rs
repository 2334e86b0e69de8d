//! Renames a declaration everywhere, or says why that is not safe.
//!
//! The edits are tried on copies of the texts: each changed word must refer to the declaration afterwards, no other word
//! may, and no class may have got an error in its declarations.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::outline::tree;
use super::position::{Lines, address_of};
use super::workspace::{Referred, Referring, Workspace, referring};
use crate::base::diag::Problems;
use crate::base::source::FileId;
use crate::driver::compile::{Request, Session};
use crate::driver::lookup::{Found, FoundKind};
use crate::io::json::Json;
use crate::parse::lexer::lex;
use crate::parse::token::TokenKind;

/// The place of the name at `offset`, if it can be renamed. The error says why not.
pub fn prepare(request: &Request, offset: usize) -> Result<Json, String> {
    let text = request.text.as_deref().unwrap_or_default();
    let Some((found, occurrences)) = Session::default().occurrences(request, offset as u32) else {
        return Err(NOTHING.to_owned());
    };
    renamable(&found)?;
    let holds = |(start, end): &&(u32, u32)| *start as usize <= offset && offset <= *end as usize;
    let place = occurrences.places.iter().find(holds).ok_or(NOTHING)?;
    let placeholder = Json::text(found.name.as_str());
    Ok(Json::object([("range", Lines::of(text).place(*place)), ("placeholder", placeholder)]))
}

/// Why a word cannot be renamed.
const NOTHING: &str =
    "there is no name of a class, a component or a literal here that can be renamed";

fn renamable(found: &Found) -> Result<(), String> {
    let name = &found.name;
    if found.written != *name {
        let written = &found.written;
        return Err(format!(
            "`{written}` is another name for `{name}`, by an import clause; rename `{name}` where it is written as such"
        ));
    }
    if found.kind == FoundKind::Exchanged {
        return Err(format!(
            "`{name}` is `inner` or `outer`: other components find it by its name, so it cannot be renamed safely"
        ));
    }
    if !found.path.is_absolute() {
        return Err(format!("`{name}` is declared in {}", found.path.display()));
    }
    Ok(())
}

/// The edits that give a name another one, in this text and in other files. The error says why there are none.
pub fn rename(
    workspace: &Workspace,
    request: &Request,
    offset: usize,
    new: &str,
    is_cancelled: &AtomicBool,
) -> Result<Json, String> {
    check_name(request, new)?;
    if Session::default().is_beside(request, offset as u32, new) {
        return Err(format!("there is already a `{new}` in this class"));
    }
    let all = referring(workspace, request, offset, Some(new), is_cancelled).ok_or(NOTHING)?;
    renamable(&all.found)?;
    if !all.is_complete {
        return Err("there are too many files to search all of them".to_owned());
    }
    // A declaration outside of the files that are searched would keep its name.
    let declared = all.files.iter().find(|file| file.path == all.found.path);
    if declared.is_none_or(|file| !file.occurrences.places.contains(&all.found.place)) {
        let (name, path) = (&all.found.name, all.found.path.display());
        return Err(format!("`{name}` is declared in {path}"));
    }
    if let Some(file) = all.files.iter().find(|file| !file.occurrences.unknown.is_empty()) {
        let start = file.occurrences.unknown[0].0 as usize;
        let line = Lines::of(&file.text).line_character(start).0 + 1;
        let (name, path) = (&all.found.name, file.path.display());
        return Err(format!(
            "the meaning of `{name}` in {path}, line {line}, is not clear, so it would be left behind or changed by mistake"
        ));
    }
    let moved = moved(&all.found, new)?;
    if let Some(moved) = &moved {
        if !workspace.renames_files {
            let (name, path) = (&all.found.name, moved.from.display());
            return Err(format!(
                "`{name}` is found by the name of {path}, and this editor cannot rename files with a name; \
                 rename the file and the class by hand"
            ));
        }
        if moved.to.exists() {
            return Err(format!("there is already {}", moved.to.display()));
        }
    }
    // The files of a package are not tried in its new folder.
    if moved.as_ref().is_none_or(|moved| !moved.from.is_dir()) {
        try_out(workspace, &all, new, moved.as_ref())?;
    }
    Ok(edits(workspace, &all, new, moved.as_ref()))
}

fn check_name(request: &Request, new: &str) -> Result<(), String> {
    if TokenKind::KEYWORDS.contains(&new) {
        return Err(format!("`{new}` is a keyword"));
    }
    let lexed = lex(FileId(0), new, &mut Problems::new());
    let is_name = matches!(lexed.tokens.as_slice(), [one, rest @ ..]
        if one.kind == TokenKind::Ident && one.start == 0 && one.end as usize == new.len()
            && rest.iter().all(|t| t.start as usize >= new.len()));
    if !is_name {
        return Err(format!("`{new}` is not a name"));
    }
    if Session::default().is_of_language(request, new) {
        return Err(format!("`{new}` is a name of the language"));
    }
    Ok(())
}

/// A file or folder that gets another name.
struct Moved {
    from: PathBuf,
    to: PathBuf,
}

/// The file, or the folder, by whose name a class is found; none if it is not found by that.
fn moved(found: &Found, new: &str) -> Result<Option<Moved>, String> {
    if found.kind != FoundKind::Class {
        return Ok(None);
    }
    let is_own = |class: &Arc<crate::ir::ast::Class>| class.name.span.start == found.place.0;
    if !tree(&found.text).classes.iter().any(is_own) {
        return Ok(None);
    }
    let name_of = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (from, ending) = match name_of(&found.path).as_str() {
        "package.mo" => (found.path.parent().unwrap_or(Path::new("")).to_owned(), ""),
        _ => (found.path.clone(), ".mo"),
    };
    let own = name_of(&from);
    let Some(rest) = own.strip_prefix(&found.name) else { return Ok(None) };
    // `Valves 1.2`: a library and its version.
    if rest != ending && !(ending.is_empty() && rest.starts_with(' ')) {
        return Ok(None);
    }
    if new.starts_with('\'') {
        return Err(format!("`{new}` cannot be the name of a file"));
    }
    Ok(Some(Moved { to: from.with_file_name(format!("{new}{rest}")), from }))
}

/// A text with other words at some places, and these places afterwards.
fn changed(text: &str, places: &[(u32, u32)], new: &str) -> (String, Vec<(u32, u32)>) {
    let (mut out, mut after, mut last) = (String::new(), Vec::new(), 0);
    let mut sorted = places.to_vec();
    sorted.sort_unstable();
    for (start, end) in sorted {
        out.push_str(&text[last..start as usize]);
        after.push((out.len() as u32, (out.len() + new.len()) as u32));
        out.push_str(new);
        last = end as usize;
    }
    out.push_str(&text[last..]);
    (out, after)
}

/// Compares the meanings of words before and after the edits.
fn try_out(
    workspace: &Workspace,
    all: &Referred,
    new: &str,
    moved: Option<&Moved>,
) -> Result<(), String> {
    let path_of = |path: &Path| match moved {
        Some(moved) if moved.from == path => moved.to.clone(),
        _ => path.to_owned(),
    };
    let mut texts: BTreeMap<PathBuf, Arc<str>> = BTreeMap::new();
    for file in &all.files {
        let text = changed(&file.text, &file.occurrences.places, new).0;
        texts.insert(path_of(&file.path), text.into());
    }
    let after = Workspace { open: workspace.open.with(texts), ..workspace.clone() };
    let declared = all.files.iter().find(|file| file.path == all.found.path);
    let declared = declared.map_or(&[][..], |file| &file.occurrences.places);
    let shift = |at: u32| {
        let before = declared.iter().filter(|(start, _)| *start < at).count() as i64;
        (i64::from(at) + before * (new.len() as i64 - all.found.name.len() as i64)) as u32
    };
    let start = shift(all.found.place.0);
    let found = Found {
        name: new.to_owned(),
        path: path_of(&all.found.path),
        place: (start, start + new.len() as u32),
        ..all.found.clone()
    };
    let others = all.others.iter().map(|(path, text)| Referring {
        path: path.clone(),
        text: text.clone(),
        occurrences: Default::default(),
    });
    let others: Vec<Referring> = others.collect();
    for file in all.files.iter().chain(&others) {
        let (text, expected) = changed(&file.text, &file.occurrences.places, new);
        let path = path_of(&file.path);
        let request = after.request(&path, text.clone());
        let mut meanings = Session::default().occurrences_of(&request, &found).places;
        meanings.sort_unstable();
        let line = |at: u32| Lines::of(&text).line_character(at as usize).0 + 1;
        let shown = file.path.display();
        if let Some((at, _)) = expected.iter().find(|place| !meanings.contains(place)) {
            return Err(format!(
                "in {shown}, line {}, `{new}` already means something else",
                line(*at)
            ));
        }
        if let Some((at, _)) = meanings.iter().find(|place| !expected.contains(place)) {
            return Err(format!(
                "in {shown}, line {}, `{new}` means something else now, and would mean the renamed `{}`",
                line(*at),
                all.found.name
            ));
        }
        let before = workspace.request(&file.path, file.text.clone());
        let known = Session::default().declaration_errors(&before);
        let errors = Session::default().declaration_errors(&request);
        if errors.len() > known.len() {
            let first = errors.iter().find(|error| !known.contains(error));
            let first = first.map_or("it would have an error", String::as_str);
            return Err(format!("then in {shown}: {first}"));
        }
    }
    Ok(())
}

/// The edits as the protocol writes them, files that are renamed last.
fn edits(workspace: &Workspace, all: &Referred, new: &str, moved: Option<&Moved>) -> Json {
    let of = |file: &Referring| {
        let lines = Lines::of(&file.text);
        let edit = |place: &(u32, u32)| {
            Json::object([("range", lines.place(*place)), ("newText", Json::text(new))])
        };
        (
            workspace.address(&file.path),
            file.occurrences.places.iter().map(edit).collect::<Vec<_>>(),
        )
    };
    let mut changes: Vec<(String, Vec<Json>)> =
        all.files.iter().map(of).filter(|(_, edits)| !edits.is_empty()).collect();
    let Some(moved) = moved else {
        let changes = changes.into_iter().map(|(address, edits)| (address, Json::list(edits)));
        return Json::object([("changes", Json::object(changes))]);
    };
    changes.extend(order(workspace, moved, &all.found.name, new));
    let mut steps: Vec<Json> = Vec::new();
    for (address, edits) in changes {
        let document = [("uri", Json::text(address)), ("version", Json::null())];
        let edit = [("textDocument", Json::object(document)), ("edits", Json::list(edits))];
        steps.push(Json::object(edit));
    }
    let from = match workspace.addresses.get(&moved.from) {
        Some(address) => address.clone(),
        None => address_of(&moved.from),
    };
    // The new address is next to the old one, as the client writes it.
    let name = address_of(Path::new(moved.to.file_name().unwrap_or_default()));
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let to = format!("{folder}/{}", name.trim_start_matches("file:///"));
    steps.push(Json::object([
        ("kind", Json::text("rename")),
        ("oldUri", Json::text(from)),
        ("newUri", Json::text(to)),
    ]));
    Json::object([("documentChanges", Json::list(steps))])
}

/// The edit of the list of classes in the folder of a package.
fn order(
    workspace: &Workspace,
    moved: &Moved,
    old: &str,
    new: &str,
) -> Option<(String, Vec<Json>)> {
    let path = moved.from.with_file_name("package.order");
    let text = workspace.text(&path)?;
    let lines = Lines::of(&text);
    let at = text.lines().position(|line| line.trim() == old)?;
    let start = lines.offset(at, 0) + text.lines().nth(at)?.find(old)?;
    let range = lines.range(start, start + old.len());
    let edit = Json::object([("range", range), ("newText", Json::text(new))]);
    Some((workspace.address(&path), vec![edit]))
}
