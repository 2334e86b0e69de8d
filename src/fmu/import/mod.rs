//! FMUs of others as models.
//!
//! In: the archive of an FMU. Out: a [`ForeignModel`](crate::ir::foreign::ForeignModel), and the text of a Modelica
//! model with the same parameters and variables, which the compiler reads in place of the FMU.
//!
//! An FMU is foreign code. It is loaded only if the user names it, and runs in a child process of mocc ([`host`]),
//! to which [`remote`] talks by messages ([`message`]). The child integrates it too: a run is one message there, and
//! its rows and events come back. What it does to its process, a crash, an end or a hang,
//! reaches the run as a message that names it.

pub mod block;
mod chain;
pub mod component;
pub mod description;
#[cfg(unix)]
pub mod host;
#[cfg(unix)]
mod hosted;
#[cfg(unix)]
pub mod library;
pub mod message;
pub mod model;
#[cfg(unix)]
mod progress;
#[cfg_attr(not(unix), path = "no_remote.rs")]
pub mod remote;
pub mod text;
pub mod whole;
