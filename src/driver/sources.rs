//! The files of models in folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::open_texts::canonical;

/// Files and folders that are looked at.
const MOST: usize = 200_000;

/// The Modelica files in folders.
pub struct Sources {
    /// The files, without links and `..`, in order.
    pub files: BTreeSet<PathBuf>,
    /// All folders were looked into.
    pub is_complete: bool,
}

/// The Modelica files in folders and below them; of those in `flat`, whose other contents may be anything, only the
/// packages are looked into. Folders whose names begin with a dot are left out.
pub fn modelica_files(folders: &[PathBuf], flat: &[PathBuf]) -> Sources {
    let mut out = Sources { files: BTreeSet::new(), is_complete: true };
    let mut known = BTreeSet::new();
    let with = |is_flat: bool| move |folder: &PathBuf| (canonical(folder), is_flat);
    // The last is looked into first: a folder that is in both lists is not flat.
    let mut waiting: Vec<(PathBuf, bool)> = flat.iter().map(with(true)).collect();
    waiting.extend(folders.iter().map(with(false)));
    let mut seen = 0;
    while let Some((folder, is_flat)) = waiting.pop() {
        // A link may lead back.
        if !known.insert(folder.clone()) {
            continue;
        }
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            seen += 1;
            if seen > MOST {
                out.is_complete = false;
                return out;
            }
            let path = entry.path();
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            let is_link = entry.file_type().is_ok_and(|t| t.is_symlink());
            let path = if is_link { canonical(&path) } else { path };
            if path.is_dir() {
                if !is_flat || path.join("package.mo").is_file() {
                    waiting.push((path, false));
                }
            } else if is_modelica(&path) {
                out.files.insert(path);
            }
        }
    }
    out
}

/// Whether a file has models, by its extension.
pub fn is_modelica(file: &Path) -> bool {
    file.extension().is_some_and(|e| e == "mo" || e == "mol")
}
