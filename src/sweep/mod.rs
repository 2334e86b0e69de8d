//! Many runs of one model, each with other parameters.
//!
//! *In:* what varies ([`vary`]), as a full grid or as a Latin hypercube ([`design`]), and the measures that are
//! taken of each run. *Out:* a table with a row per run, in order of their numbers whatever the number of
//! threads ([`pool`]); a run that fails has a row too. Rows are kept in a journal as they come, so that an
//! interrupted sweep goes on where it stopped ([`crate::io::journal`]).
//!
//! Parameters that only enter equations are inputs of the program, which is compiled once and shared by the
//! threads. What the structure of the model depends on is compiled for each of its values ([`variant`]).
//!
//! Latin hypercubes: McKay, Beckman and Conover 1979.
pub mod design;
pub mod error;
pub mod pool;
pub mod random;
pub mod runs;
pub mod variant;
pub mod vary;
