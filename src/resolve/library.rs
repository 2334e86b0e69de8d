//! All classes that a compilation can reach, read on demand.
//!
//! A package may be one file or a folder with `package.mo` (section 13.4 of the specification);
//! what no model asks for is never opened.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems};
use crate::base::index::FastMap;
use crate::base::name::{Name, name};
use crate::base::source::{SourceMap, Span};
use crate::ir::ast;

use super::version::{self, Use};

/// A tree of folders that holds packages: a folder on disk or the library in the binary.
pub trait Folder {
    /// Names in a folder, sorted; empty if there is no such folder. Folders end with `/`.
    fn entries(&self, path: &Path) -> Vec<String>;
    /// The text of a file, or `None` if there is no such file.
    fn read(&self, path: &Path) -> Option<Result<String, String>>;
    /// A file of data, as it is named or in this folder; `None` if there is no such file.
    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>>;
    /// How a file is named in messages.
    fn display(&self, path: &Path) -> PathBuf;
}

/// The classes in reach.
pub struct Library {
    files: Vec<Arc<ast::Class>>,
    folders: Vec<Box<dyn Folder>>,
    tops: FastMap<Name, Option<Arc<ast::Class>>>,
    /// Where a package stands that is a folder: full name to (folder, path).
    packages: FastMap<Name, (usize, PathBuf)>,
    children: FastMap<(Name, Name), Option<Arc<ast::Class>>>,
    /// Versions of libraries that were asked for: the first to ask counts.
    uses: FastMap<Name, Use>,
}

impl Library {
    /// A library of the given folders, searched in order.
    pub fn new(folders: Vec<Box<dyn Folder>>) -> Self {
        Library {
            files: Vec::new(),
            folders,
            tops: FastMap::default(),
            packages: FastMap::default(),
            children: FastMap::default(),
            uses: FastMap::default(),
        }
    }

    /// Adds the library that a file of the user belongs to, before all others: the folder that it is in, and
    /// the one in it that the file is the `package.mo` of.
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

    /// Adds the classes of a file that the user named; they hide libraries of the same name.
    pub fn add_file(&mut self, file: &ast::File, problems: &mut Problems) {
        for class in &file.classes {
            if let Some(before) = self.files.iter().find(|c| c.name.name == class.name.name) {
                problems.push(
                    Diagnostic::error(
                        "MO0101",
                        class.name.span,
                        format!("`{}` is defined twice", class.name.name),
                    )
                    .label("second definition")
                    .also(before.name.span, "first definition")
                    .help("rename or remove one of them"),
                );
                continue;
            }
            self.note_uses(class);
            if let Some(package) = file.package() {
                // A class of a package, opened by itself: it is also reachable by its short name.
                let place = (name(&package.to_string()), class.name.name);
                self.children.insert(place, Some(class.clone()));
            }
            self.files.push(class.clone());
        }
    }

    /// Classes of the user's files, in order.
    pub fn file_classes(&self) -> &[Arc<ast::Class>] {
        &self.files
    }

    /// The top-level class of a name.
    pub fn top(
        &mut self,
        wanted: Name,
        sources: &mut SourceMap,
        problems: &mut Problems,
    ) -> Option<Arc<ast::Class>> {
        if let Some(c) = self.files.iter().find(|c| c.name.name == wanted) {
            return Some(c.clone());
        }
        if let Some(known) = self.tops.get(&wanted) {
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
                self.note_uses(&class);
                found = Some(class);
                break;
            }
        }
        self.tops.insert(wanted, found.clone());
        found
    }

    /// Where a library may stand, by folder and version, the best place first: the version that was asked
    /// for, else in the first folder that has any the newest one.
    fn candidates(&self, library: Name) -> Vec<(usize, String)> {
        let mut all = Vec::new();
        for (k, folder) in self.folders.iter().enumerate() {
            let entries = folder.entries(Path::new(""));
            let of = |e: &String| version::of_entry(e, &library).map(str::to_string);
            let mut versions: Vec<String> = entries.iter().filter_map(of).collect();
            versions.sort_by(|a, b| version::order(b, a));
            versions.dedup();
            all.extend(versions.into_iter().map(|v| (k, v)));
        }
        if let Some(wanted) = self.uses.get(&library) {
            all.sort_by_key(|(_, v)| match v.as_str() {
                v if *v == *wanted.version => 0,
                // It may be that version, and says so in its text.
                "" => 1,
                _ => 2,
            });
        }
        all
    }

    fn note_uses(&mut self, class: &ast::Class) {
        for one in version::uses(class) {
            self.uses.entry(one.library).or_insert(one);
        }
    }

    /// Warns of a library in another version than the one that was asked for, unless it says that it serves.
    fn check_version(&self, class: &ast::Class, of_entry: &str, problems: &mut Problems) {
        let Some(wanted) = self.uses.get(&class.name.name) else { return };
        let found = version::of(class).unwrap_or_else(|| of_entry.into());
        if found.is_empty() || found == wanted.version || version::serves(class, &wanted.version) {
            return;
        }
        let library = wanted.library;
        let message =
            format!("`{library}` {} is asked for, and {found} is what there is", wanted.version);
        problems.push(Diagnostic::warning("MO0105", wanted.span, message).help(
            "name a folder with that version by `--lib`, or write the version that is meant",
        ));
    }

    /// A class that stands in the folder of package `full_name`, in a file of its own.
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

    /// Names of classes in files of their own in the folder of a package, or of all top-level
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

    /// Where `modelica://Package/path` leads (section 13.5 of the specification); other names of files
    /// stay as they are. `None` if there is no such package.
    pub fn resource(&self, uri: &str) -> Option<PathBuf> {
        let Some(rest) = uri.strip_prefix("modelica://") else {
            let plain = uri.strip_prefix("file://").unwrap_or(uri);
            return Some(PathBuf::from(plain));
        };
        let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
        let (folder, root) = self.packages.get(&name(package))?;
        Some(self.folders[*folder].display(&root.join(path)))
    }

    /// What is in a file of data.
    pub fn data(&self, path: &Path) -> Result<Vec<u8>, String> {
        let found = self.folders.iter().find_map(|f| f.data(path));
        found.unwrap_or_else(|| Err("there is no such file".to_string()))
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
                problems.push(Diagnostic::error(
                    "MO0102",
                    Span::NONE,
                    format!("cannot read {}: {why}", shown.display()),
                ));
                return None;
            }
        };
        let id = sources.add(shown, text.as_str());
        let file = crate::parse::grammar::parse(id, &text, problems);
        let class = file.classes.iter().find(|c| c.name.name.as_str() == class_name).cloned();
        if class.is_none() {
            problems.push(
                Diagnostic::error(
                    "MO0103",
                    Span::new(id, 0, 0),
                    format!("this file should define `{class_name}`, and does not"),
                )
                .note("a file of a library holds the class of its own name (section 13.4.1)"),
            );
        }
        class
    }
}
