//! `mocc explain`: the page about a diagnostic code, for the terminal.

use std::sync::OnceLock;

use super::args::inspect::Explain;
use super::{Status, print, print_styled, style_of};
use crate::base::diag::{Diagnostic, Severity};
use crate::base::render::Style;
use crate::driver::files::error_pages;

/// Width of paragraphs, in characters.
const WIDTH: usize = 80;

/// Prints the page of a code, or the list of all codes; status 2 if there is no such code.
pub fn run(options: &Explain) -> Status {
    let pages = error_pages();
    let Some(wanted) = &options.code else { return print(&list(&pages)) };
    match find(wanted, &pages) {
        Ok(page) => print_styled(&shown(page, style_of(&std::io::stdout()))),
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

/// The code of the first error of this process.
static FIRST_ERROR: OnceLock<&str> = OnceLock::new();

/// Remembers the first error among diagnostics that are shown to the user.
pub(super) fn remember<'d>(diagnostics: impl IntoIterator<Item = &'d Diagnostic>) {
    let mut all = diagnostics.into_iter();
    if let Some(error) = all.find(|d| d.severity == Severity::Error) {
        _ = FIRST_ERROR.set(error.code);
    }
}

/// After an error, tells a user at a terminal about this command.
pub(super) fn print_hint() {
    use std::io::IsTerminal;
    if let Some(code) = FIRST_ERROR.get().filter(|_| std::io::stderr().is_terminal()) {
        eprintln!("`mocc explain {code}` says more about this error");
    }
}

type Page = (&'static str, &'static str);

/// All codes with their summaries.
fn list(pages: &[Page]) -> String {
    let lines = pages.iter().map(|(code, page)| format!("{code}  {}\n", plain(summary(page))));
    lines.collect::<String>() + "\n`mocc explain CODE` explains one of them.\n"
}

/// The text of the heading `# CODE: text`.
fn summary(page: &str) -> &str {
    let heading = page.lines().next().unwrap_or_default();
    heading.split_once(": ").map_or(heading, |(_, text)| text)
}

/// The page of a code such as `MO0402`, `mo0402` or `402`.
fn find(wanted: &str, pages: &[Page]) -> Result<&'static str, String> {
    let Some(number) = number(wanted) else {
        let help = "write a code such as `MO0402`; `mocc explain` lists them all";
        return Err(format!("`{wanted}` is not a code of a diagnostic\nhelp: {help}"));
    };
    let code = format!("MO{number:04}");
    if let Some((_, page)) = pages.iter().find(|(known, _)| *known == code) {
        return Ok(page);
    }
    let mut message = format!("there is no diagnostic `{code}`\nhelp: near codes are");
    for (near, page) in nearest(number, pages) {
        message += &format!("\n  {near}  {}", plain(summary(page)));
    }
    Err(message)
}

/// The number of a code, with or without `MO`.
fn number(code: &str) -> Option<u32> {
    let code = code.trim().to_ascii_uppercase();
    let digits = code.strip_prefix("MO").unwrap_or(&code);
    let is_number = (1..=4).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    is_number.then(|| digits.parse().ok()).flatten()
}

/// The codes next to a number, in order.
fn nearest(wanted: u32, pages: &[Page]) -> Vec<Page> {
    const SHOWN: usize = 4;
    let distance = |page: &Page| number(page.0).map_or(u32::MAX, |n| n.abs_diff(wanted));
    let mut near = pages.to_vec();
    near.sort_by_key(distance);
    near.truncate(SHOWN);
    near.sort_unstable();
    near
}

/// A page of Markdown for the terminal: bold headings, filled paragraphs, indented code.
fn shown(page: &str, style: Style) -> String {
    let mut out = String::new();
    let mut paragraph = String::new();
    let mut in_code = false;
    for line in page.lines() {
        let is_fence = line.starts_with("```");
        let heading = Some(line.trim_start_matches('#').trim()).filter(|_| line.starts_with('#'));
        if is_fence || in_code || heading.is_some() || line.is_empty() {
            out += &filled(&std::mem::take(&mut paragraph));
        }
        match heading {
            _ if is_fence => in_code = !in_code,
            _ if in_code && !line.is_empty() => out += &format!("    {line}\n"),
            _ if line.is_empty() => out.push('\n'),
            Some(text) if style == Style::Coloured => {
                out += &format!("\x1b[1m{}\x1b[0m\n", plain(text));
            }
            Some(text) => out += &format!("{}\n", plain(text)),
            None => paragraph += &format!("{line} "),
        }
    }
    out + &filled(&paragraph)
}

/// A paragraph in lines of at most [`WIDTH`] characters.
fn filled(paragraph: &str) -> String {
    let mut out = String::new();
    let mut column = 0;
    for word in plain(paragraph).split_whitespace() {
        let width = word.chars().count();
        if column > 0 && column + 1 + width > WIDTH {
            out.push('\n');
            column = 0;
        } else if column > 0 {
            out.push(' ');
            column += 1;
        }
        out += word;
        column += width;
    }
    if column > 0 {
        out.push('\n');
    }
    out
}

/// Text without the targets of its links. Code is kept as it is.
fn plain(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let plain: Vec<String> = parts
        .map(|(k, part)| if k % 2 == 0 { without_targets(part) } else { part.to_owned() })
        .collect();
    plain.join("`")
}

/// `[text](target)` becomes `text`.
fn without_targets(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, link)) = rest.split_once('[') {
        let parts = link.split_once("](").and_then(|(text, target)| {
            let (_, after) = target.split_once(')')?;
            Some((text, after))
        });
        let Some((text, after)) = parts else { break };
        out += before;
        out += text;
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# MO0001: unexpected `token`\n\nThe text departs from the [grammar](https://a.b/c), \
        and this sentence is long enough to be filled.\nAs `x[1](c)` is.\n\n## Wrong\n\n`a.mo`:\n\n\
        ```modelica\nmodel A\n\n  Real x[3](c = 1);\nend A;\n```\n";

    #[test]
    fn pages_become_plain_text() {
        insta::assert_snapshot!(shown(PAGE, Style::Plain), @"
MO0001: unexpected `token`

The text departs from the grammar, and this sentence is long enough to be
filled. As `x[1](c)` is.

Wrong

`a.mo`:

    model A

      Real x[3](c = 1);
    end A;
");
        let coloured = shown(PAGE, Style::Coloured);
        assert!(coloured.starts_with("\x1b[1mMO0001: unexpected `token`\x1b[0m\n\n"), "{coloured}");
    }

    #[test]
    fn codes_are_found_in_all_spellings() {
        let pages =
            [("MO0001", "# MO0001: a"), ("MO0402", "# MO0402: b"), ("MO0409", "# MO0409: c")];
        for spelling in ["MO0402", "mo0402", "402", "0402", " Mo402"] {
            assert_eq!(find(spelling, &pages), Ok("# MO0402: b"), "{spelling}");
        }
        assert_eq!(find("1", &pages), Ok("# MO0001: a"));
        insta::assert_snapshot!(find("MO0408", &pages).unwrap_err(), @"
there is no diagnostic `MO0408`
help: near codes are
  MO0001  a
  MO0402  b
  MO0409  c
");
        for nonsense in ["MO", "", "MO00402", "40x2", "E0402", "-1", "+402"] {
            let why = find(nonsense, &pages).unwrap_err();
            assert!(why.contains("is not a code of a diagnostic"), "{why}");
        }
    }
}
