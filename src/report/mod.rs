//! Pictures and pages.
//!
//! In: a [`Trajectory`](crate::ir::trajectory::Trajectory), a
//! [`Diagram`](crate::ir::diagram::Diagram) or an [`Assembly`](crate::ir::assembly::Assembly). Out:
//! plots ([`plot`], [`mod@chart`]) and schematics ([`schematic`]) as SVG or PNG, graphs
//! ([`mod@dot`], [`incidence`]), and HTML pages ([`page`]). Every file appears complete or not at
//! all.

pub mod chart;
pub mod dot;
pub mod incidence;
pub mod markup;
pub mod page;
pub mod plot;
pub mod raster;
pub mod scale;
pub mod schematic;
