//! The Python module `mocc._mocc`: the functions and objects that the package `mocc` is made of. Its users import `mocc`,
//! which gives them names, types, checks of their arguments and documentation.
//!
//! Every call releases the interpreter lock while it computes, and ends on Ctrl-C.

mod arrow;
mod background;
mod derivative;
mod error;
mod model;
mod own_rows;
mod run;
mod study;
mod sweep;
mod values;

use std::ffi::OsString;

use mocc::fmu::import::remote::set_program;
use pyo3::prelude::*;

/// Runs the command line and returns its exit status. `arguments` starts with the name of the program.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| mocc::cli::main(arguments) as u8)
}

/// A fingerprint of the arithmetic of this machine.
#[pyfunction]
fn arithmetic(py: Python<'_>) -> u64 {
    py.detach(mocc::runtime::host::arithmetic)
}

/// The native part of the package `mocc`.
#[pymodule]
fn _mocc(module: &Bound<'_, PyModule>) -> PyResult<()> {
    keep_freed_memory();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // FMUs run in child processes: this Python, with the packages of its environment, and `mocc fmu-host`.
    let python: OsString = module.py().import("sys")?.getattr("executable")?.extract()?;
    set_program(vec![python, "-m".into(), "mocc".into()]);
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(arithmetic, module)?)?;
    module.add_function(wrap_pyfunction!(derivative::linear_system, module)?)?;
    module.add_function(wrap_pyfunction!(derivative::sensitivities, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_files, module)?)?;
    module.add_function(wrap_pyfunction!(study::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(study::study_files, module)?)?;
    module.add_function(wrap_pyfunction!(study::diagnose, module)?)?;
    module.add_class::<model::Model>()?;
    module.add_class::<run::Run>()?;
    module.add_class::<values::Values>()?;
    module.add_class::<study::Calibration>()?;
    module.add_class::<study::Worker>()?;
    module.add_class::<sweep::Journal>()?;
    module.add_class::<sweep::Sweep>()
}

/// Bytes that the allocator keeps for the next run; a run of some thousand rows and hundred columns needs a few million.
const KEPT: usize = 16 << 20;

/// Lets the memory of one run serve the next. glibc returns what is free at the end of the heap to the system, and each
/// run gets it back page by page, which takes a fifth of its time; it keeps twice the size of a block that it has mapped
/// for itself once such a block was freed.
fn keep_freed_memory() {
    drop(std::hint::black_box(vec![0_u8; KEPT]));
}
