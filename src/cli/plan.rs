//! `mocc plan`: a plan for a model and a folder of recordings, to be completed by hand.

use std::path::{Path, PathBuf};

use super::args::model::is_standard;
use super::args::study::PlanSkeleton;
use super::{Status, print, print_result, say};
use crate::calibrate::skeleton::skeleton;
use crate::driver::compile::Session;
use crate::driver::files::tables;
use crate::io::atomic_file::write_file;
use crate::io::csv::read_text;

/// Runs the command.
pub fn run(options: &PlanSkeleton) -> Status {
    if is_standard(&options.file) {
        eprintln!("error: a plan names the file of its model; save the model, and give its file");
        return Status::Usage;
    }
    let mut session = Session { is_last: true, ..Session::default() };
    let flat = session.flatten(&options.request());
    say(&session);
    let flat = match flat {
        Ok(flat) => flat,
        Err(error) => return error.into(),
    };
    let text = plan(options, &flat);
    match text {
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
        Ok(text) => match &options.output {
            None => print_result(&text),
            Some(path) if is_standard(path) => print_result(&text),
            Some(path) if path.exists() => {
                eprintln!("error: {} exists already; choose another name", path.display());
                Status::Usage
            }
            Some(path) => match write_file(path, text.as_bytes()) {
                Ok(()) => print(&format!("wrote {}\n", path.display())),
                Err(why) => {
                    eprintln!("error: {why}");
                    Status::Usage
                }
            },
        },
    }
}

fn plan(options: &PlanSkeleton, flat: &crate::ir::flat::FlatModel) -> Result<String, String> {
    let mut read = Vec::new();
    for path in tables(&options.data)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        read.push((name, read_text(&path).map_err(|e| e.to_string())?));
    }
    let own = options.output.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let model = relative(&options.file, own);
    skeleton(flat, &model, &relative(&options.data, own), &read)
        .map_err(|why| format!("{}: {why}", options.data.display()))
}

/// A path as seen from a folder.
fn relative(path: &Path, folder: &Path) -> String {
    let absolute = |path: &Path| {
        let path = if path == Path::new("") { Path::new(".") } else { path };
        path.canonicalize().unwrap_or_else(|_| path.to_owned())
    };
    let (to, from) = (absolute(path), absolute(folder));
    let common = to.iter().zip(from.iter()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path.display().to_string();
    }
    let up = from.iter().skip(common).map(|_| "..".into());
    let out: PathBuf = up.chain(to.iter().skip(common).map(PathBuf::from)).collect();
    let out = out.to_string_lossy().replace('\\', "/");
    if out.is_empty() { ".".to_owned() } else { out }
}
