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
