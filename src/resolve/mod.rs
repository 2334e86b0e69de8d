//! Names of classes to their texts: the user's files first, then libraries in folders.
//!
//! In: syntax trees and folders. Out: the class of a full name. Modelica specification, chapter 13.
pub mod library;
pub mod version;
