//! The C functions that the Modelica Standard Library calls, implemented on plain numbers: tables,
//! random numbers, `printf` formats.
//!
//! Nothing here knows a model: the evaluator passes arguments in and gets values and derivatives.

pub mod printf;
pub mod split_u64;
pub mod table;
pub mod xorshift1024;
