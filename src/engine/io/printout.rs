//! Files that a model writes while it runs (`Modelica.Utilities.Streams.print`).
//!
//! In: names and lines that the model chooses, so those of a stranger. Out: files in the folder of the
//! results, or in folders that the user allows. Elsewhere nothing is written; in the folder of the
//! results, which may be anybody's home, only files that do not exist yet and are not hidden.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

/// The bounds within which a model writes, and what it has begun.
#[derive(Debug, Default)]
pub struct Printout {
    /// The folder of the results; without it nothing is written.
    folder: Option<PathBuf>,
    allowed: Vec<PathBuf>,
    /// Files that this run has created.
    begun: Vec<PathBuf>,
    /// Names that were refused, each reported once.
    refused: Vec<String>,
}

impl Printout {
    /// Writes to new files in `folder` (the working directory if it is empty), and to all files in
    /// the folders `allowed`.
    pub fn new(folder: &Path, allowed: &[PathBuf]) -> Self {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Printout {
            folder: Some(folder.to_owned()),
            allowed: allowed.to_vec(),
            ..Printout::default()
        }
    }

    /// Appends a line to the file that the model calls `name`; relative names begin at the folder of
    /// the results. The error says why it is not written, the first time for each name.
    pub fn append(&mut self, name: &str, line: &str) -> Result<(), String> {
        let outcome = self.try_append(Path::new(name), line);
        if outcome.is_err() {
            if self.refused.iter().any(|n| n == name) {
                return Ok(());
            }
            self.refused.push(name.to_owned());
        }
        outcome
    }

    fn try_append(&mut self, name: &Path, line: &str) -> Result<(), String> {
        let folder = self.folder.as_ref().ok_or("this command writes no files of models")?;
        let path = folder.join(name);
        let (Some(parent), Some(file)) = (path.parent(), path.file_name()) else {
            return Err("it is not the name of a file".to_owned());
        };
        // Links and `..` are resolved before the folders are compared.
        let parent = parent.canonicalize().map_err(|e| e.to_string())?;
        let target = parent.join(file);
        let within = |folder: &PathBuf| {
            let folder = folder.canonicalize().ok()?;
            target.strip_prefix(folder).ok().map(Path::to_path_buf)
        };
        let mut options = OpenOptions::new();
        options.append(true);
        if self.allowed.iter().any(|folder| within(folder).is_some()) {
            // A link in an allowed folder may still lead out of it.
            if target.is_symlink() {
                return Err("it is a link".to_owned());
            }
            options.create(true);
        } else {
            let inside = within(folder).ok_or(
                "it is outside of the folder of the results; allow it with `--allow-write DIR`",
            )?;
            let is_hidden = |c: Component<'_>| c.as_os_str().to_string_lossy().starts_with('.');
            if inside.components().any(is_hidden) {
                return Err("it is a hidden file; allow it with `--allow-write DIR`".to_owned());
            }
            if !self.begun.contains(&target) {
                options.create_new(true);
            }
        }
        let mut file = options.open(&target).map_err(|e| match e.kind() {
            std::io::ErrorKind::AlreadyExists => {
                "it exists; remove it, or allow it with `--allow-write DIR`".to_owned()
            }
            _ => e.to_string(),
        })?;
        if !self.begun.contains(&target) {
            self.begun.push(target);
        }
        writeln!(file, "{line}").map_err(|e| e.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::atomic_file::tests::Scratch;
    use std::fs;

    #[test]
    fn only_new_files_beside_the_results_are_written() {
        let scratch = Scratch::new("printout");
        let (out, other) = (scratch.path("out"), scratch.path("other"));
        fs::create_dir(&out).unwrap();
        fs::create_dir(&other).unwrap();
        fs::write(out.join("mine.txt"), "old\n").unwrap();
        let mut printout = Printout::new(&out, &[]);
        printout.append("log.txt", "one").unwrap();
        printout.append("log.txt", "two").unwrap();
        assert_eq!(fs::read_to_string(out.join("log.txt")).unwrap(), "one\ntwo\n");
        let absolute = other.join("log.txt");
        for name in ["mine.txt", ".profile", "../other/log.txt", absolute.to_str().unwrap(), ".."] {
            assert!(printout.append(name, "no").is_err(), "{name}");
            assert_eq!(printout.append(name, "no"), Ok(()), "{name} is refused twice");
        }
        assert_eq!(fs::read_to_string(out.join("mine.txt")).unwrap(), "old\n");
        assert_eq!(fs::read_dir(&other).unwrap().count(), 0);
    }

    #[test]
    fn allowed_folders_hold_older_files() {
        let scratch = Scratch::new("printout-allowed");
        let (out, other) = (scratch.path("out"), scratch.path("other"));
        fs::create_dir(&out).unwrap();
        fs::create_dir(&other).unwrap();
        fs::write(other.join("log.txt"), "old\n").unwrap();
        let mut printout = Printout::new(&out, std::slice::from_ref(&other));
        printout.append("../other/log.txt", "new").unwrap();
        assert_eq!(fs::read_to_string(other.join("log.txt")).unwrap(), "old\nnew\n");
    }

    #[test]
    fn without_a_folder_nothing_is_written() {
        assert!(Printout::default().append("mocc-never.txt", "no").is_err());
    }
}
