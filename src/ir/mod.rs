//! The representations between the stages, in pipeline order.
pub mod ast;
pub mod modification;
pub mod instance;
pub mod external;
pub mod builtin;
pub mod clock;
pub mod expr;
pub mod function;
pub mod flat;
pub mod dae;
pub mod blocks;
pub mod walk;
pub mod foreign;
pub mod program;
pub mod trajectory;
pub mod diagram;
pub mod assembly;
