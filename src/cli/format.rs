//! `mocc fmt`: files put in order, in place.

use super::args::inspect::Format;
use super::args::model::is_standard;
use super::{Status, print, print_result, standard_input, style};
use crate::base::render::render_all;
use crate::base::source::SourceMap;
use crate::format::{FormatError, format};
use crate::io::atomic_file::write_file;

/// Formats each file; the status is that of the worst.
pub fn run(options: &Format) -> Status {
    let mut sources = SourceMap::default();
    let mut changed = String::new();
    let mut worst = Status::Done;
    let mut meet = |status: Status| {
        if status as u8 > worst as u8 {
            worst = status;
        }
    };
    for path in &options.files {
        let is_standard = is_standard(path);
        let read =
            if is_standard { Ok(standard_input()) } else { crate::driver::files::read(path) };
        let text = match read {
            Ok(text) => text,
            Err(why) => {
                eprintln!("error: cannot read `{}`: {why}", path.display());
                meet(Status::Usage);
                continue;
            }
        };
        let id = sources.add(path, text.as_str());
        match format(id, &text) {
            Ok(ordered) if is_standard && !options.check => meet(print_result(&ordered)),
            Ok(ordered) if ordered == text => {}
            Ok(_) if options.check => {
                changed.push_str(&format!("{}\n", path.display()));
                meet(Status::Model);
            }
            Ok(ordered) => {
                if let Err(why) = write_file(path, ordered.as_bytes()) {
                    eprintln!("error: {why}");
                    meet(Status::Usage);
                }
            }
            Err(FormatError::Syntax(problems)) => {
                eprint!("{}", render_all(&problems, &sources, style()));
                meet(Status::Model);
            }
            Err(why @ FormatError::Differs) => {
                eprintln!("a bug in mocc: {}: {why}; the file is as it was", path.display());
                meet(Status::Bug);
            }
        }
    }
    let printed = if changed.is_empty() { Status::Done } else { print(&changed) };
    meet(printed);
    worst
}
