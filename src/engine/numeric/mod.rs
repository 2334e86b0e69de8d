//! Numerical building blocks over floats: linear and nonlinear systems, norms, roots of one
//! function.
//!
//! Nothing here depends on equations, variable names or units. A failure reports a position (a
//! column, a residual), which the caller translates into the name of a variable.
#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "`!(a < b)` makes a NaN count as a failed test"
)]

pub mod brent;
pub mod coloring;
pub mod combinations;
pub mod cycle_detection;
pub mod eigen;
pub mod eigenvalues;
pub mod eigenvectors;
pub mod halton;
pub mod hermite;
pub mod least_squares;
pub mod levenberg_marquardt;
pub mod linear;
pub mod maxvol;
pub mod newton;
pub mod norm;
pub mod null_space;
pub mod panel;
pub mod participation;
pub mod pattern;
pub mod polynomial_segment;
pub mod pseudo_inverse;
pub mod root;
pub mod small_lu;
pub mod smoothing;
pub mod sqp;
pub mod symbolic_lu;
pub mod time_series;
pub mod whiteness;
