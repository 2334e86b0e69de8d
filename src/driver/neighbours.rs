//! Classes in files next to the model's: `Pump.mo`, or `Pump/package.mo`, in its folder.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use super::files::OnDisk;
use super::open_texts::OpenTexts;
use crate::resolve::library::Folder;

/// The folder of a model's file, which is not a package. Other files in it than those of classes stay out of sight.
pub struct Neighbours {
    folder: OnDisk,
    /// Its entries; a folder may have many, and each name that is looked up asks for them.
    entries: OnceCell<Vec<String>>,
}

impl Neighbours {
    /// The classes next to a file; none if its folder is a package, whose classes have other names.
    pub fn of(file: &Path, open: &OpenTexts) -> Option<Neighbours> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let is_package = folder.join("package.mo").is_file();
        let folder = OnDisk { folder: folder.to_path_buf(), open: open.clone() };
        (!is_package).then(|| Neighbours { folder, entries: OnceCell::new() })
    }

    fn found(&self) -> Vec<String> {
        let is_class = |entry: &String| match entry.strip_suffix('/') {
            Some(folder) => self.folder.folder.join(folder).join("package.mo").is_file(),
            None => entry.ends_with(".mo"),
        };
        let mut all = self.folder.entries(Path::new(""));
        all.retain(is_class);
        all
    }
}

impl Folder for Neighbours {
    fn entries(&self, path: &Path) -> Vec<String> {
        match path.as_os_str().is_empty() {
            true => self.entries.get_or_init(|| self.found()).clone(),
            false => self.folder.entries(path),
        }
    }

    fn read(&self, path: &Path) -> Option<Result<String, String>> {
        let source = self.folder.read(path)?;
        // The file of another model may have the name of a class by chance: `pump.mo` with `model Pump`.
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_named = |source: &String| stem == "package" || has_word(source, &stem);
        source.as_ref().map_or(true, is_named).then_some(source)
    }

    fn data(&self, path: &Path) -> Option<Result<Vec<u8>, String>> {
        self.folder.data(path)
    }

    fn display(&self, path: &Path) -> PathBuf {
        self.folder.display(path)
    }
}

/// Whether a name is a word of a source.
fn has_word(source: &str, name: &str) -> bool {
    let is_inside = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    source.match_indices(name).any(|(at, _)| {
        !is_inside(source[..at].chars().next_back())
            && !is_inside(source[at + name.len()..].chars().next())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_words_of_a_source() {
        assert!(has_word("model Pump end Pump;", "Pump"));
        assert!(!has_word("model Pumps end Pumps;", "Pump"));
        assert!(!has_word("", "Pump"));
    }
}
