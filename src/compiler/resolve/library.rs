//! All classes that a compilation can access, loaded on demand.
//!
//! A package is one file or a folder with `package.mo` (Modelica 3.6, section 13.4). Files that no
//! model refers to are never opened.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems};
use crate::base::index::FastMap;
use crate::base::name::{Name, name};
use crate::base::source::{SourceMap, Span};
use crate::external::component::Component;
use crate::ir::ast;

use super::cause::LibraryCause;
use super::version::{self, UsesEntry};

/// A tree of folders with packages: a folder on disk or the library embedded in the binary.
pub trait Folder {
    /// Names in a folder, sorted; empty if the folder does not exist. Names of folders end with
    /// `/`.
    fn entries(&self, path: &Path) -> Vec<String>;
    /// The source in a file; `None` if the file does not exist.
    fn read(&self, path: &Path) -> Option<Result<String, String>>;
    /// A data file, at the path itself or in this folder; `None` if the file does not exist, an
    /// error if it cannot be read or lies outside of what a model may read.
    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>>;
    /// The foreign model in an FMU, if this folder decides about it; an error if it may not or cannot be used.
    fn component(&self, _path: &Path, _token: &str) -> Option<Result<Arc<dyn Component>, String>> {
        None
    }
    /// The path that diagnostics show for a file.
    fn display(&self, path: &Path) -> PathBuf;
}

/// The accessible classes.
pub struct Library {
    files: Vec<Arc<ast::Class>>,
    folders: Vec<Box<dyn Folder>>,
    top_level: FastMap<Name, Option<Arc<ast::Class>>>,
    /// The location of packages that are folders: full name to (folder, path).
    packages: FastMap<Name, (usize, PathBuf)>,
    children: FastMap<(Name, Name), Option<Arc<ast::Class>>>,
    /// Required versions of libraries; the first requirement counts.
    uses: FastMap<Name, UsesEntry>,
}

impl Library {
    /// A library of the given folders, searched in order.
    pub fn new(folders: Vec<Box<dyn Folder>>) -> Self {
        Library {
            files: Vec::new(),
            folders,
            top_level: FastMap::default(),
            packages: FastMap::default(),
            children: FastMap::default(),
            uses: FastMap::default(),
        }
    }

    /// Adds the library that a file of the user belongs to, before all others: the folder that
    /// contains the file and, if the file is a `package.mo`, the path of that package within it.
    pub fn add_home(&mut self, root: Box<dyn Folder>, package: Option<PathBuf>, file: &ast::File) {
        self.folders.insert(0, root);
        self.packages.values_mut().for_each(|(folder, _)| *folder += 1);
        if let (Some(path), Some(class)) = (package, file.classes.first()) {
            let full_name = match file.package() {
                Some(package) => format!("{package}.{}", class.name.name),
                None => class.name.name.to_string(),
            };
            self.packages.insert(name(&full_name), (0, path));
        }
    }

    /// Adds the classes of a file given by the user; they hide libraries of the same name.
    pub fn add_file(&mut self, file: &ast::File, problems: &mut Problems) {
        for class in &file.classes {
            if let Some(before) = self.files.iter().find(|c| c.name.name == class.name.name) {
                let cause = LibraryCause::DuplicateClass { name: class.name.name.to_string() };
                problems.push(
                    Diagnostic::new(cause, class.name.span)
                        .label("second definition")
                        .also(before.name.span, "first definition"),
                );
                continue;
            }
            self.record_uses(class);
            if let Some(package) = file.package() {
                // A class of a package, opened on its own: it is also accessible by its simple
                // name.
                let key = (name(&package.to_string()), class.name.name);
                self.children.insert(key, Some(class.clone()));
            }
            self.files.push(class.clone());
        }
    }

    /// Classes of the user's files, in order.
    pub fn file_classes(&self) -> &[Arc<ast::Class>] {
        &self.files
    }

    /// The top-level class with this name.
    pub fn top(
        &mut self,
        wanted: Name,
        sources: &mut SourceMap,
        problems: &mut Problems,
    ) -> Option<Arc<ast::Class>> {
        if let Some(c) = self.files.iter().find(|c| c.name.name == wanted) {
            return Some(c.clone());
        }
        if let Some(known) = self.top_level.get(&wanted) {
            return known.clone();
        }
        let mut found = None;
        for (k, version) in self.candidates(wanted) {
            let stem = match version.is_empty() {
                true => wanted.to_string(),
                false => format!("{wanted} {version}"),
            };
            let opened = self.open(k, Path::new(""), &stem, &wanted, wanted, sources, problems);
            if let Some(class) = opened {
                self.check_version(&class, &version, problems);
                self.record_uses(&class);
                found = Some(class);
                break;
            }
        }
        self.top_level.insert(wanted, found.clone());
        found
    }

    /// The possible locations of a library, by folder and version, best first: the required
    /// version, else the newest version in the first folder that has any.
    fn candidates(&self, library: Name) -> Vec<(usize, String)> {
        let mut all = Vec::new();
        for (k, folder) in self.folders.iter().enumerate() {
            let entries = folder.entries(Path::new(""));
            let of = |e: &String| version::of_entry(e, &library).map(str::to_string);
            let mut versions: Vec<String> = entries.iter().filter_map(of).collect();
            versions.sort_by(|a, b| version::compare(b, a));
            versions.dedup();
            all.extend(versions.into_iter().map(|v| (k, v)));
        }
        if let Some(wanted) = self.uses.get(&library) {
            all.sort_by_key(|(_, v)| match v.as_str() {
                v if *v == *wanted.version => 0,
                // It may be that version by its annotation.
                "" => 1,
                _ => 2,
            });
        }
        all
    }

    fn record_uses(&mut self, class: &ast::Class) {
        for one in version::uses(class) {
            self.uses.entry(one.library).or_insert(one);
        }
    }

    /// Warns if a library has another version than the required one, unless it declares itself
    /// compatible.
    fn check_version(&self, class: &ast::Class, of_entry: &str, problems: &mut Problems) {
        let Some(wanted) = self.uses.get(&class.name.name) else { return };
        let found = version::declared_version(class).unwrap_or_else(|| of_entry.into());
        if found.is_empty()
            || found == wanted.version
            || version::is_compatible_with(class, &wanted.version)
        {
            return;
        }
        let library = wanted.library.to_string();
        let required = wanted.version.to_string();
        let cause = LibraryCause::OtherVersion { library, required, found: found.to_string() };
        problems.push(Diagnostic::new(cause, wanted.span));
    }

    /// A class in a file of its own in the folder of package `full_name`.
    pub fn child(
        &mut self,
        full_name: Name,
        wanted: Name,
        sources: &mut SourceMap,
        problems: &mut Problems,
    ) -> Option<Arc<ast::Class>> {
        if let Some(known) = self.children.get(&(full_name, wanted)) {
            return known.clone();
        }
        let (folder, path) = self.packages.get(&full_name)?.clone();
        let qualified = name(&format!("{full_name}.{wanted}"));
        let found = self.open(folder, &path, &wanted, &wanted, qualified, sources, problems);
        self.children.insert((full_name, wanted), found.clone());
        found
    }

    /// Names of the classes in files of their own in the folder of a package, or of all top-level
    /// packages for an empty name: candidates for "did you mean".
    pub fn child_names(&self, full_name: &str) -> Vec<String> {
        let clean = |entries: Vec<String>| {
            entries
                .into_iter()
                .map(|e| e.trim_end_matches('/').trim_end_matches(".mo").to_string())
                .filter(|e| e != "package" && !e.contains('.'))
        };
        if full_name.is_empty() {
            let mut all: Vec<String> = self.files.iter().map(|c| c.name.name.to_string()).collect();
            for f in &self.folders {
                all.extend(clean(f.entries(Path::new(""))));
            }
            return all;
        }
        match self.packages.get(&name(full_name)) {
            Some((k, path)) => clean(self.folders[*k].entries(path)).collect(),
            None => Vec::new(),
        }
    }

    /// Resolves `modelica://Package/path` (Modelica 3.6, section 13.5); other file names are
    /// returned unchanged. `None` if the package does not exist.
    pub fn resource(&self, uri: &str) -> Option<PathBuf> {
        let Some(rest) = uri.strip_prefix("modelica://") else {
            let plain = uri.strip_prefix("file://").unwrap_or(uri);
            return Some(PathBuf::from(plain));
        };
        let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
        let (folder, root) = self.packages.get(&name(package))?;
        Some(self.folders[*folder].display(&root.join(path)))
    }

    /// The foreign model in an FMU with this token. The error says why it cannot be used.
    pub fn component(&mut self, path: &Path, token: &str) -> Result<Arc<dyn Component>, String> {
        let found = self.folders.iter().find_map(|folder| folder.component(path, token));
        found.unwrap_or_else(|| Err("FMUs cannot be used here".to_owned()))
    }

    /// The content of a data file.
    pub fn data(&self, path: &Path) -> Result<Vec<u8>, String> {
        let mut why = "there is no such file".to_string();
        for found in self.folders.iter().filter_map(|f| f.data(path)) {
            match found {
                Ok(content) => return Ok(content),
                Err(reason) => why = reason,
            }
        }
        Err(why)
    }

    #[allow(clippy::too_many_arguments)]
    fn open(
        &mut self,
        folder: usize,
        parent: &Path,
        stem: &str,
        class_name: &str,
        full_name: Name,
        sources: &mut SourceMap,
        problems: &mut Problems,
    ) -> Option<Arc<ast::Class>> {
        let as_folder = parent.join(stem);
        let package = as_folder.join("package.mo");
        let (path, text) = match self.folders[folder].read(&package) {
            Some(text) => {
                self.packages.insert(full_name, (folder, as_folder));
                (package, text)
            }
            None => {
                let file = parent.join(format!("{stem}.mo"));
                let text = self.folders[folder].read(&file)?;
                (file, text)
            }
        };
        let shown = self.folders[folder].display(&path);
        let text = match text {
            Ok(text) => text,
            Err(why) => {
                let cause = LibraryCause::UnreadableFile { path: shown.display().to_string(), why };
                problems.push(Diagnostic::new(cause, Span::NONE));
                return None;
            }
        };
        let id = sources.add(shown, text.as_str());
        let file = crate::parse::grammar::parse(id, &text, problems);
        let class = file.classes.iter().find(|c| c.name.name.as_str() == class_name).cloned();
        if class.is_none() {
            let cause = LibraryCause::MissingClass { name: class_name.to_owned() };
            problems.push(Diagnostic::new(cause, Span::new(id, 0, 0)));
        }
        class
    }
}
