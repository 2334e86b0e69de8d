//! `mocc lsp`: the language server on standard input and output.

use super::{Status, modelica_path};
use crate::lsp::server::{Ended, serve};

/// Serves one editor until it says goodbye.
pub fn run() -> Status {
    let input = std::io::BufReader::new(std::io::stdin());
    match serve(input, std::io::stdout().lock(), modelica_path()) {
        Ok(Ended::Orderly) => Status::Done,
        Ok(Ended::Abruptly) => Status::Model,
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}
