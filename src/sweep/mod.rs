//! Parameter sweeps: many runs of one model with different parameters.
//!
//! *In:* the axes ([`vary`]), as a full grid or a Latin hypercube ([`design`]), and the measures of each run.
//! *Out:* a table with a row per run, in order, for any number of threads ([`pool`]); a failed run has a row
//! too. Rows are kept in a journal as they arrive, so that an interrupted sweep resumes where it stopped
//! ([`crate::io::journal`]).
//!
//! Parameters that only enter equations are inputs of the program, which is compiled once and shared by the
//! threads. For structural parameters, a program is compiled for each value ([`variant`]).
//!
//! Latin hypercubes: McKay, Beckman and Conover 1979.
pub mod design;
pub mod error;
pub mod pool;
pub mod prepared;
pub mod random;
pub mod runs;
pub mod shard;
pub mod variant;
pub mod vary;
