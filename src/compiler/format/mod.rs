//! The source formatter (`mocc fmt`): indentation by structure, spaces by rule.
//!
//! In: the source of a file. Out: the same tokens and comments on the same lines. The author
//! decides on line breaks and on alignment: two or more spaces are kept. All other whitespace is
//! normalized, so formatting is idempotent. The output is tokenized again and compared with the
//! input before it is returned.
mod gap;
mod indent;

use crate::base::diag::Problems;
use crate::base::source::FileId;
use crate::parse::grammar::parse;
use crate::parse::lexer::lex;
use crate::parse::token::TokenKind;

/// Why a file cannot be formatted.
#[derive(thiserror::Error, Debug)]
pub enum FormatError {
    /// The source does not parse.
    #[error("the text has syntax errors")]
    Syntax(Problems),
    /// The output has other tokens than the input, which is a bug in mocc.
    #[error("the formatted text would differ from the text")]
    Differs,
}

/// A token or comment with its text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item<'t> {
    /// `None` for comments.
    kind: Option<TokenKind>,
    text: &'t str,
    start: usize,
    end: usize,
}

/// Formats `text`; the spans of syntax errors refer to file `id`.
pub fn format(id: FileId, text: &str) -> Result<String, FormatError> {
    let mut problems = Problems::new();
    parse(id, text, &mut problems);
    if problems.has_errors() {
        return Err(FormatError::Syntax(problems));
    }
    let before = items(id, text);
    let mut out = String::with_capacity(text.len());
    let mut indenter = indent::Indenter::default();
    let mut first = true;
    let mut at = 0;
    while at < before.len() {
        let end = line_end(&before, text, at);
        let line = &before[at..end];
        if !first {
            let gap = &text[before[at - 1].end..line[0].start];
            out.push('\n');
            // Several empty lines collapse to one.
            if gap.matches('\n').count() > 1 {
                out.push('\n');
            }
        }
        first = false;
        let written = column(text, line[0].start);
        let indent = indenter.line(line, written);
        out.extend(std::iter::repeat_n(' ', indent));
        for (k, item) in line.iter().enumerate() {
            if k > 0 {
                let original = &text[line[k - 1].end..item.start];
                let width = gap::width(line, k, original, indenter.depth_at(k));
                out.extend(std::iter::repeat_n(' ', width));
            }
            out.push_str(item.text);
        }
        at = end;
    }
    if !out.is_empty() {
        out.push('\n');
    }
    let after = items(id, &out);
    let same = |(a, b): (&Item<'_>, &Item<'_>)| a.kind == b.kind && a.text == b.text;
    if before.len() == after.len() && before.iter().zip(&after).all(same) {
        Ok(out)
    } else {
        Err(FormatError::Differs)
    }
}

/// Tokens and comments in order.
fn items(id: FileId, text: &str) -> Vec<Item<'_>> {
    let lexed = lex(id, text, &mut Problems::new());
    let tokens = lexed.tokens.iter().map(|t| (Some(t.kind), t.start as usize, t.end as usize));
    let comments =
        lexed.comments.iter().map(|c| (None, c.span.start as usize, c.span.end as usize));
    let mut all: Vec<(Option<TokenKind>, usize, usize)> = tokens.chain(comments).collect();
    all.sort_by_key(|(_, start, _)| *start);
    let mut out: Vec<Item<'_>> = Vec::with_capacity(all.len());
    for (kind, start, end) in all {
        // A comment inside `end /* */ if` is part of that token.
        if out.last().is_some_and(|last| start < last.end) {
            continue;
        }
        let mut slice = &text[start..end];
        if kind.is_none() {
            slice = slice.trim_end();
        }
        out.push(Item { kind, text: slice, start, end });
    }
    out
}

/// One past the last item that begins on the line where item `at` begins or ends.
fn line_end(items: &[Item<'_>], text: &str, at: usize) -> usize {
    let mut end = at + 1;
    while end < items.len() && !text[items[end - 1].end..items[end].start].contains('\n') {
        end += 1;
    }
    end
}

/// The column of a byte offset; a tab counts as one column.
fn column(text: &str, at: usize) -> usize {
    let line = text[..at].rfind('\n').map_or(0, |n| n + 1);
    text[line..at].chars().filter(|c| *c != '\u{feff}').count()
}
