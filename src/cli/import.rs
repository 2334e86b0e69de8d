//! `mocc import`: writes a block that uses an FMU as a component of models.

use std::path::{Path, PathBuf};

use super::args::export::Import;
use super::args::model::is_standard;
use super::{Status, explain, print, style, write_result};
use crate::base::diag::Diagnostic;
use crate::base::render::render;
use crate::base::source::{SourceMap, Span};
use crate::fmu::cause::FmuCause;
use crate::fmu::import::{block, model};
use crate::ir::foreign::ForeignModel;

/// Runs the command. The FMU is read, but its code is not loaded.
pub fn run(options: &Import) -> Status {
    if is_standard(&options.file) {
        eprintln!("error: a block names the file of its FMU; save the FMU, and give its file");
        return Status::Usage;
    }
    let stem = options.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let class = options.name.clone().or(stem).unwrap_or_default();
    let output = options.output.clone().unwrap_or_else(|| PathBuf::from(format!("{class}.mo")));
    if options.output.is_none() && block::is_of_others(&output) {
        let path = output.display();
        eprintln!("error: `{path}` exists, and `mocc import` has not written it");
        eprintln!("  = help: name another file with `-o FILE`, or move this one away");
        return Status::Usage;
    }
    let fmu = match model::open(&options.file, model::Integrating::RatherThere) {
        Ok(fmu) => fmu,
        Err(diagnostic) => return refuse(&diagnostic),
    };
    let interface = fmu.interface();
    let file = named_in(&options.file, &output);
    let text = block::block(interface, &class, &file, fmu.token());
    let written = match write_result(&output, text.as_bytes()) {
        Ok(line) => line,
        Err(why) => {
            let path = output.display().to_string();
            return refuse(&Diagnostic::new(FmuCause::FileOfFmu { path, why }, Span::NONE));
        }
    };
    let indented = if written.is_empty() { written } else { format!("  {written}") };
    let said = format!(
        "{class}: a block that runs `{file}`\n{indented}  the FMU is foreign code: models that use the block run it only with `--allow-fmu {}`\n",
        options.file.display(),
    );
    match is_standard(&output) {
        true if options.quiet => Status::Done,
        true => {
            eprint!("{said}");
            Status::Done
        }
        false => print(&said),
    }
}

/// The path of the FMU in the model: its name if it lies in the same folder, else its full path.
fn named_in(file: &Path, output: &Path) -> String {
    let folder = |path: &Path| {
        let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
        parent.unwrap_or(Path::new(".")).canonicalize().ok()
    };
    let full = file.canonicalize().unwrap_or_else(|_| file.to_path_buf());
    let same = folder(file).is_some() && folder(file) == folder(output);
    match file.file_name().filter(|_| same) {
        Some(name) => name.to_string_lossy().into_owned(),
        None => full.to_string_lossy().into_owned(),
    }
}

fn refuse(diagnostic: &Diagnostic) -> Status {
    eprintln!("{}", render(diagnostic, &SourceMap::default(), style()));
    explain::remember([diagnostic]);
    Status::Usage
}
