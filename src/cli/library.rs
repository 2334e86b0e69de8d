//! `mocc lib`: the sources of libraries, to list, read and copy.

use std::path::Path;

use super::args::project::{Library, LibraryCommand};
use super::{Status, modelica_path, print, print_result};
use crate::base::diag::did_you_mean;
use crate::driver::catalogue::{Listed, list, shipped, show};
use crate::driver::compile::Request;
use crate::io::atomic_file::{create_folder, write_file};

/// Runs the command.
pub fn run(options: &Library) -> Status {
    let request = Request {
        folders: options.folders.clone(),
        modelica_path: modelica_path(),
        ..Request::new(None, None)
    };
    if let Some(folder) = options.folders.iter().find(|folder| !folder.is_dir()) {
        return refused(&format!("there is no folder `{}`", folder.display()));
    }
    match &options.command {
        LibraryCommand::List { package } => {
            let package = package.as_deref().unwrap_or_default();
            match list(&request, package) {
                Some(classes) => print_result(&table(&classes)),
                None => refused(&unknown(&request, package)),
            }
        }
        LibraryCommand::Show { class } => match show(&request, class) {
            Some(shown) => {
                print_result(&format!("// {}:{}\n{}", shown.path.display(), shown.line, shown.text))
            }
            None => refused(&unknown(&request, class)),
        },
        LibraryCommand::Copy { folder } => match copy(folder) {
            Ok(count) => print(&format!("wrote {count} files to {}\n", folder.display())),
            Err(why) => refused(&why),
        },
    }
}

fn refused(why: &str) -> Status {
    eprintln!("error: {why}");
    Status::Usage
}

/// A line for each class: its name, its kind and its description.
fn table(classes: &[Listed]) -> String {
    let width = classes.iter().map(|c| c.name.len()).max().unwrap_or(0);
    let line = |c: &Listed| {
        let count = match (c.kind.as_str(), c.classes) {
            ("package", n) => format!(" ({n})"),
            _ => String::new(),
        };
        let text = format!("{:width$}  {:<10}{}{count}", c.name, c.kind, c.description);
        format!("{}\n", text.trim_end())
    };
    classes.iter().map(line).collect()
}

fn unknown(request: &Request, name: &str) -> String {
    let package = name.rsplit_once('.').map_or("", |(package, _)| package);
    let known = list(request, package).or_else(|| list(request, "")).unwrap_or_default();
    let near = did_you_mean(name, known.iter().map(|c| c.name.as_str()));
    let help = near.map_or("`mocc lib list` lists the packages".to_owned(), |n| {
        format!("did you mean `{n}`?")
    });
    format!("there is no class `{name}`\nhelp: {help}")
}

/// Writes the shipped library to a folder that does not have it yet.
fn copy(folder: &Path) -> Result<usize, String> {
    let files = shipped();
    if let Some((path, _)) = files.iter().find(|(path, _)| folder.join(path).exists()) {
        let path = folder.join(path);
        return Err(format!("{} exists already; name an empty folder", path.display()));
    }
    for (path, bytes) in &files {
        let path = folder.join(path);
        create_folder(path.parent().unwrap_or(folder)).map_err(|e| e.to_string())?;
        write_file(&path, bytes).map_err(|e| e.to_string())?;
    }
    Ok(files.len())
}
