//! The place of [`remote`](super::remote) on systems without sockets between processes: FMUs are refused.

use std::ffi::OsString;
use std::time::Duration;

use super::message::Load;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::fmu::cause::FmuCause;
use crate::ir::foreign::{ForeignFault, ForeignFaultKind, ForeignInstance};

/// The hidden command of the child.
pub const COMMAND: &str = "fmu-host";

/// Without effect.
pub fn set_program(_: Vec<OsString>) {}

/// Without effect.
pub fn set_limit(_: f64, _: Duration) {}

/// Without effect.
pub fn give_up_calls() {}

/// Refuses to start.
pub fn start(file: &str, _: Load) -> Result<Box<dyn ForeignInstance + Send>, ForeignFault> {
    let why = "FMUs run on Linux and macOS only".to_owned();
    let cause = FmuCause::NoProcess { path: file.to_owned(), why };
    let diagnostic = Box::new(Diagnostic::new(cause, Span::NONE));
    Err(ForeignFault { kind: ForeignFaultKind::Input, diagnostic })
}
