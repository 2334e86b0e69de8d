//! Self-contained HTML pages: one skeleton, one style sheet and one script for charts, shared by reports,
//! calibrations and diagnoses.
//!
//! *In:* sources, tables and trajectories. *Out:* one page that opens from disk without a network. Equal
//! inputs give equal bytes. The scripts are files of their own, included in the page.

pub mod columns;
pub mod diff;
pub mod document;
pub mod figure;
pub mod frame;
pub mod parameters;
pub mod spool;
pub mod view;
