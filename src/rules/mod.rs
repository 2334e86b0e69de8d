//! Rules of the specification that only report: they read classes and instances and change neither.
//!
//! In: a class or a component. Out: diagnostics. One file per rule or group of rules of one section.

pub mod ineffective_modifiers;
pub(crate) mod iterators;
pub mod plug_compatibility;
pub(crate) mod prefix;
pub mod shadowing;
pub mod specialized_class;
pub mod statements;
pub mod visibility;
