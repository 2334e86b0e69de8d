//! `mocc completions` and `mocc man`: the command line, for shells and for `man`.

use super::args::project::{Completions, Man};
use super::args::{completions, man_pages};
use super::{Status, print};
use crate::io::atomic_file::{create_folder, write_file};

/// Prints the completions of a shell.
pub fn run(options: &Completions) -> Status {
    print(&String::from_utf8_lossy(&completions(options.shell)))
}

/// Writes the man pages.
pub fn man(options: &Man) -> Status {
    let pages = man_pages();
    let folder = &options.folder;
    let write = || {
        create_folder(folder)?;
        pages.iter().try_for_each(|(name, text)| write_file(folder.join(name), text))
    };
    match write() {
        Ok(()) => print(&format!("wrote {} pages to {}\n", pages.len(), folder.display())),
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}
