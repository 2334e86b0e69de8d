//! `mocc flatten` and `mocc structure`: what the compiler made of a model, as text.

use super::args::Model;
use super::{Status, print, say};
use crate::driver::compile::Session;

/// Prints the flat model.
pub fn flatten(options: &Model) -> Status {
    let mut session = Session::default();
    let flat = session.flatten(&options.request());
    say(&session);
    match flat {
        Ok(flat) => {
            let status = print(&crate::flatten::print::print(&flat));
            // The process ends: a large model need not be given back piece by piece.
            std::mem::forget(flat);
            status
        }
        Err(wrong) => wrong.into(),
    }
}

/// Prints states, blocks, what was differentiated and what is torn.
pub fn structure(options: &Model) -> Status {
    let mut session = Session::default();
    let blocks = session.flatten(&options.request()).and_then(|flat| session.sort(flat));
    say(&session);
    match blocks {
        Ok(blocks) => {
            let status = print(&crate::structure::print::print(&blocks, &session.sources));
            std::mem::forget(blocks);
            status
        }
        Err(wrong) => wrong.into(),
    }
}
