//! The command line: argv to exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    mocc::cli::main(std::env::args_os()).into()
}
