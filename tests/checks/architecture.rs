//! The tables of ARCHITECTURE.md hold: who imports whom, and which file alone uses a crate.
//!
//! Imports and effects are checked in the program only: its tests may use every stage to make their
//! input, and files to hold it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

#[test]
fn imports_follow_the_table() {
    let table = imports();
    let mut broken = Vec::new();
    let mut used = BTreeSet::new();
    for file in program() {
        let module = module_of(&file);
        let Some(row) = table.iter().position(|row| row.holds(&module)) else {
            if table.iter().any(|row| within(&row.modules[0], &module)) {
                continue; // A list of modules that have rows.
            }
            broken.push(format!("{file}:1: `{module}` has no row in the table of imports"));
            continue;
        };
        for (line, path) in paths(&without_tests(tokens(&file))) {
            let Some(path) = absolute(&path, &module) else { continue };
            if table[row].holds(&path) {
                continue;
            }
            match table[row].allowed.iter().find(|allowed| within(&path, allowed)) {
                Some(allowed) => _ = used.insert((row, allowed.as_str())),
                None => broken.push(format!(
                    "{file}:{line}: `{}` may not import `{path}`, only {}",
                    table[row].modules[0],
                    table[row].allowed.join(", ")
                )),
            }
        }
    }
    for (i, row) in table.iter().enumerate() {
        for to in row.allowed.iter().filter(|to| !used.contains(&(i, to.as_str()))) {
            broken.push(format!("ARCHITECTURE.md: `{}` does not import `{to}`", row.modules[0]));
        }
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn nothing_imports_what_stands_below_it() {
    let table = imports();
    for (i, row) in table.iter().enumerate() {
        for to in &row.allowed {
            assert!(
                table[..i].iter().any(|above| above.holds(to)),
                "ARCHITECTURE.md: `{}` imports `{to}`, which does not stand above it",
                row.modules[0]
            );
        }
    }
}

#[test]
fn every_crate_has_its_door() {
    let doors = doors("## Doors");
    let files =
        ["src", "grammar", "benches", "tests", "python"].into_iter().flat_map(|f| files(f, "rs"));
    let mut broken = outside(&doors, files.map(|file| (tokens(&file), file)));
    for name in dependencies().into_iter().filter(|name| !doors.contains_key(name)) {
        broken.push(format!("ARCHITECTURE.md: the dependency `{name}` has no door"));
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn effects_stay_at_the_edges() {
    let files = program().into_iter().map(|file| (without_tests(tokens(&file)), file));
    let broken = outside(&doors("## Effects"), files);
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

/// Uses of what has a door elsewhere, and doors that nothing goes through.
fn outside(
    doors: &BTreeMap<String, Vec<String>>,
    files: impl Iterator<Item = (Vec<Token>, String)>,
) -> Vec<String> {
    let mut broken = Vec::new();
    let mut used = BTreeSet::new();
    for (tokens, file) in files {
        for (line, path) in paths(&tokens) {
            let path = path.join("::");
            for (name, allowed) in doors.iter().filter(|(name, _)| within(&path, name)) {
                let open = |f: &&String| **f == file || f.ends_with('/') && file.starts_with(*f);
                match allowed.iter().find(open) {
                    Some(allowed) => _ = used.insert((name, allowed)),
                    None => broken.push(format!(
                        "{file}:{line}: `{path}`: `{name}` is for {} only",
                        allowed.join(", ")
                    )),
                }
            }
        }
    }
    for (name, allowed) in doors {
        for place in allowed.iter().filter(|place| !used.contains(&(name, *place))) {
            broken.push(format!("ARCHITECTURE.md: `{name}` is not used by {place}"));
        }
    }
    broken
}

#[test]
fn paths_are_read_from_all_forms_of_code() {
    let read = |text: &str| {
        let tokens = without_tests(flat(text.parse().expect("tokens")));
        paths(&tokens).into_iter().map(|(line, path)| (line, path.join("::"))).collect::<Vec<_>>()
    };
    let found = |line: usize, path: &str| (line, path.to_owned());
    assert_eq!(
        read("use crate::ir::{ast, flat::{A, self as f}};\nlet x = \"crate::no\"; // crate::no"),
        [found(1, "crate::ir::ast"), found(1, "crate::ir::flat::A"), found(1, "crate::ir::flat")]
    );
    assert_eq!(read("m!(a.b(faer::Mat::<f64>::new()))"), [found(1, "faer::Mat")]);
    assert_eq!(
        read("#[cfg(test)]\nmod t { use crate::a; }\nfn f() { c::d() }"),
        [found(3, "c::d")]
    );
    assert_eq!(read("#[cfg(test)] mod t;\ne::f!()"), [found(2, "e::f")]);
    let path = ["super", "super", "x"].map(str::to_owned);
    assert_eq!(absolute(&path, "a::b::c"), Some("a::x".to_owned()));
    assert_eq!(absolute(&["crate".to_owned(), "x".to_owned()], "a::b"), Some("x".to_owned()));
    assert_eq!(absolute(&["std".to_owned(), "fs".to_owned()], "a::b"), None);
}

// ---- The tables ----

/// Modules, and what they may import besides each other.
struct Row {
    modules: Vec<String>,
    allowed: Vec<String>,
}

impl Row {
    fn holds(&self, path: &str) -> bool {
        self.modules.iter().any(|module| within(path, module))
    }
}

fn imports() -> Vec<Row> {
    let rows = cells("## Imports").into_iter();
    rows.map(|row| Row { modules: row[0].clone(), allowed: row[1].clone() }).collect()
}

/// Crate or module of the standard library to the files and folders that may use it.
fn doors(heading: &str) -> BTreeMap<String, Vec<String>> {
    let mut doors = BTreeMap::new();
    for row in cells(heading) {
        doors.extend(row[0].iter().map(|name| (name.clone(), row[1].clone())));
    }
    doors
}

/// The words in backquotes in each cell of the first table below a heading of ARCHITECTURE.md.
fn cells(heading: &str) -> Vec<Vec<Vec<String>>> {
    let quoted =
        |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let rows: Vec<_> = read(&root().join("ARCHITECTURE.md"))
        .lines()
        .skip_while(|line| *line != heading)
        .skip_while(|line| !line.starts_with('|'))
        .take_while(|line| line.starts_with('|'))
        .skip(2)
        .map(|line| line.split('|').skip(1).map(quoted).collect())
        .collect();
    assert!(rows.len() > 3, "ARCHITECTURE.md has no table below `{heading}`");
    rows
}

/// True for the path of `module` itself and of everything in it.
fn within(path: &str, module: &str) -> bool {
    path.strip_prefix(module).is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
}

/// The crates of others that the program uses, as Rust writes them.
fn dependencies() -> Vec<String> {
    let mut names = Vec::new();
    for folder in [".", "src/compiler", "src/engine"] {
        let text = read(&root().join(folder).join("Cargo.toml"));
        let mut listed = false;
        let before = names.len();
        for line in text.lines() {
            if line.starts_with('[') {
                listed = line.ends_with("dependencies]");
            } else if listed && let Some((name, _)) = line.split_once(" = ") {
                names.push(name.replace('-', "_"));
            }
        }
        assert!(names.len() > before + 3, "{folder}/Cargo.toml lists no dependencies");
    }
    names.retain(|name| !CRATES.contains(&name.as_str()));
    names
}

// ---- The program ----

/// The files that make up the library and the binary, without those for tests only.
pub fn program() -> Vec<String> {
    let tests = test_modules();
    let mut files = files("src", "rs");
    files.retain(|file| !tests.iter().any(|test| within(&module_of(file), test)));
    files.retain(|file| !file.ends_with("/lib.rs") && !file.ends_with("/build.rs"));
    files
}

/// The crates that make up the program.
const CRATES: [&str; 3] = ["mocc", "mocc_compiler", "mocc_engine"];

/// `src/engine/ir/dae.rs` is `ir::dae`, in whichever crate.
fn module_of(file: &str) -> String {
    let path = file.trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches("/mod");
    let path = path.strip_prefix("engine/").or(path.strip_prefix("compiler/")).unwrap_or(path);
    path.replace('/', "::")
}

/// Modules in files of their own that exist in tests only.
fn test_modules() -> Vec<String> {
    let mut found = Vec::new();
    for file in files("src", "rs") {
        let tokens = tokens(&file);
        for end in test_attributes(&tokens) {
            let mut declared = tokens[end..].iter().skip_while(|(_, word)| word != "mod").skip(1);
            if let (Some((_, name)), Some((_, semicolon))) = (declared.next(), declared.next())
                && semicolon == ";"
            {
                let module = module_of(&file);
                found.push(match module.as_str() {
                    "lib" => name.clone(),
                    _ => format!("{module}::{name}"),
                });
            }
        }
    }
    found
}

/// A path from `crate` or `super` relative to the crate; none for other crates and local names.
fn absolute(path: &[String], module: &str) -> Option<String> {
    let mut base = match path.first()?.as_str() {
        name if name == "crate" || CRATES.contains(&name) => Vec::new(),
        "super" => module.split("::").collect(),
        _ => return None,
    };
    for part in path {
        match part.as_str() {
            name if name == "crate" || CRATES.contains(&name) => {}
            "super" => _ = base.pop(),
            // A macro is exported at the root of the crate, wherever it is defined.
            "define_id" => base.extend(["base", "index"]),
            "causes" if base.is_empty() => base.extend(["base", "cause"]),
            part => base.push(part),
        }
    }
    Some(base.join("::"))
}

// ---- Rust as words ----

/// A word or a sign, with its line.
pub type Token = (usize, String);

pub fn tokens(file: &str) -> Vec<Token> {
    let text = read(&root().join(file));
    flat(text.parse().unwrap_or_else(|why| panic!("{file}: {why}")))
}

/// The tokens without nesting; `::` is one of them.
fn flat(stream: TokenStream) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for tree in stream {
        let line = tree.span().start().line;
        match tree {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::Parenthesis => ("(", ")"),
                    Delimiter::None => ("", ""),
                };
                out.push((line, open.to_owned()));
                out.extend(flat(group.stream()));
                out.push((group.span_close().start().line, close.to_owned()));
            }
            TokenTree::Punct(sign) if sign.as_char() == ':' => match out.last_mut() {
                Some((_, last)) if last == ":" => last.push(':'),
                _ => out.push((line, ":".to_owned())),
            },
            TokenTree::Literal(literal) => {
                let text = Some(literal.to_string()).filter(|text| text.starts_with('"'));
                out.push((line, text.unwrap_or_else(|| "\"\"".to_owned())));
            }
            tree => out.push((line, tree.to_string())),
        }
    }
    out
}

/// Where the attributes `#[cfg(test)]` end.
fn test_attributes(tokens: &[Token]) -> Vec<usize> {
    let attribute = ["#", "[", "cfg", "(", "test", ")", "]"];
    let ends = attribute.len()..tokens.len();
    ends.filter(|end| {
        tokens[..*end].iter().rev().zip(attribute.iter().rev()).all(|(t, a)| t.1 == *a)
    })
    .collect()
}

/// Without the items that exist in tests only.
pub fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut skipped = 0;
    let mut out = Vec::new();
    for end in test_attributes(&tokens) {
        out.extend_from_slice(&tokens[skipped.min(end)..end]);
        let mut depth = 0;
        skipped = end;
        for (_, token) in &tokens[end..] {
            skipped += 1;
            match token.as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                ";" => {}
                _ => continue,
            }
            if depth == 0 {
                break;
            }
        }
    }
    out.extend_from_slice(&tokens[skipped..]);
    out
}

/// Every path of two or more names, groups of a `use` written out.
pub fn paths(tokens: &[Token]) -> Vec<(usize, Vec<String>)> {
    let mut found = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let begins = is_name(&tokens[i].1) && (i == 0 || tokens[i - 1].1 != "::");
        if begins && tokens.get(i + 1).is_some_and(|(_, sign)| sign == "::") {
            i = branch(tokens, i, &[], &mut found);
        } else {
            i += 1;
        }
    }
    found
}

/// Reads the path at `i` behind `stem` with all its branches; gives where it ends.
fn branch(
    tokens: &[Token],
    mut i: usize,
    stem: &[String],
    found: &mut Vec<(usize, Vec<String>)>,
) -> usize {
    let mut path = stem.to_vec();
    let line = tokens[i].0;
    while let Some((_, token)) = tokens.get(i) {
        if token == "{" {
            i += 1;
            while tokens.get(i).is_some_and(|(_, token)| token != "}") {
                i = branch(tokens, i, &path, found);
                while tokens.get(i).is_some_and(|(_, token)| token != "}" && token != ",") {
                    i += 1;
                }
                i += usize::from(tokens.get(i).is_some_and(|(_, token)| token == ","));
            }
            return i + 1;
        }
        if !is_name(token) {
            break;
        }
        if token != "self" {
            path.push(token.clone());
        }
        i += 1;
        if tokens.get(i).is_none_or(|(_, token)| token != "::") {
            break;
        }
        i += 1;
    }
    found.push((line, path));
    i
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

// ---- Files ----

/// The files of a folder and all folders in it, relative to the project, sorted.
fn files(folder: &str, extension: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the project") {
            let path = entry.expect("an entry of the folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                let short = path.strip_prefix(root()).expect("a file of the project");
                found.push(short.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
