//! Classes of the files of a client by parts of their names, and the arguments of calls.

use std::sync::atomic::{AtomicBool, Ordering};

use super::outline::tree;
use super::position::Lines;
use super::workspace::{Workspace, root};
use crate::driver::catalogue::kind;
use crate::driver::compile::{Request, Session};
use crate::driver::sources::{is_modelica, modelica_files};
use crate::io::json::Json;
use crate::ir::ast::{Class, ClassBody, ElementKind};

/// Symbols of an answer at most.
const MOST: usize = 200;

/// The classes whose names contain a text, in any case; nothing if the answer is no longer wanted.
pub fn classes(workspace: &Workspace, query: &str, is_cancelled: &AtomicBool) -> Json {
    let query = query.to_lowercase();
    let open = || workspace.open.paths().filter(|file| is_modelica(file));
    let mut folders: Vec<_> = open().filter_map(|file| root(file)).collect();
    folders.extend(workspace.folders.iter().cloned());
    let mut files = modelica_files(&folders, &[]).files;
    files.extend(open().cloned());
    let mut out = Vec::new();
    for file in files {
        if is_cancelled.load(Ordering::Relaxed) || out.len() >= MOST {
            break;
        }
        let Some(text) = workspace.text(&file) else { continue };
        if !text.to_lowercase().contains(&query) {
            continue;
        }
        let (tree, lines) = (tree(&text), Lines::of(&text));
        let address = workspace.address(&file);
        let within = tree.package().map(ToString::to_string).unwrap_or_default();
        let mut waiting: Vec<(String, &Class)> =
            tree.classes.iter().rev().map(|class| (within.clone(), &**class)).collect();
        while let Some((around, class)) = waiting.pop() {
            let name = class.name.name.to_string();
            if name.to_lowercase().contains(&query) {
                out.push(symbol(&name, &around, class, &address, &lines));
            }
            let ClassBody::Long(own) = &class.body else { continue };
            let full = if around.is_empty() { name } else { format!("{around}.{name}") };
            let inner = own.elements.iter().rev().filter_map(|element| match &element.kind {
                ElementKind::Class(inner) => Some((full.clone(), &**inner)),
                _ => None,
            });
            waiting.extend(inner);
        }
    }
    out.truncate(MOST);
    Json::list(out)
}

fn symbol(name: &str, around: &str, class: &Class, address: &str, lines: &Lines<'_>) -> Json {
    let number = match kind(class) {
        "package" => 4,
        "function" => 12,
        "connector" => 11,
        _ => 5,
    };
    let place = lines.place((class.name.span.start, class.name.span.end));
    let location = Json::object([("uri", Json::text(address)), ("range", place)]);
    Json::object([
        ("name", Json::text(name)),
        ("kind", Json::count(number)),
        ("containerName", Json::text(around)),
        ("location", location),
    ])
}

/// The function that is called at a place, with its arguments.
pub fn signature(request: &Request, offset: usize) -> Option<Json> {
    let found = Session::default().signature(request, offset as u32)?;
    let texts: Vec<&str> = found.parameters.iter().map(|p| p.text.as_str()).collect();
    let label = format!("{}({})", found.name, texts.join(", "));
    let parameter = |p: &crate::driver::call::Parameter| {
        Json::object([
            ("label", Json::text(p.text.as_str())),
            ("documentation", Json::text(p.description.as_str())),
        ])
    };
    let signature = Json::object([
        ("label", Json::text(label)),
        ("documentation", Json::text(found.description.as_str())),
        ("parameters", Json::list(found.parameters.iter().map(parameter))),
    ]);
    Some(Json::object([
        ("signatures", Json::list([signature])),
        ("activeSignature", Json::count(0)),
        ("activeParameter", Json::count(found.active)),
    ]))
}
