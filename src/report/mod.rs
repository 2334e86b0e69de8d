//! From a run to files: tables and pictures.
//!
//! In comes a [`Trajectory`](crate::ir::trajectory::Trajectory), or row after row of one; out go
//! results as CSV, Parquet or MAT ([`results::Results`]) and a picture in SVG or PNG
//! ([`plot::plot`]). Every file is written whole or not at all ([`write`](mod@write)).

pub mod axis;
pub mod chart;
pub mod decimate;
pub mod dot;
pub mod figure;
pub mod incidence;
pub mod journal;
pub mod json;
pub mod layout;
pub mod markup;
pub mod mat;
pub mod page;
pub mod parquet;
pub mod plot;
pub mod raster;
pub mod records;
pub mod results;
pub mod scale;
pub mod schematic;
pub mod table;
pub mod ticks;
pub mod write;
