//! Why a sweep can not begin, or not go on.

use thiserror::Error;

use crate::io::atomic_file::WriteError;
use crate::io::csv::TableError;
use crate::io::journal::JournalError;
use crate::io::records::RecordError;

/// What is wrong with a request, or with a file.
#[derive(Error, Debug)]
pub enum SweepError {
    /// `--vary` does not say what varies.
    #[error("`--vary {text}`: {why}; write NAME=FROM:TO:COUNT, NAME=VALUE,VALUE,... or NAME=VALUE")]
    Vary {
        /// As given.
        text: String,
        /// What is wrong.
        why: &'static str,
    },
    /// A parameter varies twice.
    #[error("`{0}` varies twice")]
    Twice(String),
    /// A range without a number of points, and no sample.
    #[error(
        "`--vary {0}`: a range FROM:TO needs a number of points, FROM:TO:COUNT, or `--sample lhs:N`"
    )]
    NoCount(String),
    /// `--sample` is not known.
    #[error("`--sample {0}`: write lhs:N for a Latin hypercube of N runs")]
    Sample(String),
    /// More runs than anybody can wait for.
    #[error("these are more than {most} runs")]
    TooMany {
        /// The bound.
        most: u64,
    },
    /// The table has no place for what is to be kept.
    #[error("the courses of the runs need a folder: `--output DIR`, not a file")]
    NoFolder,
    /// The table can be of these formats only.
    #[error("the table of a sweep goes to a folder, to .csv or to .parquet, not to `{0}`")]
    Format(String),
    /// Another sweep is there.
    #[error(
        "{journal} is the journal of another sweep, or of another state of the model; name another output, or begin anew with `--restart`"
    )]
    Other {
        /// Its file.
        journal: String,
    },
    /// A finished sweep is there.
    #[error(
        "there is a sweep at {output} already; name another output, or replace it with `--restart`"
    )]
    Finished {
        /// The table.
        output: String,
    },
    /// The journal can not be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The table can not be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The course of a run can not be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A file can not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
