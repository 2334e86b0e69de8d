//! From a run to files: tables and pictures.
//!
//! In comes a [`Trajectory`](crate::ir::trajectory::Trajectory); out go a CSV table
//! ([`table::write_csv`]) and a picture in SVG or PNG ([`plot::plot`]). Every file is written
//! whole or not at all ([`write`](mod@write)).

pub mod axis;
pub mod decimate;
pub mod figure;
pub mod layout;
pub mod plot;
pub mod raster;
pub mod scale;
pub mod table;
pub mod ticks;
pub mod write;
