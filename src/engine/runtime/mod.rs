//! Evaluates a program: its memory, the reference interpreter, machine code, and derivatives.
//!
//! In: an immutable [`Program`](crate::ir::program::Program). Out: values of its variables,
//! residuals, Jacobians and zero-crossing indicators. [`machine`] is the reference interpreter and
//! stays the oracle of [`jit`]; [`tangent`] propagates derivatives along an evaluation.
//! Nothing here compiles: whatever a program needs was decided by `codegen`.

pub mod block_matrix;
pub mod delay;
mod far_solution;
pub mod frame;
pub mod host;
pub mod input_signals;
pub mod jit;
pub mod machine;
pub mod mixed_block;
pub mod spatial_distribution;
pub mod tangent;
pub mod torn_block;
