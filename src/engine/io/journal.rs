//! Journals: files with the results of a long task, line by line, so that an interrupted task can
//! be resumed.
//!
//! The first line identifies the task by a fingerprint, and the arithmetic of the machine by another
//! one: results of machines that round differently are not mixed. A line that was truncated because the
//! process was killed is dropped. The file is locked while a process uses it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Start of the first line.
const HEAD: &str = "mocc journal 2 ";

/// Why a journal cannot be used.
#[derive(Error, Debug)]
pub enum JournalError {
    /// Reading or writing failed.
    #[error("cannot use the journal {}: {source}", path.display())]
    File {
        /// The journal.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// Another process uses it.
    #[error("{} is in use by another process", path.display())]
    InUse {
        /// The journal.
        path: PathBuf,
    },
}

/// A journal, open at its end.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
    /// Complete lines so far.
    pub lines: u64,
}

/// Result of opening a journal.
#[derive(Debug)]
pub enum Found {
    /// The journal of this task, new or existing.
    Ours(Journal),
    /// The journal of another task.
    Other,
    /// The journal of this task, from a machine whose arithmetic rounds differently.
    Foreign,
}

impl Journal {
    /// Opens or creates the journal of the task with this fingerprint, on a machine with this arithmetic.
    pub fn open(path: &Path, fingerprint: u64, arithmetic: u64) -> Result<Found, JournalError> {
        let failed = |source| JournalError::File { path: path.to_path_buf(), source };
        let options =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = options.map_err(failed)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(JournalError::InUse { path: path.to_path_buf() });
            }
            // Continue without a lock if the file system does not support it.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let task = format!("{HEAD}{fingerprint:016x} ");
        let head = format!("{task}{arithmetic:016x}\n");
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        let mut whole = 0;
        let mut lines = 0;
        while reader.read_until(b'\n', &mut line).map_err(failed)? > 0 && line.ends_with(b"\n") {
            if whole == 0 && line != head.as_bytes() {
                let is_ours = line.starts_with(task.as_bytes());
                return Ok(if is_ours { Found::Foreign } else { Found::Other });
            }
            lines += u64::from(whole > 0);
            whole += line.len() as u64;
            line.clear();
        }
        file.set_len(whole).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        if whole == 0 {
            file.write_all(head.as_bytes()).map_err(failed)?;
        }
        Ok(Found::Ours(Journal { file, path: path.to_path_buf(), lines }))
    }

    /// Appends a line, which must not contain a line break.
    pub fn push(&mut self, line: &str) -> Result<(), JournalError> {
        // With a single write: another process may be reading.
        let written = self.file.write_all(format!("{line}\n").as_bytes());
        written.map_err(|source| self.failed(source))?;
        self.lines += 1;
        Ok(())
    }

    /// Calls `visit` with every line, in order, until it returns false.
    pub fn for_each(&mut self, mut visit: impl FnMut(&str) -> bool) -> Result<(), JournalError> {
        let failed = |source| JournalError::File { path: self.path.clone(), source };
        self.file.seek(SeekFrom::Start(0)).map_err(failed)?;
        for line in BufReader::new(&self.file).lines().skip(1) {
            if !visit(&line.map_err(failed)?) {
                break;
            }
        }
        self.file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(())
    }

    /// Removes the file after the task is complete.
    pub fn remove(self) -> Result<(), JournalError> {
        remove(&self.path)
    }

    fn failed(&self, source: io::Error) -> JournalError {
        JournalError::File { path: self.path.clone(), source }
    }
}

/// Removes a journal if it exists.
pub fn remove(path: &Path) -> Result<(), JournalError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => {
            Err(JournalError::File { path: path.to_path_buf(), source: e })
        }
        _ => Ok(()),
    }
}

/// The journals of shards: the files `NAME.K-of-N.journal` for a journal `NAME.journal`, each with K and N, by N, then K.
pub fn shards(journal: &Path) -> Vec<(u64, u64, PathBuf)> {
    let folder = journal.parent().filter(|f| !f.as_os_str().is_empty());
    let Some(stem) = journal.file_stem().map(|s| s.to_string_lossy().into_owned()) else {
        return Vec::new();
    };
    let Ok(list) = fs::read_dir(folder.unwrap_or(Path::new("."))) else { return Vec::new() };
    let shard = |entry: fs::DirEntry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        let part = name.strip_prefix(&stem)?.strip_prefix('.')?.strip_suffix(".journal")?;
        let (k, n) = part.split_once("-of-")?;
        Some((k.parse().ok()?, n.parse().ok()?, journal.with_file_name(&name)))
    };
    let mut all: Vec<(u64, u64, PathBuf)> = list.flatten().filter_map(shard).collect();
    all.sort_by_key(|(k, n, _)| (*n, *k));
    all
}

/// The journal of a shard, see [`shards`].
pub fn shard(journal: &Path, k: u64, n: u64) -> PathBuf {
    let stem = journal.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    journal.with_file_name(format!("{stem}.{k}-of-{n}.journal"))
}

/// True if a file or folder with this name exists.
pub fn exists(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// A fingerprint of a sequence of strings: 64-bit FNV-1a (Fowler, Noll, Vo; RFC 9923).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Fingerprint(pub u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Fingerprint(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Adds a string.
    pub fn add(&mut self, text: &str) {
        // The length distinguishes `ab`, `c` from `a`, `bc`.
        for byte in text.len().to_le_bytes().iter().chain(text.as_bytes()) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::atomic_file::tests::Scratch;

    fn ours(path: &Path, fingerprint: u64) -> Journal {
        match Journal::open(path, fingerprint, 3).unwrap() {
            Found::Ours(journal) => journal,
            found => panic!("{found:?}"),
        }
    }

    #[test]
    fn complete_lines_remain_and_truncated_ones_are_dropped() {
        let dir = Scratch::new("journal");
        let path = dir.path("work");
        let mut journal = ours(&path, 7);
        journal.push("one").unwrap();
        journal.push("two").unwrap();
        drop(journal);
        let mut text = fs::read_to_string(&path).unwrap();
        text.push_str("thr");
        fs::write(&path, text).unwrap();
        let mut journal = ours(&path, 7);
        assert_eq!(journal.lines, 2);
        journal.push("three").unwrap();
        let mut lines = Vec::new();
        journal
            .for_each(|line| {
                lines.push(line.to_owned());
                true
            })
            .unwrap();
        assert_eq!(lines, ["one", "two", "three"]);
        assert!(matches!(Journal::open(&path, 7, 3), Err(JournalError::InUse { .. })));
        journal.remove().unwrap();
        assert_eq!(dir.files(), [""; 0]);
    }

    #[test]
    fn another_task_is_recognized() {
        let dir = Scratch::new("other");
        drop(ours(&dir.path("work"), 7));
        assert!(matches!(Journal::open(&dir.path("work"), 8, 3), Ok(Found::Other)));
        assert!(matches!(Journal::open(&dir.path("work"), 7, 4), Ok(Found::Foreign)));
        // Left over from a process that was killed before the first line was complete.
        fs::write(dir.path("cut"), "mocc jour").unwrap();
        assert_eq!(ours(&dir.path("cut"), 8).lines, 0);
    }

    #[test]
    fn shards_are_found_by_their_names() {
        let dir = Scratch::new("shards");
        let whole = dir.path("sweep.journal");
        for (k, n) in [(2, 3), (1, 3), (10, 12)] {
            fs::write(shard(&whole, k, n), "").unwrap();
        }
        fs::write(dir.path("sweep.x-of-3.journal"), "").unwrap();
        fs::write(&whole, "").unwrap();
        let found: Vec<_> = shards(&whole).into_iter().map(|(k, n, _)| (k, n)).collect();
        assert_eq!(found, [(1, 3), (2, 3), (10, 12)]);
    }

    /// The published value for the empty string.
    #[test]
    fn fingerprints_depend_on_string_boundaries() {
        let of = |texts: &[&str]| {
            let mut f = Fingerprint::default();
            texts.iter().for_each(|t| f.add(t));
            f
        };
        assert_eq!(Fingerprint::default().0, 0xcbf2_9ce4_8422_2325);
        assert_ne!(of(&["ab", "c"]), of(&["a", "bc"]));
        assert_ne!(of(&["ab"]), of(&["ab", ""]));
    }
}
