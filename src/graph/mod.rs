//! Graph algorithms of a compiler for differential-algebraic equations.
//!
//! In come incidences of rows (equations) and columns (unknowns), out go matchings, orders and
//! choices, all as typed integers: nothing here knows an expression. One file holds one classic
//! algorithm, named with its author and paper.
//!
//! A structural analysis calls them in this order: [`matching`] and, if that is not perfect,
//! [`dulmage_mendelsohn`] to explain it; [`pantelides`] to find which equations to differentiate;
//! [`dummy`] to choose the states; [`scc`] to order the equations into blocks; [`tearing`] to
//! shrink each block. [`augment`] and [`rank`] serve them.
pub mod augment;
pub mod bipartite;
pub mod dulmage_mendelsohn;
pub mod dummy;
pub mod matching;
pub mod pantelides;
pub mod rank;
pub mod scc;
pub mod tearing;

#[cfg(test)]
mod samples;
