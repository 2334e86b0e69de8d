//! The state of files, to notice when one is saved.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Folders below a folder that are looked into.
const DEEPEST: usize = 4;
/// Files that are looked at.
const MOST: usize = 5000;
/// Extensions of files that models and plans are made of.
const EXTENSIONS: [&str; 6] = ["mo", "mol", "toml", "csv", "txt", "mat"];

/// When a file was written last, and its size in bytes.
pub type Stamp = (PathBuf, Option<SystemTime>, u64);

/// The states of files, and of those in folders; files that are not there are left out.
pub fn stamps(places: &[PathBuf]) -> Vec<Stamp> {
    let mut out = Vec::new();
    for place in places {
        add(place, 0, &mut out);
    }
    out.sort();
    out.dedup();
    out
}

fn add(place: &Path, depth: usize, out: &mut Vec<Stamp>) {
    let Ok(found) = std::fs::metadata(place) else { return };
    if out.len() >= MOST {
        return;
    }
    if found.is_file() {
        out.push((place.to_owned(), found.modified().ok(), found.len()));
        return;
    }
    let Ok(entries) = std::fs::read_dir(place) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        let is_folder = entry.file_type().is_ok_and(|t| t.is_dir());
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let counts = extension.is_some_and(|e| EXTENSIONS.contains(&e.as_str()));
        if !is_hidden && (is_folder && depth < DEEPEST || !is_folder && counts) {
            add(&path, depth + 1, out);
        }
    }
}
