//! `mocc doc`: writes pages of a library that open from disk.

use std::path::Path;

use super::args::model::is_standard;
use super::args::project::{Doc, PageFormat};
use super::{Status, modelica_path, print, standard_input};
use crate::doc::classes::Classes;
use crate::doc::pictures::Pictures;
use crate::doc::{html, markdown};
use crate::driver::catalogue::{Parsed, kind, list, parsed, tree};
use crate::driver::compile::{Request, Session};
use crate::driver::files::{is_shipped, read, top_level};
use crate::io::atomic_file::{create_folder, write_file};
use crate::report::schematic::{draw, picture};

/// Pictures of classes next to the pages: `pictures/NAME.svg`.
const PICTURES: &str = "pictures";

/// Runs the command.
pub fn run(options: &Doc) -> Status {
    match make(options) {
        Ok(text) if options.quiet => {
            drop(text);
            Status::Done
        }
        Ok(text) => print(&text),
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

fn make(options: &Doc) -> Result<String, String> {
    if let Some(folder) = options.folders.iter().find(|folder| !folder.is_dir()) {
        return Err(format!("there is no folder `{}`", folder.display()));
    }
    let mut request = Request {
        folders: options.folders.clone(),
        modelica_path: modelica_path(),
        ..Request::new(None, None)
    };
    let own = match &options.path {
        None => shipped(&request),
        Some(path) if is_standard(path) => {
            let text = standard_input();
            let mut out = Vec::new();
            parsed(&text, Path::new("stdin.mo"), "", &mut out);
            (request.file, request.text) = (Some(path.clone()), Some(text));
            out
        }
        Some(path) if path.is_dir() => of_folder(path, &mut request)?,
        Some(path) => {
            let text =
                read(path).map_err(|why| format!("cannot read {}: {why}", path.display()))?;
            let mut out = Vec::new();
            parsed(&text, path, "", &mut out);
            request.file = Some(path.clone());
            out
        }
    };
    if own.is_empty() {
        let path = options.path.as_deref().unwrap_or(Path::new("the library"));
        return Err(format!("{} has no Modelica classes", path.display()));
    }
    let others = match &options.path {
        None => Vec::new(),
        Some(_) => shipped(&request),
    };
    let classes = Classes::new(own, others);
    let diagram = |name: &str| diagram(&request, &classes, name);
    let own = |name: &str| {
        let path = format!("{PICTURES}/{name}.svg");
        options.output.join(&path).is_file().then_some(path)
    };
    let pictures = Pictures { own: &own, diagram: &diagram };
    let all = match options.format {
        PageFormat::Html => html::pages(&classes, &pictures),
        PageFormat::Markdown => markdown::pages(&classes, &pictures),
    };
    for (name, text) in &all {
        let path = options.output.join(name);
        create_folder(path.parent().unwrap_or(&options.output)).map_err(|e| e.to_string())?;
        write_file(path, text.as_bytes()).map_err(|e| e.to_string())?;
    }
    let pages = all.iter().filter(|(name, _)| !name.ends_with(".svg")).count();
    let index = options.output.join(all.first().map_or("", |(name, _)| name));
    Ok(format!("wrote {pages} pages, {}\n", index.display()))
}

/// The classes of the library in the binary.
fn shipped(request: &Request) -> Vec<Parsed> {
    let all = list(request, "").unwrap_or_default();
    let own = all.iter().filter(|package| is_shipped(&package.name));
    own.flat_map(|package| tree(request, &package.name)).collect()
}

/// The classes of a package, or of all packages in a folder.
fn of_folder(path: &Path, request: &mut Request) -> Result<Vec<Parsed>, String> {
    let absolute = path.canonicalize().map_err(|e| format!("{}: {e}", path.display()))?;
    let is_package = |folder: &Path| folder.join("package.mo").is_file();
    // A package inside of packages has the names of all of them.
    let inside: Vec<&Path> = absolute.ancestors().take_while(|f| is_package(f)).collect();
    let (folder, names) = match inside.last().and_then(|root| Some((root, root.parent()?))) {
        Some((_, parent)) => {
            let parts = inside.iter().rev().filter_map(|f| f.file_name());
            let parts: Vec<String> = parts.map(|n| n.to_string_lossy().into_owned()).collect();
            (parent.to_owned(), vec![parts.join(".")])
        }
        None => {
            let names = top_level(path).map_err(|why| format!("{}: {why}", path.display()))?;
            (path.to_owned(), names)
        }
    };
    request.folders.insert(0, folder);
    Ok(names.iter().flat_map(|name| tree(request, name)).collect())
}

/// The drawing of a model with connected components; empty where there is none.
fn diagram(request: &Request, classes: &Classes, name: &str) -> String {
    let found = classes.all.iter().find(|p| p.name == name);
    let is_model =
        found.is_some_and(|p| matches!(kind(&p.class), "model" | "block") && !p.class.partial);
    if !is_model {
        return String::new();
    }
    let own = Request { model: Some(name.to_owned()), ..request.clone() };
    let Ok((_, assembly)) = Session::default().flatten_with_assembly(&own) else {
        return String::new();
    };
    let Some(found) = picture(&assembly, 0).filter(|_| !assembly.links.is_empty()) else {
        return String::new();
    };
    draw::svg(&found, &assembly, &|_| Vec::new(), &|_| String::new())
}
