//! Finds classes by name: in the user's files first, then in library folders.
//!
//! In: syntax trees and folders. Out: the class with a fully qualified name. Modelica 3.6, chapter
//! 13.
pub mod cause;
pub mod library;
pub mod version;
