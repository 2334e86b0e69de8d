//! Renders diagnostics with source excerpts for the terminal. Sole user of `annotate-snippets`.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use super::diag::{Diagnostic, Problems, Severity};
use super::source::{FileId, SourceMap, Span};

/// Coloured or plain output.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Style {
    /// ANSI colours, for a terminal.
    Coloured,
    /// No escape codes, for pipes and snapshots.
    Plain,
}

/// Number of problems that are shown: nobody reads more, and each costs a look at its whole file.
const MAX_SHOWN: usize = 200;

/// Renders the problems, sorted by span, each followed by an empty line; of very many, the first.
pub fn render_all(problems: &Problems, sources: &SourceMap, style: Style) -> String {
    let sorted = problems.sorted();
    let shown = sorted.iter().take(MAX_SHOWN);
    let mut text: String = shown.map(|d| render(d, sources, style) + "\n\n").collect();
    if sorted.len() > MAX_SHOWN {
        text.push_str(&format!("{} further problems are not shown\n\n", sorted.len() - MAX_SHOWN));
    }
    text
}

/// Renders one diagnostic with its source excerpts.
pub fn render(diagnostic: &Diagnostic, sources: &SourceMap, style: Style) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code);
    let places: Vec<(Span, &str, AnnotationKind)> = std::iter::once((
        diagnostic.primary.0,
        diagnostic.primary.1.as_str(),
        AnnotationKind::Primary,
    ))
    .chain(diagnostic.secondary.iter().map(|(s, t)| (*s, t.as_str(), AnnotationKind::Context)))
    .filter(|(s, ..)| sources.get(s.file).is_some())
    .collect();
    let mut files: Vec<FileId> = Vec::new();
    for (span, ..) in &places {
        if !files.contains(&span.file) {
            files.push(span.file);
        }
    }
    let paths: Vec<String> =
        files.iter().map(|f| sources.get(*f).unwrap().path.display().to_string()).collect();

    let mut elements: Vec<annotate_snippets::Element<'_>> = Vec::new();
    for (file, path) in files.iter().zip(&paths) {
        let source = sources.get(*file).unwrap();
        let snippet = Snippet::source(&*source.text).path(path.as_str()).annotations(
            places.iter().filter(|(s, ..)| s.file == *file).map(|(s, text, kind)| {
                let range = clamp(&source.text, *s);
                let annotation = kind.span(range);
                if text.is_empty() { annotation } else { annotation.label(*text) }
            }),
        );
        elements.push(snippet.into());
    }
    elements.extend(diagnostic.notes.iter().map(|n| Level::NOTE.message(n.as_str()).into()));
    elements.extend(diagnostic.help.iter().map(|h| Level::HELP.message(h.as_str()).into()));
    let report: Vec<Group<'_>> = if elements.is_empty() {
        vec![Group::with_title(title)]
    } else {
        vec![title.elements(elements)]
    };
    let renderer = match style {
        Style::Coloured => Renderer::styled(),
        Style::Plain => Renderer::plain(),
    };
    renderer.render(&report)
}

/// A text of a model as a terminal shows it safely: without control characters that would move the
/// cursor, set its title or change the direction of letters.
pub fn visible(text: &str) -> String {
    let shown = |c: char| match c {
        '\n' | '\t' => c,
        // The pictures of control characters.
        '\0'..='\x1f' => char::from_u32(0x2400 + c as u32).unwrap_or('\u{fffd}'),
        '\x7f' => '\u{2421}',
        '\u{80}'..='\u{9f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        c => c,
    };
    text.chars().map(shown).collect()
}

/// The span as a range that lies inside the text and on character boundaries.
fn clamp(text: &str, span: Span) -> std::ops::Range<usize> {
    let boundary = |mut i: usize| {
        i = i.min(text.len());
        while !text.is_char_boundary(i) {
            i -= 1;
        }
        i
    };
    let start = boundary(span.start as usize);
    let end = boundary(span.end as usize).max(start);
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_cannot_command_the_terminal() {
        let hostile = "a\x1b[31mred\x1b]0;title\x07\tb\n\u{202e}c\u{9b}1m\r";
        let shown = visible(hostile);
        assert_eq!(shown, "a␛[31mred␛]0;title␇\tb\n\u{fffd}c\u{fffd}1m␍");
    }
}
