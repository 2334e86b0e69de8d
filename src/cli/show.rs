//! `mocc flatten` and `mocc structure`: print or draw intermediate representations of a model.

use std::path::Path;

use super::args::inspect::{Flatten, Structure};
use super::{Status, print, print_result, say, write_result};
use crate::base::diag::Diagnostic;
use crate::driver::cause::RequestCause;
use crate::driver::compile::{Request, Session};
use crate::ir::diagram::Diagram;
use crate::report::dot::dot;
use crate::report::incidence::svg;
use crate::report::raster::png;
use crate::structure::diagram::diagram;

/// Pixels of a PNG per px of the picture.
const PNG_SCALE: u32 = 2;

/// Prints the flat model.
pub fn flatten(options: &Flatten) -> Status {
    let mut session = Session { is_last: true, ..Session::default() };
    // Of an FMU its interface is shown, without loading its code.
    let request = Request { takes_fmu: true, ..options.model.request() };
    let fragments = match session.flatten(&request) {
        Ok(mut flat) => {
            let fragments = crate::flatten::print::fragments(&flat).map_err(|why| {
                let cause = RequestCause::FlatModelTooLarge { why: why.to_string() };
                session.problems.push(Diagnostic::new(cause, flat.span));
                Status::Model
            });
            // The process ends: freeing a large model would only take time.
            flat.graph.release_externals();
            std::mem::forget(flat);
            fragments
        }
        Err(error) => Err(error.into()),
    };
    say(&session);
    match fragments {
        Ok(fragments) => {
            let failed =
                fragments.iter().map(|piece| print_result(piece)).find(|s| *s != Status::Done);
            failed.unwrap_or(Status::Done)
        }
        Err(status) => status,
    }
}

/// Prints states, blocks, differentiated and torn equations; or draws the blocks.
pub fn structure(options: &Structure) -> Status {
    let mut session = Session { is_last: true, ..Session::default() };
    let request = options.model.request();
    let blocks = session.flatten(&request).and_then(|flat| session.sort(flat));
    say(&session);
    match blocks {
        Ok(mut blocks) => {
            let status = if options.dot.is_none() && options.svg.is_none() {
                print_result(&crate::structure::print::print(&blocks, &session.sources))
            } else {
                draw(options, &diagram(&blocks))
            };
            blocks.dae.graph.release_externals();
            std::mem::forget(blocks);
            status
        }
        Err(error) => error.into(),
    }
}

fn draw(options: &Structure, diagram: &Diagram) -> Status {
    let mut written = String::new();
    let mut write = |path: &Path, bytes: &[u8]| {
        written.push_str(&write_result(path, bytes)?);
        Ok(())
    };
    let mut drawn = Ok(());
    if let Some(path) = &options.dot {
        drawn = write(path, dot(diagram).as_bytes());
    }
    if let (Some(path), Ok(())) = (&options.svg, &drawn) {
        let picture = svg(diagram);
        let is_png = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        drawn = match is_png {
            true => png(&picture, PNG_SCALE).and_then(|bytes| write(path, &bytes)),
            false => write(path, picture.as_bytes()),
        };
    }
    match drawn {
        Ok(()) => print(&written),
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}
