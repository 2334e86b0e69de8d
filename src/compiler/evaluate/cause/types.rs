//! Causes found when the types of expressions are compared with the types that are expected.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;

causes! {
    /// Causes found when the types of expressions are checked.
    pub enum TypeCause {
        /// An expression is of another type than expected.
        error MO0212 WrongType { expected: Expected, found: String } (section "6.7")
            => ("expected {expected}, found {found}"), remedy(expected.remedy(found));
        /// Two expressions of different types are compared or equated.
        error MO1220 IncompatibleTypes { left: String, right: String, as_: Pairing, by: Conversion }
            (section "6.7")
            => ("{left} and {right} cannot be {as_}"), help("{}", by.remedy());
        /// A record lacks a field of the record that it is equated with.
        error MO1221 MissingField { name: Name } (section "6.7")
            => ("the right side has no field `{name}`"),
            help("use records of the same class on both sides");
        /// An operator record does not define an operator for these operands.
        error MO1224 UnknownOperator { class: Name, operator: String } (section "14.5")
            => ("`{class}` has no operator {operator} for these operands"),
            help("define the operator in the record, or convert the operands");
        /// The operator `der` is applied to an expression that has no derivative.
        error MO1226 NotDifferentiable { what: Underived } (section "3.7.4")
            => ("cannot differentiate {what}"), help("{}", what.remedy());
        /// A relation has an operand that is not a scalar.
        error MO1228 ComparedArray { found: String } (section "3.5")
            => ("expected scalars in a comparison, found {found}"),
            help("compare the elements one by one");
        /// A variable that changes at events only is given a value that changes between them.
        error MO0247 ContinuousValue { of: String } (section "3.8.4")
            => ("a value of type {of} may change at events only, but this changes between them"),
            help("{}", match of.as_str() {
                "String" => "put the string together in a when-clause",
                _ => "write the relation in the model, outside of functions and without `noEvent`, \
                      or compute it in a when-clause",
            });
    }
}

/// The type that an expression should have.
#[derive(Clone, PartialEq, Debug)]
#[allow(missing_docs)]
pub enum Expected {
    Scalar,
    Number,
    Boolean,
    Clock,
    Integer,
    Vector,
    /// The message of an assertion.
    Message,
    Subscript,
    /// The Integer or Real bounds and step of a range.
    RangeBound,
    /// An array with so many dimensions.
    Array {
        dimensions: usize,
    },
    Record,
    /// What is assigned to a variable of this type.
    Assigned {
        ty: String,
    },
    /// The value or attribute of a variable, of this type.
    Attribute {
        attribute: String,
        ty: String,
    },
}

impl Expected {
    fn remedy(&self, found: &str) -> Option<String> {
        let help = match self {
            Expected::Scalar => "take one element of it",
            Expected::Number | Expected::RangeBound if found == "Boolean" => {
                "write `if b then 1 else 0` for the number of a Boolean"
            }
            Expected::Number | Expected::RangeBound => "use a Real or Integer expression",
            Expected::Boolean if found.starts_with("an array") => {
                "join the elements with `and` or `or`, or take one of them"
            }
            Expected::Boolean => "write a comparison, such as `x > 0`",
            Expected::Clock => "write an interval, a condition or a clock",
            Expected::Integer | Expected::Subscript => "use an Integer expression",
            Expected::Vector => "write a range such as `1:n`, or an array with one dimension",
            Expected::Message => "write `String(x)` for the value of an expression",
            Expected::Array { dimensions: 1 } => "write a vector, such as `{1, 2, 3}`",
            Expected::Array { .. } => "give it as many dimensions as the variable has",
            Expected::Record => "use a record with the same fields",
            Expected::Assigned { ty } => match (ty.as_str(), found) {
                ("Integer", "Real") => {
                    "round it, as in `integer(x)`, or declare the variable as `Real`"
                }
                ("Integer" | "Real", "Boolean") => {
                    "write `if b then 1 else 0` for the number of a Boolean"
                }
                ("Boolean", "Integer" | "Real") => "write a comparison, such as `x > 0`",
                ("String", _) => "write `String(x)` for the string of a value",
                _ => return Some(format!("use an expression of type {ty}")),
            },
            Expected::Attribute { ty, .. } => {
                return Some(format!("use an expression of type {ty}"));
            }
        };
        Some(help.to_string())
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Expected::Scalar => "a scalar",
            Expected::Number => "a number",
            Expected::Boolean => "a Boolean",
            Expected::Clock => "a clock, or what defines one",
            Expected::Integer => "an Integer",
            Expected::Vector => "a vector",
            Expected::Message => "a String as the message",
            Expected::Subscript => "an Integer as the subscript",
            Expected::RangeBound => "numbers in a range",
            Expected::Array { dimensions: 1 } => "a vector",
            Expected::Array { dimensions } => {
                return write!(f, "an array with {dimensions} dimensions");
            }
            Expected::Record => "a record",
            Expected::Assigned { ty } => return write!(f, "a value of type {ty}"),
            Expected::Attribute { attribute, ty } if attribute == "value" => {
                return write!(f, "a value of type {ty}");
            }
            Expected::Attribute { attribute, ty } => {
                return write!(f, "`{attribute}` of type {ty}");
            }
        })
    }
}

/// How two expressions are used together.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Pairing {
    Compared,
    Alternatives,
    Equal,
}

impl fmt::Display for Pairing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Pairing::Compared => "compared",
            Pairing::Alternatives => "alternatives of one expression",
            Pairing::Equal => "equal",
        })
    }
}

/// How one type is converted to another.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Conversion {
    BooleanAndNumber,
    EnumerationAndNumber,
    ToString,
    None,
}

impl Conversion {
    fn remedy(self) -> &'static str {
        match self {
            Conversion::BooleanAndNumber => {
                "write `true` and `false` for Booleans, a comparison such as `x > 0` \
                 for one made of numbers, and `if b then 1 else 0` for a number made of one"
            }
            Conversion::EnumerationAndNumber => {
                "write a literal of the enumeration, as in `Kind.first`, \
                 or `Integer(e)` for its number"
            }
            Conversion::ToString => "write `String(x)` for the string of a value",
            Conversion::None => "give both sides the same type",
        }
    }
}

/// An expression that has no derivative.
#[derive(Clone, PartialEq, Debug)]
pub enum Underived {
    /// It is of this type.
    Type(String),
    /// It is a discrete-time variable.
    Discrete,
}

impl Underived {
    fn remedy(&self) -> &'static str {
        match self {
            Underived::Type(_) => "write `der` of a Real expression",
            Underived::Discrete => "leave `discrete` out where it is declared, or write 0",
        }
    }
}

impl fmt::Display for Underived {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Underived::Type(ty) => write!(f, "an expression of type {ty}"),
            Underived::Discrete => f.write_str("a discrete variable"),
        }
    }
}
