//! Pages of HTML that need nothing else: one skeleton, one style sheet and one script for charts,
//! which reports, calibrations and diagnoses share.
//!
//! In come texts, tables and trajectories; out goes one text that opens from disk without a network.
//! Equal inputs give equal bytes. The scripts stand in files of their own and are put into the page.

pub mod columns;
pub mod diff;
pub mod document;
pub mod figure;
pub mod frame;
pub mod parameters;
pub mod spool;
