//! Diagnostics of measures.

use crate::base::cause::causes;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;

causes! {
    /// Causes found in measures.
    pub enum MeasureCause {
        /// A measure does not start with a name and `=`.
        error MO1101 NoName { measure: String }
            => ("the measure `{measure}` has no name"),
            help("write NAME = EXPRESSION, such as `t_switch = when(spool.s > 0.95*s_max)`");
        /// Two measures have the same name.
        error MO1102 DuplicateName { name: String }
            => ("there are two measures `{name}`"), help("rename one of them");
        /// A function of a measure has the wrong arguments.
        error MO1103 WrongArguments { function: String, usage: String }
            => ("`{function}` does not take these arguments"), help("write {usage}");
        /// A function of a measure occurs inside another.
        error MO1104 NestedFunction { function: String }
            => ("`{function}` cannot occur inside another function of a measure"),
            help("define it as a measure before this one, and combine the two outside the function");
        /// A variable that changes during the run occurs outside the functions of a measure.
        error MO1105 NotANumber { name: String }
            => ("the measure `{name}` is not a single number"),
            help("choose one value: `final(e)`, `max(e)`, `mean(e)`, `at(e, t)`, ...");
        /// A measure has the name of a variable or class of the model.
        error MO1106 TakenName { name: String }
            => ("the measure `{name}` has the name of a variable of the model"),
            help("give it another name, such as `{name}_1 = ...`");
        /// A measure has the name of a column of a sweep.
        error MO1107 ColumnOfSweep { name: String }
            => ("the measure `{name}` has the name of a column that the table of a sweep has anyway"),
            help("give it another name, such as `{name}_1 = ...`");
        /// The right side of a measure cannot be parsed.
        error MO1120 NotAnExpression { measure: String }
            => ("the measure `{measure}` is not an expression"),
            help("write NAME = EXPRESSION, such as `t_switch = when(spool.s > 0.95*s_max)`");
        /// An earlier measure occurs inside a function of a measure.
        error MO1121 MeasureInsideFunction { name: String }
            => ("the measure `{name}` cannot occur inside a function"),
            help("only a measure `when(...)` can, as the end of a range: `max(e, until = t_switch)`");
    }
}

/// The measure does not start with a name and `=`.
pub fn no_name(text: &str) -> Diagnostic {
    Diagnostic::new(MeasureCause::NoName { measure: text.to_owned() }, Span::NONE)
}

/// The expression after `=` cannot be parsed.
pub fn no_expression(text: &str) -> Diagnostic {
    Diagnostic::new(MeasureCause::NotAnExpression { measure: text.to_owned() }, Span::NONE)
}

/// Two measures have the same name.
pub fn twice(name: &str) -> Diagnostic {
    Diagnostic::new(MeasureCause::DuplicateName { name: name.to_owned() }, Span::NONE)
}

/// A function of a measure has the wrong arguments.
pub fn arguments(span: Span, function: &str, usage: &str) -> Diagnostic {
    let (function, usage) = (function.to_owned(), usage.to_owned());
    Diagnostic::new(MeasureCause::WrongArguments { function, usage }, span)
}

/// A function of a measure occurs inside another.
pub fn nested(span: Span, function: &str) -> Diagnostic {
    Diagnostic::new(MeasureCause::NestedFunction { function: function.to_owned() }, span)
        .label("its value is known only after the run")
}

/// An earlier measure occurs inside a function of a measure.
pub fn earlier(span: Span, name: &str) -> Diagnostic {
    Diagnostic::new(MeasureCause::MeasureInsideFunction { name: name.to_owned() }, span)
        .label("its value is known only after the run")
}

/// A variable that changes during the run occurs outside the functions of a measure.
pub fn moves(span: Span, name: &str) -> Diagnostic {
    Diagnostic::new(MeasureCause::NotANumber { name: name.to_owned() }, span)
        .label("depends on variables that change during the run")
}
