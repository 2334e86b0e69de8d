//! Ground floor: types that every stage uses and that depend on no stage.
pub mod activity;
pub mod cause;
pub mod diag;
pub mod document;
pub mod index;
pub mod visited;
pub mod name;
pub mod render;
pub mod source;
pub mod specification;
pub mod wire;
pub mod toml_file;
