//! Nonlinear systems.
