//! From a run to files: tables and pictures.
//!
//! In comes a [`Trajectory`](crate::ir::trajectory::Trajectory), or row after row of one; out go
//! results as CSV, Parquet or MAT ([`results::Results`]) and a picture in SVG or PNG
//! ([`plot::plot`]). Every file is written whole or not at all ([`write`](mod@write)).

pub mod chart;
pub mod dot;
pub mod incidence;
pub mod markup;
pub mod page;
pub mod plot;
pub mod raster;
pub mod scale;
pub mod schematic;
