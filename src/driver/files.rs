//! The origin of sources: folders on disk and the library in the binary. Nothing else reads files of
//! models. The pages that explain diagnostics are in the binary as well.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use include_dir::{Dir, DirEntry, include_dir};

use super::compile::Request;
use super::neighbours::Neighbours;
use super::open_texts::{OpenTexts, canonical};
use crate::base::index::FastMap;
use crate::external::component::Component;
use crate::fmu::import::component;
use crate::ir::ast;
use crate::resolve::library::Folder;
use crate::resolve::version::of_entry;

/// The shipped library.
static SHIPPED: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/lib");

/// The shipped library by path: `Dir::get_entry` compares the paths of all entries.
static SHIPPED_ENTRIES: LazyLock<FastMap<&'static Path, &'static DirEntry<'static>>> =
    LazyLock::new(|| {
        let mut all = FastMap::default();
        let mut waiting = vec![&SHIPPED];
        while let Some(dir) = waiting.pop() {
            all.extend(dir.entries().iter().map(|entry| (entry.path(), entry)));
            waiting.extend(dir.dirs());
        }
        all
    });

/// The pages that explain diagnostics.
static ERROR_PAGES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/docs/errors");

/// The projects that `mocc new` starts from, a folder each.
static TEMPLATES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/examples/templates");

/// The files of a template, relative to the folder of the project; none if there is no such template.
pub fn template(name: &str) -> Vec<(&'static Path, &'static [u8])> {
    let Some(dir) = TEMPLATES.get_dir(name) else { return Vec::new() };
    let mut out = Vec::new();
    let mut waiting = vec![dir];
    while let Some(folder) = waiting.pop() {
        waiting.extend(folder.dirs());
        let file = |f: &'static include_dir::File<'static>| {
            Some((f.path().strip_prefix(name).ok()?, f.contents()))
        };
        out.extend(folder.files().filter_map(file));
    }
    out.sort_unstable();
    out
}

/// True for the name of a package that is shipped, which a class at the top level would hide.
pub fn is_shipped(package: &str) -> bool {
    shipped_dir(Path::new(package)).is_some()
}

fn shipped_dir(path: &Path) -> Option<&'static Dir<'static>> {
    SHIPPED_ENTRIES.get(path)?.as_dir()
}

fn shipped_file(path: &Path) -> Option<&'static include_dir::File<'static>> {
    SHIPPED_ENTRIES.get(path)?.as_file()
}

/// The pages that explain diagnostics, by code: `("MO0201", "# MO0201: unknown class ...")`.
pub fn error_pages() -> Vec<(&'static str, &'static str)> {
    let page = |file: &'static include_dir::File<'static>| {
        let code = file.path().file_stem()?.to_str().filter(|name| name.starts_with("MO"))?;
        Some((code, file.contents_utf8()?))
    };
    let mut all: Vec<_> = ERROR_PAGES.files().filter_map(page).collect();
    all.sort_unstable();
    all
}

/// The library in the binary.
pub struct Shipped;

impl Folder for Shipped {
    fn entries(&self, path: &Path) -> Vec<String> {
        let dir = if path.as_os_str().is_empty() { Some(&SHIPPED) } else { shipped_dir(path) };
        let Some(dir) = dir else { return Vec::new() };
        let name = |p: &Path| p.file_name().map(|n| n.to_string_lossy().into_owned());
        let mut all: Vec<String> =
            dir.dirs().filter_map(|d| name(d.path()).map(|n| n + "/")).collect();
        all.extend(dir.files().filter_map(|f| name(f.path())));
        all.sort();
        all
    }

    fn read(&self, path: &Path) -> Option<Result<String, String>> {
        let file = shipped_file(path)?;
        Some(file.contents_utf8().map(str::to_string).ok_or_else(|| "not UTF-8".to_string()))
    }

    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>> {
        let inside = path.strip_prefix("lib").unwrap_or(path);
        shipped_file(inside).map(|f| Ok(f.contents().to_vec()))
    }

    fn display(&self, path: &Path) -> PathBuf {
        Path::new("lib").join(path)
    }
}

/// Why a data file is not read.
const OUTSIDE: &str = "it is outside of the folders of the model and its libraries; \
                       allow it with `--allow-read DIR`";

/// Data files by the names that the model gives them, within bounds; contains no classes. A model of
/// somebody else must not reach files that its user never meant to show.
pub struct AsNamed {
    /// The folder of the model's file: everything in it but hidden files.
    own: Option<PathBuf>,
    /// Folders that the user allows.
    allowed: Vec<PathBuf>,
    /// FMUs, or folders with FMUs, whose code the user allows to run.
    fmus: Vec<PathBuf>,
}

/// Why an FMU in a model is not loaded.
const FOREIGN: &str = "an FMU is foreign code, which can do whatever you can do; \
                       if you trust it, allow it with `--allow-fmu FILE`";

impl AsNamed {
    fn allows(&self, file: &Path) -> bool {
        let Ok(file) = file.canonicalize() else { return false };
        let within = |folder: &PathBuf| {
            let folder = folder.canonicalize().ok()?;
            file.strip_prefix(folder).ok().map(Path::to_path_buf)
        };
        self.own.as_ref().and_then(within).is_some_and(|inside| !is_hidden(&inside))
            || self.allowed.iter().any(|folder| within(folder).is_some())
    }
}

/// True for a path with a part that begins with a dot: settings and keys are kept there.
fn is_hidden(path: &Path) -> bool {
    path.iter().any(|part| part.to_string_lossy().starts_with('.'))
}

impl AsNamed {
    /// The file of an FMU: relative to the folder of the model, else to the working directory.
    fn fmu(&self, path: &Path) -> Result<PathBuf, String> {
        let beside = self.own.as_ref().map(|own| own.join(path)).filter(|file| file.is_file());
        let file = beside.unwrap_or_else(|| path.to_path_buf());
        file.canonicalize().map_err(|e| e.to_string())?;
        if allows_fmu(&self.fmus, &file) { Ok(file) } else { Err(FOREIGN.to_owned()) }
    }
}

/// Whether FMUs that the user allows, or folders with such, have this one.
pub fn allows_fmu(allowed: &[PathBuf], file: &Path) -> bool {
    let Ok(file) = file.canonicalize() else { return false };
    allowed.iter().any(|a| a.canonicalize().is_ok_and(|a| file.starts_with(a)))
}

impl Folder for AsNamed {
    fn entries(&self, _: &Path) -> Vec<String> {
        Vec::new()
    }

    fn read(&self, _: &Path) -> Option<Result<String, String>> {
        None
    }

    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>> {
        path.is_file().then(|| {
            if !self.allows(path) {
                return Err(OUTSIDE.to_owned());
            }
            std::fs::read(path).map_err(|e| e.to_string())
        })
    }

    fn component(&self, path: &Path, token: &str) -> Option<Result<Arc<dyn Component>, String>> {
        let opened = self.fmu(path).and_then(|file| component::open(&file, token));
        Some(opened.map(|component| Arc::new(component) as Arc<dyn Component>))
    }

    fn display(&self, path: &Path) -> PathBuf {
        path.to_path_buf()
    }
}

/// A folder on disk. Its data files are those of the packages in it.
pub struct OnDisk {
    /// The folder.
    pub folder: PathBuf,
    /// Texts that go before the files.
    pub open: OpenTexts,
}

impl OnDisk {
    /// A folder whose files no editor holds.
    pub fn new(folder: PathBuf) -> OnDisk {
        OnDisk { folder, open: OpenTexts::default() }
    }

    /// The package in this folder that a file belongs to.
    fn package_of(&self, file: &Path) -> Option<PathBuf> {
        let file = file.canonicalize().ok()?;
        let entries = std::fs::read_dir(if self.folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            &self.folder
        });
        let folders = entries.ok()?.flatten().map(|entry| entry.path());
        let packages = folders.filter(|folder| folder.join("package.mo").is_file());
        packages
            .filter_map(|p| p.canonicalize().ok())
            .find(|package| file.strip_prefix(package).is_ok_and(|inside| !is_hidden(inside)))
    }
}

impl Folder for OnDisk {
    fn entries(&self, path: &Path) -> Vec<String> {
        let folder = self.folder.join(path);
        // The working directory has no name here.
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        let list = std::fs::read_dir(folder).into_iter().flatten();
        let mut all: Vec<String> = list
            .flatten()
            .map(|e| {
                let name = e.file_name().to_string_lossy().into_owned();
                if e.path().is_dir() { name + "/" } else { name }
            })
            .collect();
        all.extend(self.open.names_in(folder));
        all.sort();
        all.dedup();
        all
    }

    fn read(&self, path: &Path) -> Option<Result<String, String>> {
        let full = self.folder.join(path);
        if let Some(text) = self.open.of(&full) {
            return Some(Ok(text.to_string()));
        }
        if !full.is_file() {
            return None;
        }
        Some(read(&full))
    }

    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>> {
        // The path may be that of `display`, which begins with this folder.
        let full =
            Some(self.folder.join(path)).filter(|f| f.is_file()).unwrap_or_else(|| path.into());
        full.is_file().then(|| match self.package_of(&full) {
            Some(_) => std::fs::read(full).map_err(|e| e.to_string()),
            None => Err(OUTSIDE.to_owned()),
        })
    }

    fn display(&self, path: &Path) -> PathBuf {
        self.folder.join(path)
    }
}

/// The names of the classes and packages in a folder, as its files tell. Errors: why it cannot be searched.
pub fn top_level(folder: &Path) -> Result<Vec<String>, String> {
    let why = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => "there is no such folder".to_owned(),
        std::io::ErrorKind::NotADirectory => "it is not a folder".to_owned(),
        _ => e.to_string(),
    };
    std::fs::read_dir(folder).map_err(why)?;
    let entries = OnDisk::new(folder.to_owned()).entries(Path::new(""));
    if entries.iter().any(|e| e == "package.mo") {
        return Err("it is a package itself, so name the folder that contains it".to_owned());
    }
    let name =
        |e: &String| e.strip_suffix('/').or_else(|| e.strip_suffix(".mo")).map(str::to_owned);
    Ok(entries.iter().filter_map(name).filter(|e| !e.contains('.')).collect())
}

/// The tables, .csv, in a folder, sorted by name. The error is a message.
pub fn tables(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let list =
        std::fs::read_dir(folder).map_err(|e| format!("cannot read {}: {e}", folder.display()))?;
    let mut all: Vec<PathBuf> = list.flatten().map(|entry| entry.path()).collect();
    all.retain(|path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")));
    all.sort();
    Ok(all)
}

/// The text of a file, or the reason why it cannot be read.
pub fn read(path: &Path) -> Result<String, String> {
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    String::from_utf8(bytes).map_err(|e| {
        format!("byte {} is not UTF-8; save the file as UTF-8", e.utf8_error().valid_up_to())
    })
}

/// The location of the library that a file belongs to.
pub struct Home {
    /// The folder that contains the library.
    pub root: Box<dyn Folder>,
    /// The folder in it whose `package.mo` the file is.
    pub package: Option<PathBuf>,
}

/// The library of a file that is a `package.mo`, or that lies in the folders of the package named by its
/// `within` clause (section 13.4.1 of the specification).
pub fn home(file: &Path, within: Option<&ast::Path>, open: &OpenTexts) -> Option<Home> {
    let full = match open.is_editor() {
        // A new file may not be on disk yet.
        true => canonical(file),
        false => file.canonicalize().ok()?,
    };
    let own = full.parent()?;
    let is_package = full.file_name()? == "package.mo";
    if within.is_none() && !is_package {
        return None;
    }
    // The folder of the library itself may have another name: a copy, or a version.
    let mut root = if is_package { own.parent()? } else { own };
    for (k, package) in within.map_or(&[][..], |w| &w.parts).iter().enumerate().rev() {
        let folder = root.file_name()?.to_string_lossy().into_owned() + "/";
        let version = of_entry(&folder, &package.name);
        let named = version.is_some_and(|version| k == 0 || version.is_empty());
        if !named || !root.join("package.mo").is_file() {
            return None;
        }
        root = root.parent()?;
    }
    let package =
        is_package.then(|| own.strip_prefix(root).map(Path::to_path_buf)).transpose().ok()?;
    // Messages show paths relative to the working directory; an editor opens them.
    let here = std::env::current_dir().ok().filter(|_| !open.is_editor());
    let shown = here.and_then(|here| root.strip_prefix(here).ok());
    let folder = shown.unwrap_or(root).to_path_buf();
    Some(Home { root: Box::new(OnDisk { folder, open: open.clone() }), package })
}

/// The folders of the value of `MODELICAPATH`.
pub fn folders_of(modelica_path: Option<&OsStr>) -> Vec<PathBuf> {
    let all = modelica_path.into_iter().flat_map(std::env::split_paths);
    all.filter(|folder| !folder.as_os_str().is_empty()).collect()
}

/// The value of `MODELICAPATH` without links and `..`.
pub fn canonical_folders(modelica_path: Option<&OsStr>) -> Option<OsString> {
    let all = folders_of(modelica_path).into_iter().map(|folder| canonical(&folder));
    std::env::join_paths(all).ok().filter(|path| !path.is_empty())
}

/// Folders to search: those that a request names, in memory or on disk, then that of the model, then those of
/// `MODELICAPATH`, then the shipped library.
pub fn folders(request: &Request) -> Vec<Box<dyn Folder>> {
    let folder_of = |file: &PathBuf| {
        let parent = file.parent().filter(|p| !p.as_os_str().is_empty());
        parent.map_or_else(|| PathBuf::from("."), Path::to_path_buf)
    };
    let own = request.file.as_ref().map(folder_of);
    let neighbours: Option<Box<dyn Folder>> = match &own {
        None => None,
        Some(own) => match request.packed.folder(own) {
            Some(packed) => Some(Box::new(packed)),
            None => {
                let found =
                    request.file.as_deref().and_then(|file| Neighbours::of(file, &request.open));
                found.map(|found| -> Box<dyn Folder> { Box::new(found) })
            }
        },
    };
    let mut all: Vec<Box<dyn Folder>> = vec![Box::new(AsNamed {
        own,
        allowed: request.readable.clone(),
        fmus: request.fmus.clone(),
    })];
    for path in &request.folders {
        match request.packed.folder(path) {
            Some(packed) => all.push(Box::new(packed)),
            None => all.push(Box::new(OnDisk { folder: path.clone(), open: request.open.clone() })),
        }
    }
    all.extend(neighbours);
    for path in folders_of(request.modelica_path.as_deref()) {
        all.push(Box::new(OnDisk { folder: path, open: request.open.clone() }));
    }
    all.push(Box::new(Shipped));
    all
}

/// The bytes of a shared library that is copied into an archive.
pub fn read_library(path: &Path) -> std::io::Result<Vec<u8>> {
    std::fs::read(path)
}

/// What a file is for that is no file of models, by its extension; `None` for any other.
pub(super) fn other_kind(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    match extension.as_str() {
        "toml" => Some(
            "a plan is for `mocc calibrate`, `diagnose`, `evaluate` and `optimize`, a test file for `mocc test`",
        ),
        "csv" | "mat" | "parquet" => {
            Some("`mocc plot` draws a table, and `mocc compare` compares two")
        }
        "html" | "svg" | "png" | "json" => Some("name the file that contains the model"),
        _ => None,
    }
}
