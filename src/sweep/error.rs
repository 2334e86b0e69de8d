//! Errors of sweeps.

use thiserror::Error;

use crate::io::atomic_file::WriteError;
use crate::io::csv::TableError;
use crate::io::journal::JournalError;
use crate::io::records::RecordError;

/// Why a sweep cannot begin or continue.
#[derive(Error, Debug)]
pub enum SweepError {
    /// `--vary` cannot be read.
    #[error("`--vary {text}`: {why}; write NAME=FROM:TO:COUNT, NAME=VALUE,VALUE,... or NAME=VALUE")]
    Vary {
        /// The argument.
        text: String,
        /// The reason.
        why: &'static str,
    },
    /// A parameter varies twice.
    #[error("`{0}` varies twice")]
    Twice(String),
    /// A range has no number of points, and there is no sample.
    #[error(
        "`--vary {0}`: a range FROM:TO needs a number of points, FROM:TO:COUNT, or `--sample lhs:N`"
    )]
    NoCount(String),
    /// `--sample` cannot be read.
    #[error("`--sample {0}`: write lhs:N for a Latin hypercube of N runs")]
    Sample(String),
    /// Too many runs.
    #[error("more than {max} runs")]
    TooMany {
        /// The limit.
        max: u64,
    },
    /// Trajectories cannot be kept in a table.
    #[error("the trajectories of the runs need a folder: `--output DIR`, not a file")]
    NoFolder,
    /// A part of a sweep cannot be printed.
    #[error("shards share files: name a file or a folder with `--output`, not `-`")]
    PipedShard,
    /// The table cannot have this format.
    #[error("cannot write the table of a sweep to `{0}`; give a folder, a .csv or a .parquet file")]
    Format(String),
    /// The output belongs to another sweep.
    #[error(
        "{journal} is the journal of another sweep or of an earlier version of the model; name another output, or restart with `--restart`"
    )]
    Other {
        /// Its file.
        journal: String,
    },
    /// The journal comes from another machine.
    #[error(
        "{journal} comes from a machine whose elementary functions round differently, and results of both are not mixed; use machines of one kind, name another output, or restart with `--restart`"
    )]
    Foreign {
        /// Its file.
        journal: String,
    },
    /// `--shard` cannot be read.
    #[error("`--shard {0}`: write I/N for the part I, from 1 to N, of N parts")]
    Shard(String),
    /// There are no journals to gather.
    #[error(
        "there is no journal of a shard, {pattern}; run the shards first, with `--shard I/N` and the same arguments"
    )]
    NoShards {
        /// The names that they would have.
        pattern: String,
    },
    /// Journals of different numbers of shards.
    #[error("there are journals of {first} and of {second} shards; remove those of one number")]
    TwoDesigns {
        /// A number of shards.
        first: u64,
        /// Another one.
        second: u64,
    },
    /// Shards are not complete.
    #[error("shards are not complete: {missing}; run them again, which resumes where they stopped")]
    Incomplete {
        /// Each with its number of runs.
        missing: String,
    },
    /// The output holds a finished sweep.
    #[error(
        "{output} already holds a finished sweep; name another output, or replace it with `--restart`"
    )]
    Finished {
        /// The table.
        output: String,
    },
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The table cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A trajectory cannot be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
