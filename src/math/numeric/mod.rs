//! Numerical building blocks over floats.
