//! Names to classes: lexical lookup, inheritance, redeclared classes.
//!
//! In: the [`crate::resolve::library::Library`] and a name in a scope. Out: a `ClassId`, and the
//! table of everything that the class has after inheritance. Modelica specification, chapters 5
//! and 7.

pub mod inheritance;
pub mod lookup;
pub(crate) mod type_lookup;
