//! Diagnostics of code generation.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;

/// A construct that code generation does not support yet.
pub fn not_supported(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error("MO0801", span, format!("{what} is not supported yet"))
}

/// A variable is read before any block determines it: an earlier stage is at fault.
pub fn undetermined(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error("MO0802", span, format!("`{name}` is used before it is computed"))
        .help("this is a bug in mocc, please report it with the model")
}
