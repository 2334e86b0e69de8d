//! What can be wrong with a measure: `MO11..`.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;

const EXAMPLE: &str = "write NAME = EXPRESSION, such as `t_switch = when(spool.s > 0.95*s_max)`";

/// It does not start with a name and `=`.
pub fn no_name(text: &str) -> Diagnostic {
    Diagnostic::error("MO1101", Span::NONE, format!("the measure `{text}` has no name"))
        .help(EXAMPLE)
}

/// What follows the `=` does not parse.
pub fn no_expression(text: &str) -> Diagnostic {
    Diagnostic::error("MO1101", Span::NONE, format!("the measure `{text}` is no expression"))
        .help(EXAMPLE)
}

/// A name is given twice.
pub fn twice(name: &str) -> Diagnostic {
    Diagnostic::error("MO1102", Span::NONE, format!("there are two measures `{name}`"))
        .help("rename one of them")
}

/// A function of a measure with the wrong arguments.
pub fn arguments(span: Span, function: &str, usage: &str) -> Diagnostic {
    Diagnostic::error("MO1103", span, format!("`{function}` does not take these arguments"))
        .help(format!("write {usage}"))
}

/// A function of a measure inside of another.
pub fn nested(span: Span, function: &str) -> Diagnostic {
    Diagnostic::error(
        "MO1104",
        span,
        format!("`{function}` can not stand inside of another function of a measure"),
    )
    .label("its value is known after the run only")
    .help(
        "give it a measure of its own before this one, and combine the two outside of the function",
    )
}

/// An earlier measure inside of a function of a measure.
pub fn earlier(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        "MO1104",
        span,
        format!("the measure `{name}` can not stand inside of a function"),
    )
    .label("its value is known after the run only")
    .help(
        "only a measure that is `when(...)` can, as the end of a range: `max(e, until = t_switch)`",
    )
}

/// A variable that moves stands outside of the functions of a measure.
pub fn moves(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error("MO1105", span, format!("the measure `{name}` is no single number"))
        .label("depends on variables that change during the run")
        .help("say which value of them is meant: `final(e)`, `max(e)`, `mean(e)`, `at(e, t)`, ...")
}
