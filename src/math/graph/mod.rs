//! Graph algorithms over typed integers.
