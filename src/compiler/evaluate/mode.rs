//! The mode of the evaluator: the meaning of names while an expression is evaluated.

use super::Evaluator;
use crate::ir::instance::InstanceId;

/// The meaning of names, and which of them may be read.
///
/// By default a variable stands for itself, or for the value that the algorithm being run has
/// assigned to it. [`Evaluator::with_mode`] changes the mode for one evaluation.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Mode {
    /// Parameters stand for their values; anything known only at run time is an error.
    pub fold: bool,
    /// Only sizes are wanted: a scalar without a value counts as zero.
    pub sizes: bool,
    /// Variables stand for themselves, not for what an algorithm has assigned to them.
    pub unassigned: bool,
    /// A value is read: a conditional component is an error.
    pub reads_value: bool,
    /// The constant whose value is being found: it may not read parameters.
    pub constant: Option<InstanceId>,
}

impl Mode {
    /// As this mode, with the values of parameters.
    pub fn folding(self) -> Mode {
        Mode { fold: true, ..self }
    }

    /// As this mode, for the value of a parameter, or of this constant.
    pub(crate) fn of_parameter(self, constant: Option<InstanceId>) -> Mode {
        Mode { fold: true, sizes: false, constant, ..self }
    }

    /// As this mode, for sizes only.
    pub(crate) fn sizing(self) -> Mode {
        Mode { sizes: true, ..self }
    }

    /// As this mode, for the argument of `size`: the sizes of a variable are known where its value
    /// is not, even for a constant.
    pub(crate) fn of_size_argument(self, whole: bool) -> Mode {
        let mode = Mode { constant: None, ..self };
        if whole { Mode { fold: false, sizes: true, ..mode } } else { mode }
    }

    /// As this mode, reading the value of a reference.
    pub(crate) fn reading(self) -> Mode {
        Mode { reads_value: true, ..self }
    }

    /// As this mode, for a subscript of a reference that is read or assigned.
    pub(crate) fn subscript(self) -> Mode {
        Mode { reads_value: false, unassigned: false, ..self }
    }

    /// As this mode, with variables that stand for themselves.
    pub(crate) fn unassigned(self) -> Mode {
        Mode { unassigned: true, ..self }
    }

    /// Whether nothing is evaluated for the equations of the model itself: values and sizes found
    /// before simulation have no events, no history and no assertions.
    pub(crate) fn is_before_simulation(self) -> bool {
        self.fold || self.sizes
    }
}

impl Evaluator<'_> {
    /// Evaluates in another mode.
    pub(crate) fn with_mode<T>(&mut self, mode: Mode, act: impl FnOnce(&mut Self) -> T) -> T {
        let around = std::mem::replace(&mut self.mode, mode);
        let result = act(self);
        self.mode = around;
        result
    }
}
