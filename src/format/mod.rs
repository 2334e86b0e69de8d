//! Text to the same text in order: indentation by structure, spaces by rule.
//!
//! In: the text of a file. Out: a text of the same tokens and comments in the same lines. Where a line
//! breaks is the author's business, and so are columns: spaces that align, two or more, stay. All
//! else is decided here, so that formatting a formatted text changes nothing. What comes out is cut into
//! tokens again and compared with what went in before anybody sees it.
mod gap;
mod indent;

use crate::base::diag::Problems;
use crate::base::source::FileId;
use crate::parse::grammar::parse;
use crate::parse::lexer::lex;
use crate::parse::token::Kind;

/// Why a text is not formatted.
#[derive(thiserror::Error, Debug)]
pub enum Refusal {
    /// Only what parses can be put in order.
    #[error("the text has syntax errors")]
    Syntax(Problems),
    /// The result would not be the same text: mocc is wrong.
    #[error("the formatted text would differ from the text")]
    Differs,
}

/// A token or comment with its text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item<'t> {
    /// `None` for comments.
    kind: Option<Kind>,
    text: &'t str,
    start: usize,
    end: usize,
}

/// The text of file `id` in order; syntax errors have their places in that file.
pub fn format(id: FileId, text: &str) -> Result<String, Refusal> {
    let mut problems = Problems::new();
    parse(id, text, &mut problems);
    if problems.has_errors() {
        return Err(Refusal::Syntax(problems));
    }
    let before = items(id, text);
    let mut out = String::with_capacity(text.len());
    let mut structure = indent::Structure::default();
    let mut first = true;
    let mut at = 0;
    while at < before.len() {
        let end = line_end(&before, text, at);
        let line = &before[at..end];
        if !first {
            let gap = &text[before[at - 1].end..line[0].start];
            out.push('\n');
            // One empty line parts as well as several.
            if gap.matches('\n').count() > 1 {
                out.push('\n');
            }
        }
        first = false;
        let written = column(text, line[0].start);
        let indent = structure.line(line, written);
        out.extend(std::iter::repeat_n(' ', indent));
        for (k, item) in line.iter().enumerate() {
            if k > 0 {
                let apart = &text[line[k - 1].end..item.start];
                let width = gap::width(line, k, apart, structure.depth_at(k));
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
        Err(Refusal::Differs)
    }
}

/// Tokens and comments in order.
fn items(id: FileId, text: &str) -> Vec<Item<'_>> {
    let lexed = lex(id, text, &mut Problems::new());
    let tokens = lexed.tokens.iter().map(|t| (Some(t.kind), t.start as usize, t.end as usize));
    let comments =
        lexed.comments.iter().map(|c| (None, c.span.start as usize, c.span.end as usize));
    let mut all: Vec<(Option<Kind>, usize, usize)> = tokens.chain(comments).collect();
    all.sort_by_key(|(_, start, _)| *start);
    let mut out: Vec<Item<'_>> = Vec::with_capacity(all.len());
    for (kind, start, end) in all {
        // A comment inside of `end /* */ if` is a part of that token's text.
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

/// One past the last item that begins in the line where item `at` begins or ends.
fn line_end(items: &[Item<'_>], text: &str, at: usize) -> usize {
    let mut end = at + 1;
    while end < items.len() && !text[items[end - 1].end..items[end].start].contains('\n') {
        end += 1;
    }
    end
}

/// Columns before a byte, tabs counted as one.
fn column(text: &str, at: usize) -> usize {
    let line = text[..at].rfind('\n').map_or(0, |n| n + 1);
    text[line..at].chars().filter(|c| *c != '\u{feff}').count()
}
