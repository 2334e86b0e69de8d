//! The shared library of exported FMUs: the C functions of FMI 2.0.5 and FMI 3.0.2.
//!
//! In: calls of an importer. Out: status codes, and messages through its logger. Each function checks its
//! pointers, catches panics, and leaves the rest to [`mocc::fmu::instance`]. A library serves any number of
//! instances; they share nothing.

mod component;
mod second;
mod third;
