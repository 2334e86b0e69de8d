//! Folders of libraries in memory: a model travels to other machines with them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::resolve::library::Folder;

/// The files of a folder, by their paths in it.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Folders, by the names under which requests have them. None of them is looked for on disk.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Packed(Arc<BTreeMap<PathBuf, Arc<Files>>>);

impl Packed {
    /// Folders with their files.
    pub fn new(folders: impl IntoIterator<Item = (PathBuf, Files)>) -> Packed {
        let folders = folders.into_iter().map(|(name, files)| (name, Arc::new(files)));
        Packed(Arc::new(folders.collect()))
    }

    /// A folder, if it is here.
    pub fn folder(&self, name: &Path) -> Option<InMemory> {
        let files = self.0.get(name)?;
        Some(InMemory { name: name.to_path_buf(), files: Arc::clone(files) })
    }
}

/// A folder in memory.
pub struct InMemory {
    name: PathBuf,
    files: Arc<Files>,
}

impl Folder for InMemory {
    fn entries(&self, path: &Path) -> Vec<String> {
        let mut all = Vec::new();
        for file in self.files.keys() {
            let Ok(rest) = file.strip_prefix(path) else { continue };
            let mut parts = rest.iter();
            let Some(first) = parts.next() else { continue };
            let slash = if parts.next().is_some() { "/" } else { "" };
            all.push(first.to_string_lossy().into_owned() + slash);
        }
        all.sort();
        all.dedup();
        all
    }

    fn read(&self, path: &Path) -> Option<Result<String, String>> {
        let bytes = self.files.get(path)?;
        Some(String::from_utf8(bytes.clone()).map_err(|_| "not UTF-8".to_owned()))
    }

    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>> {
        self.files.get(path).map(|bytes| Ok(bytes.clone()))
    }

    fn display(&self, path: &Path) -> PathBuf {
        self.name.join(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_in_memory_has_the_entries_of_one_on_disk() {
        let files = ["A/package.mo", "A/B.mo", "C.mo"];
        let files = files.map(|name| (PathBuf::from(name), name.as_bytes().to_vec()));
        let packed = Packed::new([(PathBuf::from("lib"), files.into_iter().collect())]);
        let folder = packed.folder(Path::new("lib")).unwrap();
        assert_eq!(folder.entries(Path::new("")), ["A/", "C.mo"]);
        assert_eq!(folder.entries(Path::new("A")), ["B.mo", "package.mo"]);
        assert_eq!(folder.read(Path::new("A/B.mo")).unwrap().unwrap(), "A/B.mo");
        assert!(folder.read(Path::new("A")).is_none());
        assert_eq!(folder.display(Path::new("C.mo")), Path::new("lib/C.mo"));
        assert!(packed.folder(Path::new("other")).is_none());
    }
}
