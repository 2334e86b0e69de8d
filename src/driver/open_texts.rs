//! Texts that an editor holds: they go before the files on disk, saved or not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The texts of an editor by their files, without links and `..`. Without an editor there is none.
#[derive(Clone, Debug, Default)]
pub struct OpenTexts(Option<Arc<BTreeMap<PathBuf, Arc<str>>>>);

impl OpenTexts {
    /// The texts of an editor, by the paths that [`canonical`] gives.
    pub fn new(texts: BTreeMap<PathBuf, Arc<str>>) -> OpenTexts {
        OpenTexts(Some(Arc::new(texts)))
    }

    /// Whether an editor asks, which opens the files of messages wherever it runs.
    pub fn is_editor(&self) -> bool {
        self.0.is_some()
    }

    /// The files, in order.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.0.iter().flat_map(|texts| texts.keys())
    }

    /// The text of a file.
    pub fn of(&self, file: &Path) -> Option<&Arc<str>> {
        let texts = self.0.as_ref()?;
        if let Some(text) = texts.get(file) {
            return Some(text);
        }
        // Links cost a look at the disk, so only files with the right name are followed.
        let name = file.file_name()?;
        texts.keys().any(|known| known.file_name() == Some(name)).then_some(())?;
        texts.get(&canonical(file))
    }

    /// The same texts, some of which are replaced.
    pub fn with(&self, changed: impl IntoIterator<Item = (PathBuf, Arc<str>)>) -> OpenTexts {
        let mut texts = self.0.as_deref().cloned().unwrap_or_default();
        texts.extend(changed);
        OpenTexts::new(texts)
    }

    /// The names of the open files of a folder, which may not be on disk yet.
    pub fn names_in(&self, folder: &Path) -> Vec<String> {
        let Some(texts) = self.0.as_ref().filter(|texts| !texts.is_empty()) else {
            return Vec::new();
        };
        let folder = canonical(folder);
        let inside = texts.keys().filter(|file| file.parent() == Some(&folder));
        inside.filter_map(|file| Some(file.file_name()?.to_string_lossy().into_owned())).collect()
    }
}

/// The path of a file without links and `..`. The file itself, but not its folder, may be missing.
pub fn canonical(file: &Path) -> PathBuf {
    if let Ok(found) = file.canonicalize() {
        return found;
    }
    let folder = file.parent().and_then(|folder| folder.canonicalize().ok());
    match (folder, file.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => std::path::absolute(file).unwrap_or_else(|_| file.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_found_by_every_path_of_their_file() {
        let here = canonical(Path::new("src/lib.rs"));
        let texts = OpenTexts::new([(here, "open".into())].into());
        assert_eq!(texts.of(Path::new("src/../src/lib.rs")).map(|t| &**t), Some("open"));
        assert_eq!(texts.of(Path::new("src/main.rs")), None);
        assert_eq!(texts.names_in(Path::new("src")), ["lib.rs"]);
        let new = Path::new("src/new.mo");
        let both = texts.with([(canonical(new), Arc::from("new"))]);
        assert_eq!(both.of(new).map(|t| &**t), Some("new"));
        assert!(texts.is_editor() && !OpenTexts::default().is_editor());
    }
}
