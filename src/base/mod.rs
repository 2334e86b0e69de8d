//! Ground floor: what every stage uses and what knows no stage.
pub mod diag;
pub mod index;
pub mod marks;
pub mod name;
pub mod render;
pub mod source;
