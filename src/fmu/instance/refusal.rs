//! Why a call of an importer has no result.

use crate::simulate::failure::{Failure, FailureKind};

/// How serious a refusal is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Gravity {
    /// The point is out of the domain: another step size may help.
    Discard,
    /// The instance cannot go on.
    Error,
}

/// Why a call has no result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Refusal {
    /// How serious it is.
    pub gravity: Gravity,
    /// The reason, in the names of the model.
    pub text: String,
}

impl Refusal {
    /// An error of the caller.
    pub fn of(text: impl Into<String>) -> Self {
        Refusal { gravity: Gravity::Error, text: text.into() }
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        let numerics = failure.kind == FailureKind::Numerics;
        let gravity = if numerics { Gravity::Discard } else { Gravity::Error };
        Refusal { gravity, text: failure.diagnostic.message.clone() }
    }
}

/// The refusal of a value reference.
pub(super) fn unknown_reference(reference: u32) -> Refusal {
    Refusal::of(format!("no variable has the value reference {reference}"))
}

/// A failure outside of an integrator's trial step: the instance cannot go on.
pub(super) fn fatal(failure: Failure) -> Refusal {
    Refusal { gravity: Gravity::Error, ..Refusal::from(failure) }
}
