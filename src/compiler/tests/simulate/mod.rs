//! Whole runs of small systems that are sorted by hand.
mod builder;
mod discrete;
mod failures;
mod hard;
mod selection;
mod models;
mod smooth;
