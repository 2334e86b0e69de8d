//! Constructs of the language that mocc does not have yet.

use std::fmt;

use crate::base::cause::causes;

/// A construct that is not supported yet.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Construct {
    ArrayCardinality,
    Break,
    CardinalityOutsideEquations,
    DerivativeByArray,
    DerivativeOfLoop,
    DerivativeOfOtherType,
    DynamicComponents,
    FirstAssignmentInLoop,
    GrowingArray,
    HistoryInLoop,
    IteratorWithoutRange,
    ModifiedClass,
    NamedStringArguments,
    RedeclaredField,
    SecondDerivative,
    ThisEquation,
}

impl fmt::Display for Construct {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Construct::ArrayCardinality => "`cardinality` of an array",
            Construct::Break => "`break` in modifications",
            Construct::CardinalityOutsideEquations => {
                "`cardinality` outside of equations and values of variables"
            }
            Construct::DerivativeByArray => "derivatives of functions by arrays and records",
            Construct::DerivativeOfLoop => {
                "the derivative of a function with a loop whose trip count is known only at run time"
            }
            Construct::DerivativeOfOtherType => {
                "the derivative of a function with an output that is not Real"
            }
            Construct::DynamicComponents => "components whose subscripts are known only at run time",
            Construct::FirstAssignmentInLoop => {
                "the first assignment of a variable in a loop whose trip count is known only at run time"
            }
            Construct::GrowingArray => "arrays that grow in a loop",
            Construct::HistoryInLoop => {
                "`delay` or `spatialDistribution` of a value that changes in a loop whose trip count is known only at run time"
            }
            Construct::IteratorWithoutRange => "iterators without a range",
            Construct::ModifiedClass => "modifications of local packages and functions",
            Construct::NamedStringArguments => {
                "named arguments of `String` for an operator record"
            }
            Construct::RedeclaredField => "`redeclare` in the modification of a record in a function",
            Construct::SecondDerivative => "the derivative of a derivative",
            Construct::ThisEquation => "this equation",
        })
    }
}

causes! {
    /// A gap of mocc rather than an error in the model.
    pub enum LanguageCause {
        /// A construct of the language is not supported yet.
        error MO0200 Unsupported { construct: Construct }
            => ("not supported yet: {construct}"), remedy(Some(without(*construct)));
    }
}

fn without(construct: Construct) -> String {
    match construct {
        Construct::SecondDerivative => {
            "give the first derivative a name, as in `v = der(x)`, and write `der(v)`"
        }
        Construct::ModifiedClass => {
            "redeclare it with the modifications, as in `redeclare package Medium = Air(T_0 = 300)`"
        }
        _ => "write it another way for now; docs/language.md lists the supported constructs",
    }
    .to_string()
}
