//! Snapshots: files that hold what a run was when its test was accepted.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::files;
use super::test_file::{Test, file_name};
use crate::compare::events::Listed;
use crate::io::atomic_file::{create_folder, write_file};

/// The kinds of snapshots, each with the end of the name of its files.
pub const FLAT: &str = "flat.mo";
/// See [`FLAT`].
pub const BLOCKS: &str = "blocks.txt";
/// See [`FLAT`].
pub const EVENTS: &str = "events.txt";
/// See [`FLAT`].
pub const TRACES: &str = "traces.csv";

/// A snapshot that is missing, or that differs from a run.
#[derive(Clone, PartialEq, Debug)]
pub struct Snapshot {
    /// Its file.
    pub path: PathBuf,
    /// Its text; none if it is missing.
    pub before: Option<String>,
    /// The text that the run has.
    pub after: String,
}

impl Snapshot {
    /// The snapshot of a kind of a test, in the folder that is named after the test file.
    pub fn path(test: &Test, kind: &str) -> PathBuf {
        folder(&test.file).join(format!("{}.{kind}", file_name(&test.name)))
    }

    /// Writes the text of the run. Interrupted, it leaves the old file or the new one. The error is a message.
    pub fn accept(&self) -> Result<(), String> {
        let folder = self.path.parent().unwrap_or(Path::new("."));
        create_folder(folder).map_err(|e| e.to_string())?;
        write_file(&self.path, self.after.as_bytes()).map_err(|e| e.to_string())
    }
}

/// The folder of the snapshots of a file with tests: `valve52.test` of `valve52.test.toml`, `Valve.mo.test` of
/// `Valve.mo`.
pub fn folder(file: &Path) -> PathBuf {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match files::is_test(file) {
        true => file.with_extension(""),
        false => file.with_file_name(format!("{name}.test")),
    }
}

/// Snapshots that none of all tests has, in the folders that have some.
pub fn unused(tests: &[Test]) -> Vec<PathBuf> {
    let kinds = [FLAT, BLOCKS, EVENTS, TRACES];
    let path = |test: &Test| kinds.map(|kind| Snapshot::path(test, kind));
    let used: BTreeSet<PathBuf> = tests.iter().flat_map(path).collect();
    let folders: BTreeSet<PathBuf> = tests.iter().map(|test| folder(&test.file)).collect();
    let mut all: Vec<PathBuf> = folders.iter().flat_map(|folder| files::inside(folder)).collect();
    let is_snapshot =
        |path: &PathBuf| kinds.iter().any(|kind| path.to_string_lossy().ends_with(kind));
    all.retain(|path| is_snapshot(path) && !used.contains(path));
    all
}

/// A list of events as the text of a snapshot: a line for each.
pub fn printed(events: &[Listed]) -> String {
    events.iter().map(|(time, what)| format!("{time:.9} s: {what}\n")).collect()
}

/// The events of a snapshot. The error is a message.
pub fn parsed(text: &str) -> Result<Vec<Listed>, String> {
    let read = |line: &str| {
        let (time, what) = line.split_once(" s: ")?;
        Some((time.trim().parse().ok()?, what.to_owned()))
    };
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(k, line)| read(line).ok_or_else(|| format!("line {} is not an event", k + 1)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_read_back() {
        let events = [(0.125, "h <= 0.0 became true".to_owned()), (2.0, "a s: b".to_owned())];
        let text = printed(&events);
        assert_eq!(text, "0.125000000 s: h <= 0.0 became true\n2.000000000 s: a s: b\n");
        assert_eq!(parsed(&text).as_deref(), Ok(&events[..]));
        assert_eq!(parsed("x\n"), Err("line 1 is not an event".to_owned()));
    }
}
