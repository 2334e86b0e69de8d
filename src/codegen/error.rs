//! What can not be compiled.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;

/// Something the run-time code does not offer yet.
pub fn not_supported(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error("MO0801", span, format!("{what} is not supported yet"))
}

/// A variable is read before any block determines it: an earlier stage left a hole.
pub fn undetermined(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error("MO0802", span, format!("`{name}` is used before it is computed"))
        .help("this is a bug in mocc, please report it with the model")
}

/// Functions that call each other in a circle.
pub fn recursion(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error("MO0803", span, format!("function `{name}` calls itself"))
        .help("replace the recursion by a loop")
        .note("recursive functions that are called while the simulation runs are not supported yet")
}
