//! The place of [`remote`](super::remote) on systems without sockets between processes: FMUs are refused.

use std::ffi::OsString;
use std::time::Duration;

use super::message::Load;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::fmu::cause::FmuCause;
use crate::ir::foreign::{
    AfterStep, ForeignFailure, ForeignFault, ForeignFaultKind, ForeignObserver, ForeignOutcome,
    ForeignTask,
};

/// The hidden command of the child.
pub const COMMAND: &str = "fmu-host";

/// Without effect.
pub fn set_program(_: Vec<OsString>) {}

/// Without effect.
pub fn set_limit(_: f64, _: Duration) {}

/// Without effect.
pub fn give_up_calls() {}

/// An instance that cannot be made.
pub enum Remote {}

impl Remote {
    /// Refuses to start.
    pub fn start(file: &str, _: Load) -> Result<Remote, ForeignFault> {
        let why = "FMUs run on Linux and macOS only".to_owned();
        let cause = FmuCause::NoProcess { path: file.to_owned(), why };
        let diagnostic = Box::new(Diagnostic::new(cause, Span::NONE));
        Err(ForeignFault { kind: ForeignFaultKind::Input, diagnostic })
    }

    /// There is none.
    pub fn renew(&mut self, _: &[usize]) -> Result<(), ForeignFault> {
        match *self {}
    }

    /// There is none.
    pub fn begin(&mut self, _: [f64; 2], _: f64, _: &[(usize, f64)]) -> Result<(), ForeignFault> {
        match *self {}
    }

    /// There is none.
    pub fn step(&mut self, _: f64, _: f64, _: &[(usize, f64)]) -> Result<AfterStep, ForeignFault> {
        match *self {}
    }

    /// There is none.
    pub fn values(&self) -> &[f64] {
        match *self {}
    }

    /// There is none.
    pub fn run(
        &mut self,
        _: &ForeignTask,
        _: &mut dyn ForeignObserver,
    ) -> Result<ForeignOutcome, ForeignFailure> {
        match *self {}
    }
}
