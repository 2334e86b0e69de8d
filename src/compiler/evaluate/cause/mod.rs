//! Causes found in expressions, by topic.

pub mod array;
pub mod builtin;
pub mod call;
pub mod name;
pub mod types;
pub mod value;

use crate::base::diag::Diagnostic;
use crate::classes::cause::ClassCause;
use crate::rules::cause::element::ElementCause;
use array::ArrayCause;
use call::CallCause;
use name::NameCause;
use types::TypeCause;

/// Whether an error in a function or in a class without its surroundings holds for all arguments and surroundings, and not
/// only for the sizes and values assumed while it is checked: names and types.
pub fn holds_for_all_arguments(d: &Diagnostic) -> bool {
    d.is(|cause: &NameCause| {
        !matches!(cause, NameCause::AbsentComponent | NameCause::ElementOfPartial { .. })
    }) || d.is(|cause: &TypeCause| !matches!(cause, TypeCause::ContinuousValue { .. }))
        || d.is(|cause: &ArrayCause| matches!(cause, ArrayCause::ZeroStep))
        || d.is(|cause: &ClassCause| {
            matches!(
                cause,
                ClassCause::UnknownClass { .. }
                    | ClassCause::NothingToExtend { .. }
                    | ClassCause::ComponentAsClass { .. }
                    | ClassCause::UnknownElement { .. }
            )
        })
        || d.is(|cause: &CallCause| {
            matches!(
                cause,
                CallCause::WrongArguments { .. }
                    | CallCause::MissingArgument { .. }
                    | CallCause::ArgumentTwice { .. }
                    | CallCause::UnknownArgument { .. }
            )
        })
        || d.is(|cause: &ElementCause| matches!(cause, ElementCause::InputAssigned { .. }))
}
