//! The command line: argv to exit code.
fn main() {}
