//! File formats.
//!
//! Results of a run are written row by row through [`results::Results`], tables of a sweep through
//! [`records::Records`]; [`mod@format`] lists the formats, whose writers are in [`csv`],
//! [`parquet`] and [`mat4`]; results of other tools are read by [`format::Format::read`], columns of any table by [`number_table`]. Recordings and matrices are read from CSV, MAT levels 4 and 5
//! ([`mat5`]) and text ([`matrix_file`]). Every file appears complete or not at all
//! ([`atomic_file`]), but for what models print ([`printout`]).

pub mod atomic_file;
pub mod csv;
pub mod format;
pub mod journal;
pub mod json;
pub mod mat4;
pub mod mat4_read;
pub(crate) mod mat5;
pub mod matrix_file;
pub mod number_table;
pub mod parquet;
pub mod printout;
pub mod records;
pub mod results;
pub mod wire;
