//! Test files in folders, and the files that they compare with.

use std::fs;
use std::path::{Path, PathBuf};

use super::annotation::may_hold_tests;

/// The end of the name of each test file.
pub const EXTENSION: &str = ".test.toml";

/// The files with tests of a path: itself, or those in a folder and the folders in it, sorted. Hidden folders are skipped.
/// The error is a message.
pub fn discover(path: &Path) -> Result<Vec<PathBuf>, String> {
    let data = fs::metadata(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    if data.is_file() {
        return match () {
            () if is_test(path) => Ok(vec![path.to_owned()]),
            () if is_model(path) => Ok(of_model(path)),
            () => Err(format!(
                "{} is neither a test file, `NAME{EXTENSION}`, nor a model with tests, `.mo` or `.mol`",
                path.display()
            )),
        };
    }
    let mut found = Vec::new();
    search(path, &mut found);
    found.sort();
    Ok(found)
}

/// The test file next to a model, and the model itself if it has tests or nothing else has.
fn of_model(path: &Path) -> Vec<PathBuf> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let beside = Some(path.with_file_name(format!("{stem}{EXTENSION}"))).filter(|p| exists(p));
    let own = (beside.is_none() || mentions_tests(path)).then(|| path.to_owned());
    beside.into_iter().chain(own).collect()
}

fn search(folder: &Path, found: &mut Vec<PathBuf>) {
    // A folder that may not be read has no tests of this user.
    let Ok(list) = fs::read_dir(folder) else { return };
    for entry in list.flatten() {
        let path = entry.path();
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        // A link to a folder may lead back to where it is.
        if entry.file_type().is_ok_and(|t| t.is_dir()) && !is_hidden {
            search(&path, found);
        } else if path.is_file() && (is_test(&path) || is_model(&path) && mentions_tests(&path)) {
            found.push(path);
        }
    }
}

/// Whether a file is a test file.
pub fn is_test(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(EXTENSION))
}

fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "mo" || extension == "mol")
}

fn mentions_tests(path: &Path) -> bool {
    fs::read_to_string(path).is_ok_and(|source| may_hold_tests(&source))
}

/// The name of a test file without its extension: `valve52` of `examples/valve52.test.toml`.
pub fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    name.strip_suffix(EXTENSION).unwrap_or(&name).to_owned()
}

/// The text of a file; none if there is no such file. The error is a message.
pub fn text(path: &Path) -> Result<Option<String>, String> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(format!("cannot read {}: {e}", path.display())),
    }
}

/// Whether there is a file of this name.
pub fn exists(path: &Path) -> bool {
    path.is_file()
}

/// The files of a folder, sorted; none if there is no such folder.
pub fn inside(folder: &Path) -> Vec<PathBuf> {
    let list = fs::read_dir(folder).map(|l| l.flatten().map(|e| e.path()).collect());
    let mut all: Vec<PathBuf> = list.unwrap_or_default();
    all.retain(|path| path.is_file());
    all.sort();
    all
}
