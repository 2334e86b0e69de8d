//! Tests of a user's own models.
//!
//! *In:* test files in TOML next to the models ([`test_file`]) and annotations of models ([`annotation`]), found in
//! folders ([`files`]). *Out:* for each run of each
//! test, which of its expectations do not hold ([`run`]), for people, as JUnit XML and as JSON ([`summary`]), and as a page
//! with the changes of snapshots ([`review`]).
//!
//! A snapshot is a file in a folder named after the test file; nothing but [`snapshot::Snapshot::accept`] writes it.

pub mod annotation;
pub mod cause;
pub mod files;
pub mod review;
pub mod run;
pub mod snapshot;
pub mod summary;
pub mod test_file;
pub mod traces;
