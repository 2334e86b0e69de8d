//! Retired words stay out of what users and contributors read: strings of the program, `--help`, comments of the library,
//! and pages. The list is the last table of `docs/glossary.md`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};

use super::docs::pages;
use super::door::Scratch;
use super::program::mocc;

#[test]
fn strings_of_the_program_keep_to_the_glossary() {
    let words = retired();
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for path in files("src", "rs").into_iter().chain(files("python/src", "rs")) {
        let file = path.strip_prefix(root()).expect("a file of the project").display().to_string();
        if file.contains("/tests/") || file.ends_with("tests.rs") || file.ends_with("fixture.rs") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("a source file");
        let stream = text.parse().unwrap_or_else(|why| panic!("{file}: {why}"));
        let mut strings = Vec::new();
        collect(stream, &mut strings);
        for (line, text) in strings {
            for word in words.iter().filter(|word| word.occurs(&text)) {
                found.entry(&word.word).or_default().push(format!("{file}:{line}: {text}"));
            }
        }
    }
    let broken: Vec<String> = found
        .iter()
        .map(|(word, places)| {
            let instead = words.iter().find(|w| w.word == *word).map_or("", |w| &w.instead);
            format!("`{word}` occurs; write {instead}\n  {}", places.join("\n  "))
        })
        .collect();
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn pages_keep_to_the_glossary() {
    let words = retired();
    let mut broken = Vec::new();
    for page in pages() {
        let text = fs::read_to_string(root().join(&page)).expect("a page");
        broken.extend(check_prose(&page, &prose(&text, page == "docs/glossary.md"), &words));
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn help_keeps_to_the_glossary() {
    let words = retired();
    let folder = Scratch::new();
    let help = mocc(folder.path(), &["--help"]).out;
    let commands: Vec<String> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .collect();
    let mut broken = check_prose("mocc --help", &lines(&help), &words);
    for command in commands {
        let text = mocc(folder.path(), &[&command, "--help"]).out;
        broken.extend(check_prose(&format!("mocc {command} --help"), &lines(&text), &words));
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn the_library_keeps_to_the_glossary() {
    let words = retired();
    let mut broken = Vec::new();
    for path in files("lib", "mo") {
        let text = fs::read_to_string(&path).expect("a source file");
        let file = path.strip_prefix(root()).expect("a file of the project").display().to_string();
        broken.extend(check_prose(&file, &lines(&text), &words));
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn words_are_found_whole() {
    let word = |word: &str, except: &[&str]| Word {
        word: word.to_owned(),
        instead: String::new(),
        except: except.iter().map(|e| (*e).to_owned()).collect(),
    };
    assert!(word("can not", &[]).occurs("It Can not, ever"));
    assert!(!word("texts", &[]).occurs("contexts"));
    assert!(!word("beside", &[]).occurs("--beside FILE") && word("beside", &[]).occurs("(beside)"));
    let is_no = word("is no", &["there is no"]);
    assert!(is_no.occurs("`x` is no parameter") && !is_no.occurs("There is no `x`"));
    assert!(!is_no.occurs("is not") && is_no.occurs("there is no y, and x is no z"));
    assert!(opens_with_what("It runs. What is left is said.") && opens_with_what("What it is"));
    assert!(!opens_with_what("What is missing?") && !opens_with_what("Say what it is."));
}

/// A retired word or phrase.
struct Word {
    word: String,
    instead: String,
    /// Phrases that contain it and are fine.
    except: Vec<String>,
}

impl Word {
    fn occurs(&self, text: &str) -> bool {
        let mut text = text.to_lowercase();
        for fine in &self.except {
            text = text.replace(fine.as_str(), "");
        }
        let inside = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || "_-".contains(c));
        text.match_indices(&self.word).any(|(at, word)| {
            !inside(text[..at].chars().next_back())
                && !inside(text[at + word.len()..].chars().next())
        })
    }
}

/// The table of `docs/glossary.md`.
fn retired() -> Vec<Word> {
    let page = fs::read_to_string(root().join("docs/glossary.md")).expect("the glossary");
    let rows = page.lines().skip_while(|line| *line != "## Retired words");
    let rows = rows.filter(|line| line.starts_with("| `"));
    let words: Vec<Word> = rows
        .map(|row| {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let quoted = |cell: &str| -> Vec<String> {
                cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
            };
            Word {
                word: quoted(cells[1]).remove(0),
                instead: cells[2].to_owned(),
                except: quoted(cells[3]),
            }
        })
        .collect();
    assert!(words.len() > 30, "docs/glossary.md has no table of retired words");
    words
}

/// Lines with retired words, or sentences that begin with a nominal "What".
fn check_prose(place: &str, prose: &[(usize, String)], words: &[Word]) -> Vec<String> {
    let mut broken = Vec::new();
    for (line, text) in prose {
        for word in words.iter().filter(|word| word.occurs(text)) {
            broken.push(format!("{place}:{line}: `{}`: write {}", word.word, word.instead));
        }
        if opens_with_what(text) {
            broken
                .push(format!("{place}:{line}: a sentence begins with `What`: begin with a noun"));
        }
    }
    broken
}

/// A sentence that is not a question begins with "What".
fn opens_with_what(text: &str) -> bool {
    let starts = text.match_indices("What ").filter(|(at, _)| {
        let before = text[..*at].trim_end();
        before.is_empty() || before.ends_with(['.', ':', '|', '"'])
    });
    starts.into_iter().any(|(at, _)| {
        let end = text[at..].find(['.', '?', '|']);
        !end.is_some_and(|end| text[at + end..].starts_with('?'))
    })
}

/// The prose of a page with line numbers: no code. Of the glossary no tables.
fn prose(page: &str, without_tables: bool) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut fenced = false;
    for (line, text) in lines(page) {
        if text.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !(fenced || without_tables && text.starts_with('|')) {
            let plain: String = text.split('`').step_by(2).collect::<Vec<_>>().join("``");
            found.push((line, plain));
        }
    }
    found
}

fn lines(text: &str) -> Vec<(usize, String)> {
    text.lines().enumerate().map(|(k, line)| (k + 1, line.to_owned())).collect()
}

/// The string literals outside of tests and documentation comments.
fn collect(stream: TokenStream, found: &mut Vec<(usize, String)>) {
    let mut trees = stream.into_iter().peekable();
    let mut skipping = false;
    while let Some(tree) = trees.next() {
        match tree {
            // `#[doc = "..."]`, `#[cfg(test)]` with the item below it, and other attributes.
            TokenTree::Punct(sign) if sign.as_char() == '#' => {
                if matches!(trees.peek(), Some(TokenTree::Punct(p)) if p.as_char() == '!') {
                    trees.next();
                }
                if let Some(TokenTree::Group(attribute)) = trees.next() {
                    let text = attribute.stream().to_string().replace(' ', "");
                    skipping |= text == "cfg(test)" || text == "test";
                }
            }
            TokenTree::Punct(sign) if sign.as_char() == ';' => skipping = false,
            TokenTree::Group(group) => {
                if !skipping {
                    collect(group.stream(), found);
                }
                if group.delimiter() == proc_macro2::Delimiter::Brace {
                    skipping = false;
                }
            }
            TokenTree::Literal(literal) if !skipping => {
                let text = literal.to_string();
                // Without a space it is a name or a key.
                if text.starts_with(['"', 'r']) && text.contains(' ') {
                    let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
                    found.push((literal.span().start().line, one_line.replace("\\ ", "")));
                }
            }
            _ => {}
        }
    }
}

/// The files of a folder and all folders in it, sorted.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the project").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
