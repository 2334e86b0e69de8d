//! Diagnostics of code generation.

use crate::base::cause::causes;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;

causes! {
    /// Causes found by code generation.
    pub enum CodegenCause {
        /// A construct that code generation does not support yet.
        error MO0801 NotSupported { construct: String }
            => ("{construct} is not supported yet");
        /// A variable is read before any block determines it: an earlier stage is at fault.
        error MO0802 Undetermined { name: String }
            => ("`{name}` is used before it is computed"),
            help("this is a bug in mocc, please report it with the model");
    }
}

/// A construct that code generation does not support yet.
pub fn not_supported(span: Span, construct: &str) -> Diagnostic {
    Diagnostic::new(CodegenCause::NotSupported { construct: construct.to_owned() }, span)
}

/// A variable is read before any block determines it.
pub fn undetermined(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(CodegenCause::Undetermined { name: name.to_owned() }, span)
}
