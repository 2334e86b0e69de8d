//! The other files that may refer to a declaration: those of the project, of its libraries, and those that are open.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::driver::compile::{Request, Session};
use crate::driver::files::read;
use crate::driver::lookup::Found;
use crate::driver::project::NAME;
use crate::driver::stamps::stamps;

/// A file with the places in it that refer to a declaration.
#[derive(Clone, PartialEq, Debug)]
pub struct Referring {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// The places, bytes.
    pub places: Vec<(u32, u32)>,
}

/// All files that refer to the declaration of the name at `offset`, the text of the request first. `open` are the texts of
/// the client, which go before those on disk.
pub fn referring(
    request: &Request,
    offset: usize,
    open: &BTreeMap<PathBuf, String>,
) -> Option<(Found, Vec<Referring>)> {
    let own = request.file.clone()?;
    let (mut found, places) = Session::default().occurrences(request, offset as u32)?;
    // Other sessions may name it from elsewhere.
    found.path = std::path::absolute(&found.path).unwrap_or(found.path);
    let text = request.text.clone().unwrap_or_default();
    let mut out = vec![Referring { path: own.clone(), text, places }];
    for path in files(request, &own, &found.path, open) {
        let text = open.get(&path).cloned().or_else(|| read(&path).ok());
        let Some(text) = text.filter(|text| text.contains(&found.name)) else { continue };
        let other =
            Request { file: Some(path.clone()), text: Some(text.clone()), ..request.clone() };
        let places = Session::default().occurrences_of(&other, &found);
        if !places.is_empty() {
            out.push(Referring { path, text, places });
        }
    }
    Some((found, out))
}

/// The Modelica files of the project and of its libraries, but not the text itself.
fn files(
    request: &Request,
    own: &Path,
    declared: &Path,
    open: &BTreeMap<PathBuf, String>,
) -> Vec<PathBuf> {
    let mut places = vec![root(own)];
    if declared.is_file() {
        places.push(root(declared));
    }
    places.extend(request.folders.iter().cloned());
    let absolute = |path: PathBuf| std::path::absolute(&path).unwrap_or(path);
    let mut all: Vec<PathBuf> = stamps(&places).into_iter().map(|s| absolute(s.0)).collect();
    all.extend(open.keys().cloned());
    all.retain(|path| path.extension().is_some_and(|e| e == "mo" || e == "mol") && path != own);
    all.sort();
    all.dedup();
    all
}

/// The folder of a project: that of its settings, or around its package, or of the file.
pub fn root(file: &Path) -> PathBuf {
    let folder = file.parent().unwrap_or(Path::new("")).to_owned();
    if let Some(project) = folder.ancestors().find(|f| f.join(NAME).is_file()) {
        return project.to_owned();
    }
    let package = folder.ancestors().take_while(|f| f.join("package.mo").is_file()).last();
    package.map_or(folder.clone(), Path::to_owned)
}
