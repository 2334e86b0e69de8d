//! Diagnostics about files and libraries.

use crate::base::cause::causes;

causes! {
    /// Causes found while files are read and libraries are searched.
    pub enum LibraryCause {
        /// Two classes of the user's files have the same name.
        error MO0101 DuplicateClass { name: String } (section "4.2")
            => ("`{name}` is defined twice"), help("rename or remove one of them");
        /// A file of a library cannot be read.
        error MO0102 UnreadableFile { path: String, why: String }
            => ("cannot read {path}: {why}");
        /// A file of a library does not define the class of its own name.
        error MO0103 MissingClass { name: String } (section "13.4")
            => ("this file does not define `{name}`"),
            help("name the class `{name}`, or rename the file");
        /// A library has another version than the required one.
        warning MO0105 OtherVersion { library: String, required: String, found: String } (section "18.8.2")
            => ("`{library}` {required} is required, but only {found} was found"),
            help("name a folder that contains version {required} with `--lib`, or require {found}");
    }
}
