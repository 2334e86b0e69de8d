//! Errors in measures: `MO11..`.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;

const EXAMPLE: &str = "write NAME = EXPRESSION, such as `t_switch = when(spool.s > 0.95*s_max)`";

/// The measure does not start with a name and `=`.
pub fn no_name(text: &str) -> Diagnostic {
    Diagnostic::error("MO1101", Span::NONE, format!("the measure `{text}` has no name"))
        .help(EXAMPLE)
}

/// The expression after `=` cannot be parsed.
pub fn no_expression(text: &str) -> Diagnostic {
    Diagnostic::error("MO1101", Span::NONE, format!("the measure `{text}` is not an expression"))
        .help(EXAMPLE)
}

/// Two measures have the same name.
pub fn twice(name: &str) -> Diagnostic {
    Diagnostic::error("MO1102", Span::NONE, format!("there are two measures `{name}`"))
        .help("rename one of them")
}

/// A function of a measure has the wrong arguments.
pub fn arguments(span: Span, function: &str, usage: &str) -> Diagnostic {
    Diagnostic::error("MO1103", span, format!("`{function}` does not take these arguments"))
        .help(format!("write {usage}"))
}

/// A function of a measure occurs inside another.
pub fn nested(span: Span, function: &str) -> Diagnostic {
    Diagnostic::error(
        "MO1104",
        span,
        format!("`{function}` cannot occur inside another function of a measure"),
    )
    .label("its value is known only after the run")
    .help("define it as a measure before this one, and combine the two outside the function")
}

/// An earlier measure occurs inside a function of a measure.
pub fn earlier(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        "MO1104",
        span,
        format!("the measure `{name}` cannot occur inside a function"),
    )
    .label("its value is known only after the run")
    .help("only a measure `when(...)` can, as the end of a range: `max(e, until = t_switch)`")
}

/// A variable that changes during the run occurs outside the functions of a measure.
pub fn moves(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error("MO1105", span, format!("the measure `{name}` is not a single number"))
        .label("depends on variables that change during the run")
        .help("choose one value: `final(e)`, `max(e)`, `mean(e)`, `at(e, t)`, ...")
}
