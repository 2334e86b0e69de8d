//! The pages of `docs/library/` say what the sources of `lib/` say.
//!
//! After a change of the library, `DOCS_UPDATE=1 cargo test --test all library` writes the pages again.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use super::door::Scratch;
use super::program::mocc;

#[test]
fn library_pages_are_up_to_date() {
    let folder = root().join("docs/library");
    let packages = packages();
    let mut pages = vec![("README.md".to_owned(), index(&packages))];
    pages.extend(packages.iter().map(|p| (format!("{}.md", p.class.name), page(p))));
    let mut stale = Vec::new();
    for (name, text) in pages {
        let path = folder.join(&name);
        if std::env::var_os("DOCS_UPDATE").is_some() {
            fs::create_dir_all(&folder).expect("a folder");
            fs::write(&path, &text).expect("a page");
        } else if fs::read_to_string(&path).ok() != Some(text) {
            stale.push(format!("docs/library/{name}"));
        }
    }
    let cure = "DOCS_UPDATE=1 cargo test --test all library";
    assert!(stale.is_empty(), "{} differ from lib/; run {cure}", stale.join(", "));
}

#[test]
fn every_effect_has_a_formula() {
    let packages = packages();
    let effects = packages.iter().find(|p| p.class.name == "Effects").expect("the effects");
    for class in effects.classes.iter().filter(|c| !c.effect.is_empty()) {
        assert!(
            class.comment.iter().any(|line| line.starts_with("  ")),
            "lib/Effects/{}.mo: no indented formula in the comment at its head",
            class.name
        );
    }
}

/// The models of the pictures compile, and every picture belongs to a class.
#[test]
fn pictures_belong_to_classes() {
    let pictures = "docs/library/pictures";
    let folder = Scratch::new();
    let models = root().join(pictures).join("pictures.mol").display().to_string();
    let ended = mocc(folder.path(), &["check", &models]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let packages = packages();
    for entry in fs::read_dir(root().join(pictures)).expect("pictures").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some((package, class)) = name.strip_suffix(".svg").and_then(|n| n.split_once('.'))
        else {
            continue;
        };
        let package = packages.iter().find(|p| p.class.name == package);
        let exists = package.is_some_and(|p| p.classes.iter().any(|c| c.name == class));
        assert!(exists, "{pictures}/{name} belongs to no class of lib/");
    }
}

/// A package of the library with its classes in order.
struct Package {
    class: Class,
    types: Vec<[String; 3]>,
    classes: Vec<Class>,
}

/// One class, as its file shows it.
#[derive(Default)]
struct Class {
    name: String,
    kind: String,
    description: String,
    /// The comment at its head, line by line; formulas are indented by two spaces.
    comment: Vec<String>,
    base: String,
    /// Type, name, default and description of parameters, constants, inputs, outputs, and the
    /// variables of a connector.
    parameters: Vec<[String; 4]>,
    ports: Vec<[String; 3]>,
    /// Entries `effect` and `explains` of its annotation.
    effect: String,
    explains: String,
}

// ---- Pages ----

fn index(packages: &[Package]) -> String {
    let mut out = String::from(
        "# Library\n\n\
         mocc ships this library; models use it without an import.\n\
         All values are in SI units.\n\n\
         These pages are generated from the sources in `lib/`.\n\n\
         | package | content |\n|---|---|\n",
    );
    for package in packages {
        let class = &package.class;
        _ = writeln!(out, "| [{0}]({0}.md) | {1} |", class.name, class.description);
    }
    out
}

fn page(package: &Package) -> String {
    let name = &package.class.name;
    let mut out = format!("# {name}\n\n{}.\n", package.class.description);
    comment(&mut out, &package.class.comment);
    _ = writeln!(out, "\nThis page is generated from the sources in `lib/{name}/`.");
    if !package.types.is_empty() {
        out += "\n| type | definition | description |\n|---|---|---|\n";
        for [name, definition, description] in &package.types {
            _ = writeln!(out, "| `{name}` | {definition} | {description} |");
        }
    }
    let is_internal = |c: &&Class| c.kind.starts_with("partial");
    for class in package.classes.iter().filter(|c| !is_internal(c)) {
        section(&mut out, package, class);
    }
    let bases: Vec<&Class> = package.classes.iter().filter(is_internal).collect();
    if !bases.is_empty() {
        out += "\n## Base classes\n\n| class | description |\n|---|---|\n";
    }
    for class in &bases {
        _ = writeln!(out, "| `{}` | {} |", class.name, class.description);
    }
    for class in bases.iter().filter(|class| !class.comment.is_empty()) {
        _ = writeln!(out, "\n### {}", class.name);
        comment(&mut out, &class.comment);
    }
    out
}

fn section(out: &mut String, package: &Package, class: &Class) {
    _ = writeln!(out, "\n## {}\n\n*{}.* {}.", class.name, class.kind, class.description);
    comment(out, &class.comment);
    let picture = format!("pictures/{}.{}.svg", package.class.name, class.name);
    if root().join("docs/library").join(&picture).exists() {
        _ = writeln!(out, "\n![{}]({picture})", class.description);
    }
    let inherited = bases(package, class);
    let parameters: Vec<_> = inherited.iter().flat_map(|c| &c.parameters).collect();
    if !parameters.is_empty() {
        let heading = if class.kind == "connector" { "variable" } else { "parameter" };
        _ = writeln!(out, "\n| {heading} | type | default | description |\n|---|---|---|---|");
        for [kind, name, default, description] in parameters {
            _ = writeln!(out, "| `{name}` | `{kind}` | {} | {description} |", code(default));
        }
    }
    let ports: Vec<_> = inherited.iter().flat_map(|c| &c.ports).collect();
    if !ports.is_empty() {
        out.push_str("\n| connector | type | description |\n|---|---|---|\n");
        for [kind, name, description] in ports {
            _ = writeln!(out, "| `{name}` | `{kind}` | {description} |");
        }
    }
    if !class.effect.is_empty() {
        _ = writeln!(out, "\nDiagnosis: \"{}\"  ", class.explains.replace("%at", "*component*"));
        _ = writeln!(out, "Annotation: `{}`", class.effect);
    }
}

/// The bases of a class in the same package, from the root down, and the class itself.
fn bases<'a>(package: &'a Package, class: &'a Class) -> Vec<&'a Class> {
    let mut chain = vec![class];
    while let Some(base) = package.classes.iter().find(|c| c.name == chain[0].base) {
        chain.insert(0, base);
    }
    chain
}

/// Prose as paragraphs, indented lines as code.
fn comment(out: &mut String, lines: &[String]) {
    let mut fenced = false;
    for (k, line) in lines.iter().enumerate() {
        let formula = line.starts_with("  ");
        let source = line.starts_with("Source:");
        if formula != fenced {
            out.push_str(if formula { "\n```text\n" } else { "```\n" });
            fenced = formula;
        }
        if !formula && (k == 0 || lines[k - 1].starts_with("  ") || source) {
            out.push('\n');
        }
        let line = if formula { line[2..].to_owned() } else { escaped(line) };
        out.push_str(&line);
        out.push('\n');
    }
    if fenced {
        out.push_str("```\n");
    }
}

/// Prose in which signs of Markdown mean themselves.
fn escaped(text: &str) -> String {
    text.replace('*', "\\*").replace('<', "&lt;").replace('_', "\\_")
}

fn code(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{}`", text.replace('|', "\\|")) }
}

// ---- Sources ----

fn packages() -> Vec<Package> {
    let mut folders: Vec<PathBuf> = fs::read_dir(root().join("lib"))
        .expect("the library")
        .map(|entry| entry.expect("a folder").path())
        .collect();
    folders.sort();
    folders.iter().map(|folder| package(folder)).collect()
}

fn package(folder: &Path) -> Package {
    let source = read(&folder.join("package.mo"));
    let order = read(&folder.join("package.order"));
    let classes = order
        .lines()
        .filter_map(|name| {
            let path = folder.join(format!("{name}.mo"));
            path.exists().then(|| class(&read(&path)))
        })
        .collect();
    Package { class: class(&source), types: types(&source), classes }
}

/// Reads one class. The files of the library keep to one form: a declaration a line.
fn class(source: &str) -> Class {
    let mut found = Class::default();
    let mut lines = source.lines().filter(|line| !line.starts_with("within"));
    let head = lines.next().expect("a class");
    let words: Vec<&str> = head.split('"').next().unwrap_or_default().split_whitespace().collect();
    let (name, kind) = words.split_last().expect("a class with a name");
    (found.name, found.kind) = ((*name).to_owned(), kind.join(" "));
    found.description = quoted(head);
    let mut at_head = true;
    let mut public = true;
    for line in lines {
        let text = line.trim_start();
        if let Some(comment) = text.strip_prefix("//") {
            if at_head {
                found.comment.push(comment.strip_prefix(' ').unwrap_or(comment).to_owned());
            }
            continue;
        }
        at_head = false;
        if let Some(base) = text.strip_prefix("extends ") {
            found.base = base.split([';', '(', '.']).next().unwrap_or_default().to_owned();
        }
        public &= !["protected", "equation", "algorithm"].contains(&text);
        if let Some(entry) = text.strip_prefix("effect ") {
            found.effect = quoted(entry);
        } else if let Some(entry) = text.strip_prefix("explains ") {
            found.explains = quoted(entry);
        } else if public && line.starts_with("  ") && !line.starts_with("   ") {
            declaration(text, &mut found);
        }
    }
    found
}

/// A parameter, input, output or connector.
fn declaration(text: &str, found: &mut Class) {
    let (before, description) = match text.rfind(" \"") {
        Some(at) if text.ends_with("\";") => (&text[..at], quoted(&text[at..])),
        _ => (text.trim_end_matches(';'), String::new()),
    };
    let words: Vec<&str> = before.split_whitespace().collect();
    match words.as_slice() {
        [prefix @ ("parameter" | "input" | "output" | "constant"), kind, rest @ ..]
            if !rest.is_empty() =>
        {
            let rest = rest.join(" ");
            let (name, default) = match rest.split_once('=') {
                Some((name, default)) => (name.trim(), default.trim()),
                None => (rest.as_str(), ""),
            };
            // `d(unit = "N.s/m") = 0`: the attributes belong to the type.
            let (kind, name, default) = match rest.split_once('(') {
                Some((name, more)) if name.len() < rest.find('=').unwrap_or(usize::MAX) => {
                    let (attributes, default) = more.split_once(')').unwrap_or((more, ""));
                    let default = default.trim_start_matches([' ', '=']);
                    (format!("{kind}({attributes})"), name, default)
                }
                _ => ((*kind).to_owned(), name, default),
            };
            let kind = if *prefix == "parameter" { kind } else { format!("{prefix} {kind}") };
            found.parameters.push([kind, name.to_owned(), default.to_owned(), description]);
        }
        ["flow", kind, name] if found.kind == "connector" => {
            let row = [format!("flow {kind}"), (*name).to_owned(), String::new(), description];
            found.parameters.push(row);
        }
        [kind, name] if found.kind == "connector" => {
            let row = [(*kind).to_owned(), (*name).to_owned(), String::new(), description];
            found.parameters.push(row);
        }
        [kind, name] if ["Flange", "Port"].iter().any(|end| kind.ends_with(end)) => {
            found.ports.push([(*kind).to_owned(), (*name).to_owned(), description]);
        }
        _ => {}
    }
}

/// The types that a package declares itself: name, definition, description.
fn types(source: &str) -> Vec<[String; 3]> {
    let mut found = Vec::new();
    let text = source.replace("\n    ", " ");
    for line in text.lines().filter_map(|line| line.strip_prefix("  type ")) {
        let (name, definition) = line.split_once('=').expect("a definition");
        let definition = definition.trim();
        let (definition, description) = match definition.split_once(") \"") {
            Some((definition, _)) => (format!("{definition})"), quoted(&definition_end(line))),
            None => (definition.trim_end_matches(';').to_owned(), String::new()),
        };
        found.push([name.trim().to_owned(), shown(&definition), description]);
    }
    found
}

fn definition_end(line: &str) -> String {
    line.rsplit_once(") \"").map(|(_, end)| format!("\"{end}")).unwrap_or_default()
}

/// `Real(...)` as its unit, an enumeration as a list.
fn shown(definition: &str) -> String {
    if let Some(list) = definition.strip_prefix("enumeration(") {
        let literals: Vec<String> = list
            .trim_end_matches(')')
            .split("\",")
            .map(|literal| {
                let name = literal.split_whitespace().next().unwrap_or_default();
                format!("`{name}`: {}", quoted(&format!("{}\"", literal.trim_end_matches('"'))))
            })
            .collect();
        return literals.join("; ");
    }
    match definition.split_once("unit = \"") {
        Some((_, unit)) => format!("`Real`, `{}`", unit.split('"').next().unwrap_or_default()),
        None => format!("`{definition}`"),
    }
}

/// The first string in quotes.
fn quoted(text: &str) -> String {
    text.split('"').nth(1).unwrap_or_default().to_owned()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
