//! The files of a client: those that are open, and those of its folders that may refer to a declaration.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::driver::compile::{Request, Session};
use crate::driver::files::{folders_of, read};
use crate::driver::lookup::{Found, Occurrences};
use crate::driver::open_texts::{OpenTexts, canonical};
use crate::driver::project::{self, NAME};
use crate::driver::sources::{is_modelica, modelica_files};

use super::position::address_of;

/// What an answer is computed from: it stays the same while the client goes on typing.
#[derive(Clone, Default)]
pub struct Workspace {
    /// The texts of the client.
    pub open: OpenTexts,
    /// The addresses that the client has for its open files, by their paths without links.
    pub addresses: Arc<BTreeMap<PathBuf, String>>,
    /// The folders that the client works in.
    pub folders: Arc<Vec<PathBuf>>,
    /// The value of `MODELICAPATH`, without links.
    pub modelica_path: Option<OsString>,
    /// The client renames files.
    pub renames_files: bool,
}

impl Workspace {
    /// The request that compiles a text.
    pub fn request(&self, file: &Path, text: String) -> Request {
        let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
        let project = project::of(Some(file), &mut sources, &mut problems);
        let folders = |all: Vec<PathBuf>| -> Vec<PathBuf> {
            all.iter().map(|folder| canonical(folder)).filter(|folder| folder.is_dir()).collect()
        };
        Request {
            text: Some(text),
            folders: folders(project.libraries),
            readable: folders(project.allow_read),
            modelica_path: self.modelica_path.clone(),
            open: self.open.clone(),
            ..Request::new(Some(file.to_owned()), None)
        }
    }

    /// The text of a file: that of the client before that on disk.
    pub fn text(&self, file: &Path) -> Option<String> {
        self.open.of(file).map(|text| text.to_string()).or_else(|| read(file).ok())
    }

    /// The address of a file: the one that the client has for it.
    pub fn address(&self, file: &Path) -> String {
        let known = self.addresses.get(file).or_else(|| self.addresses.get(&canonical(file)));
        known.cloned().unwrap_or_else(|| address_of(file))
    }
}

/// A file with the places in it that refer to a declaration.
#[derive(Clone, PartialEq, Debug)]
pub struct Referring {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// The places, and those that may be.
    pub occurrences: Occurrences,
}

/// The files that refer to a declaration, or have a word in common with it.
pub struct Referred {
    /// The declaration.
    pub found: Found,
    /// The files with its name, that of the request first.
    pub files: Vec<Referring>,
    /// Files that have the other word that was looked for, but not its name.
    pub others: Vec<(PathBuf, String)>,
    /// All files were looked at.
    pub is_complete: bool,
}

/// All files that refer to the declaration of the name at `offset`. `word` is another name whose files are listed. None if
/// there is no declaration, or if the answer is no longer wanted.
pub fn referring(
    workspace: &Workspace,
    request: &Request,
    offset: usize,
    word: Option<&str>,
    is_cancelled: &AtomicBool,
) -> Option<Referred> {
    let own = request.file.clone()?;
    let (mut found, occurrences) = Session::default().occurrences(request, offset as u32)?;
    if found.path.is_file() {
        found.path = canonical(&found.path);
    }
    let text = request.text.clone().unwrap_or_default();
    let mut out = vec![Referring { path: own.clone(), text, occurrences }];
    let (files, is_complete) = files(workspace, request, &own, &found.path);
    let mut others = Vec::new();
    for path in files {
        if is_cancelled.load(Ordering::Relaxed) {
            return None;
        }
        let Some(text) = workspace.text(&path) else { continue };
        if !text.contains(&found.name) {
            if word.is_some_and(|word| text.contains(word)) {
                others.push((path, text));
            }
            continue;
        }
        let other = workspace.request(&path, text.clone());
        let occurrences = Session::default().occurrences_of(&other, &found);
        out.push(Referring { path, text, occurrences });
    }
    Some(Referred { found, files: out, others, is_complete })
}

/// The Modelica files that may see a declaration, but not the text itself; and whether these are all.
fn files(
    workspace: &Workspace,
    request: &Request,
    own: &Path,
    declared: &Path,
) -> (BTreeSet<PathBuf>, bool) {
    let open = workspace.open.paths().filter(|file| is_modelica(file) && file.is_absolute());
    let (mut places, mut flat) = (Vec::new(), Vec::new());
    for file in [own, declared].into_iter().chain(open.map(PathBuf::as_path)) {
        match root(file) {
            _ if !file.is_file() && file != own => {}
            Some(root) => places.push(root),
            None => flat.extend(file.parent().map(Path::to_owned)),
        }
    }
    flat.retain(|folder| !folder.as_os_str().is_empty());
    places.extend(request.folders.iter().cloned());
    places.extend(workspace.folders.iter().cloned());
    // Libraries see each other, but not a model of the user.
    let libraries = folders_of(workspace.modelica_path.as_deref());
    if libraries.iter().any(|folder| declared.starts_with(folder)) {
        places.extend(libraries);
    }
    let mut all = modelica_files(&places, &flat);
    all.files.extend(workspace.open.paths().filter(|file| is_modelica(file)).cloned());
    all.files.remove(own);
    (all.files, all.is_complete)
}

/// The folder of a project: that of its settings, or around its package. None for a file in any other folder.
pub fn root(file: &Path) -> Option<PathBuf> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty())?;
    let project = folder.ancestors().find(|f| f.join(NAME).is_file());
    let package = || folder.ancestors().take_while(|f| f.join("package.mo").is_file()).last();
    project.or_else(package).map(Path::to_owned)
}
