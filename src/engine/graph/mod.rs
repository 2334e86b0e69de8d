//! Graph algorithms of a compiler for differential-algebraic equations.
//!
//! Input: incidences of rows (equations) and columns (unknowns). Output: matchings, orders and
//! choices. Everything is a typed integer; no algorithm here sees an expression. Each file holds
//! one classic algorithm, with its author and paper.
//!
//! A structural analysis calls them in this order: [`matching`] and, if that is not perfect,
//! [`dulmage_mendelsohn`] to explain it; [`pantelides`] to find the equations to differentiate;
//! [`dummy_derivatives`] to select the states; [`scc`] to order the equations into blocks;
//! [`tearing`] to shrink each block. [`augment`] and [`rank`] serve them. Before all that,
//! [`spanning_forest`] breaks the cycles of overconstrained connections.
pub mod augment;
pub mod bipartite;
pub mod dulmage_mendelsohn;
pub mod dummy_derivatives;
pub mod matching;
pub mod pantelides;
pub mod rank;
pub mod scc;
pub mod spanning_forest;
pub mod tearing;

#[cfg(test)]
mod test_graphs;
