//! `mocc new`: a project that runs, to begin with.

use std::path::PathBuf;

use super::args::project::New;
use super::{Status, print};
use crate::driver::files::{is_shipped, template};
use crate::io::atomic_file::{create_folder, write_file};

/// The name in the templates, as that of the files and of the model.
const FILE: &str = "starter";
const MODEL: &str = "Starter";

/// Runs the command.
pub fn run(options: &New) -> Status {
    match create(options) {
        Ok(text) => print(&text),
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

fn create(options: &New) -> Result<String, String> {
    let folder = &options.name;
    let stem = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !stem.starts_with(|c: char| c.is_ascii_alphabetic()) || !stem.chars().all(is_word) {
        return Err(format!(
            "`{stem}` cannot be the name of a model: use letters, digits, `_` and `-`, a letter first"
        ));
    }
    if folder.exists() {
        return Err(format!("{} exists already; choose another name", folder.display()));
    }
    let model = model_name(&stem);
    let replaced = |text: &str| text.replace(FILE, &stem).replace(MODEL, &model);
    let mut written: Vec<PathBuf> = Vec::new();
    for (path, bytes) in template(options.template.name()) {
        let path = folder.join(replaced(&path.to_string_lossy()));
        create_folder(path.parent().unwrap_or(folder)).map_err(|e| e.to_string())?;
        let is_data = path.extension().is_some_and(|e| e == "csv");
        let text = String::from_utf8_lossy(bytes);
        let text = if is_data { text.into_owned() } else { replaced(&text) };
        write_file(&path, text.as_bytes()).map_err(|e| e.to_string())?;
        written.push(path);
    }
    let list: String = written.iter().map(|path| format!("  {}\n", path.display())).collect();
    Ok(format!(
        "wrote\n{list}Next: `cd {}`, then `mocc simulate {stem}.mol` and `mocc test`.\n",
        folder.display()
    ))
}

/// Names that every model uses, and the library of others: a model of such a name would hide them.
const TAKEN: [&str; 5] = ["Real", "Integer", "Boolean", "String", "Modelica"];

/// `ServoValve` for `servo_valve`, and `ThermalModel` for `thermal`: a model would hide the package of its name.
fn model_name(stem: &str) -> String {
    let parts = stem.split(['_', '-']).filter(|part| !part.is_empty());
    let name: String = parts.map(|part| part[..1].to_ascii_uppercase() + &part[1..]).collect();
    let is_taken = is_shipped(&name) || TAKEN.contains(&name.as_str());
    if is_taken { name + "Model" } else { name }
}
