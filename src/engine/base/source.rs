//! Source files, spans within them, and the conversion of byte offsets to lines and columns.

use std::path::{Path, PathBuf};
use std::sync::Arc;

crate::define_id! {
    /// A file in the [`SourceMap`].
    pub struct FileId
}

/// A range of bytes in one file. [`Span::NONE`] marks objects that have no source.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The span of an object that has no source.
    pub const NONE: Span = Span { file: FileId(u32::MAX), start: 0, end: 0 };

    /// The bytes `start..end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Span { file, start: start as u32, end: end as u32 }
    }
    /// The smallest span that covers both.
    pub fn to(self, other: Span) -> Span {
        if self == Span::NONE {
            return other;
        }
        if other == Span::NONE || other.file != self.file {
            return self;
        }
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
    /// True for [`Span::NONE`].
    pub fn is_none(self) -> bool {
        self == Span::NONE
    }
}

/// The path of the source that holds an override such as those of `--set`.
pub const SETTING: &str = "--set";

/// One source file: its path as shown to the user, its content and the starts of its lines.
#[derive(Debug)]
pub struct SourceFile {
    /// Path as given on the command line, or `lib:Seals/package.mo` for an embedded file.
    pub path: PathBuf,
    /// The whole content.
    pub text: Arc<str>,
    line_starts: Vec<u32>,
}

impl SourceFile {
    /// Line and column of a byte offset, both from 1; the column counts characters.
    pub fn line_column(&self, offset: u32) -> (usize, usize) {
        let line = self.line_starts.partition_point(|&s| s <= offset).max(1);
        let start = self.line_starts[line - 1] as usize;
        let end = (offset as usize).min(self.text.len());
        (line, self.text.get(start..end).map_or(1, |s| s.chars().count() + 1))
    }
}

/// All files of one compilation.
#[derive(Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// Adds a file under the path that diagnostics show for it.
    pub fn add(&mut self, path: impl AsRef<Path>, text: impl Into<Arc<str>>) -> FileId {
        let text: Arc<str> = text.into();
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i as u32 + 1))
            .collect();
        let id = FileId(self.files.len() as u32);
        self.files.push(SourceFile { path: path.as_ref().to_path_buf(), text, line_starts });
        id
    }
    /// All files, in the order in which they were read.
    pub fn files(&self) -> impl Iterator<Item = &SourceFile> {
        self.files.iter()
    }
    /// The file; `None` for the file of [`Span::NONE`].
    pub fn get(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }
    /// The contents of all files, in the order in which they were added.
    pub fn contents(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|f| &*f.text)
    }
    /// `file:line:column` of the start of a span; `None` for [`Span::NONE`].
    pub fn place(&self, span: Span) -> Option<String> {
        let file = self.get(span.file)?;
        let (line, column) = file.line_column(span.start);
        Some(format!("{}:{line}:{column}", file.path.display()))
    }
    /// The source text of a span.
    pub fn text(&self, span: Span) -> Option<&str> {
        self.get(span.file)?.text.get(span.start as usize..span.end as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_lines_start_at_one() {
        let mut map = SourceMap::default();
        let f = map.add("a.mo", "model Ä\n  x\nend Ä;");
        assert_eq!(map.place(Span::new(f, 0, 5)).unwrap(), "a.mo:1:1");
        let x = "model Ä\n  ".len();
        assert_eq!(map.place(Span::new(f, x, x + 1)).unwrap(), "a.mo:2:3");
        assert_eq!(map.text(Span::new(f, x, x + 1)), Some("x"));
        assert_eq!(map.place(Span::NONE), None);
    }
}
