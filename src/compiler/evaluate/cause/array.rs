//! Causes found in sizes and subscripts of arrays.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;

causes! {
    /// Causes found in sizes and subscripts of arrays.
    pub enum ArrayCause {
        /// Two expressions that must have the same size differ in it.
        error MO0215 SizesDiffer { of: Pair, left: Vec<usize>, right: Vec<usize> }
            (section "10.6")
            => ("{of} have sizes {left:?} and {right:?}"), help("give both the same size");
        /// The value of an array has another size than the array.
        error MO1229 BindingSize {
            variable: Option<String>, declared: Vec<usize>, given: Vec<usize>
        } (section "4.4.2.1")
            => ("{}", match variable {
                Some(name) => {
                    format!("`{name}` has size {declared:?}, but its value has size {given:?}")
                }
                None => format!("expected a value of size {declared:?}, found size {given:?}"),
            }),
            help("give it a value of the same size, or `fill` one");
        /// A modification of an array of components has too many or too few values.
        error MO1230 ElementModifierSize { given: Vec<usize>, wanted: Option<Vec<usize>> }
            (section "7.2.5")
            => ("{}", match (given.as_slice(), wanted) {
                (_, Some(wanted)) => format!(
                    "a value of size {given:?} has too many elements \
                     for the array of components of size {wanted:?}"
                ),
                ([], None) => "one value modifies an array of components".to_string(),
                (_, None) => format!(
                    "a value of size {given:?} has too few elements for the array of components"
                ),
            }),
            help("give one value for each element, \
                  or write `each` before the modification if all get the same");
        /// A built-in function is called with an array of the wrong size.
        error MO1231 ArgumentSize { function: String, given: Vec<Vec<usize>> } (section "10.3")
            => ("`{function}` cannot take {}", arrays(given)),
            help("pass {}", argument_of(function));
        /// The entries of an array constructor differ in size.
        error MO1232 EntrySizes { first: Vec<usize>, other: Vec<usize> } (section "10.4")
            => ("the entries of this array have sizes {first:?} and {other:?}"),
            help("give all entries the same size");
        /// Arrays of these sizes cannot be concatenated.
        error MO1233 ConcatenatedSizes { sizes: Vec<Vec<usize>> } (section "10.4.2")
            => ("cannot concatenate {}", arrays(sizes)),
            help("give them the same sizes in all other dimensions");
        /// The array arguments of a vectorized call differ in size.
        error MO1234 VectorizedSizes (section "12.4.6")
            => ("the arguments of a vectorized call have different sizes"),
            help("pass arrays of one size, or scalars");
        /// The divisor is an array.
        error MO1235 ArrayDivisor (section "10.6.5")
            => ("cannot divide by an array"), help("write `./` to divide element by element");
        /// The exponent is an array.
        error MO1236 ArrayExponent (section "10.6.7")
            => ("the exponent is an array"),
            help("write `.^` for the power of each element; \
                  after a number with a dot a space is needed: `2. .^x`");
        /// Arrays of these sizes cannot be multiplied.
        error MO1237 ProductSizes { left: Vec<usize>, right: Vec<usize> } (section "10.6.4")
            => ("cannot multiply arrays of sizes {left:?} and {right:?}"),
            help("give the second as many rows as the first has columns, \
                  or write `.*` to multiply element by element");
        /// A power of an array is not that of a square matrix with a constant exponent.
        error MO1238 MatrixPower (section "10.6.8")
            => ("only square matrices have powers, with constant Integer exponents from 0"),
            help("write `.^` for the power of each element");
        /// The numbers of values and variables in an assignment differ.
        error MO1239 AssignedCount { values: usize, targets: usize } (section "10.6.1")
            => ("cannot assign {values} values to {targets} variables"),
            help("give both sides the same size");
        /// A subscript is outside of the bounds of its dimension.
        error MO0216 OutOfBounds { subscript: String, size: usize, array: Option<String> }
            (section "10.5")
            => ("{}", match array {
                Some(array) => format!(
                    "`{subscript}` is a subscript of `{array}`, which has no elements there"
                ),
                None => format!("subscript {subscript} is outside 1 to {size}"),
            }),
            help("use a subscript within the bounds, or give the array another size");
        /// An array has more subscripts than dimensions.
        error MO1240 TooManySubscripts { given: usize, dimensions: usize } (section "10.5")
            => ("there are {given} subscripts, but only {}", counted(*dimensions)),
            help("leave out subscripts, or declare the array with more dimensions");
        /// A component that is not an array has subscripts.
        error MO1241 NotAnArray { name: Name } (section "10.5")
            => ("`{name}` is not an array"), help("leave the subscripts out");
        /// The size is asked of a dimension that the array does not have.
        error MO1242 NoSuchDimension { dimensions: usize } (section "10.3.1")
            => ("there are only {}", counted(*dimensions)),
            help("ask for one of its dimensions, counted from 1");
        /// A dimension counted by an enumeration or Boolean has a subscript of another type.
        error MO1243 SubscriptType { index: String, found: String } (section "10.5.1")
            => ("`{index}` counts this dimension, but the subscript is of type {found}"),
            help("write one of its values");
        /// The word `end` is outside of subscripts.
        error MO1202 EndOutsideSubscript (section "10.5.2")
            => ("`end` is outside of a subscript"), help("write `size` of the array");
        /// A size is negative.
        error MO0296 NegativeSize { size: i64 } (section "10.1")
            => ("a size cannot be negative, found {size}"), help("give it a size of 0 or more");
        /// An array has more elements than mocc can hold.
        error MO0297 TooManyElements { count: String, most: usize }
            => ("{count} elements are too many for one array"),
            help("use no more than {most}, or several arrays");
        /// The step of a range is zero.
        error MO1225 ZeroStep (section "10.4.3")
            => ("the step of a range cannot be zero"), help("give it another step");
        /// An iterator has no range, and none can be found from the arrays that it indexes.
        error MO1204 NoIterationRange { name: Name } (section "11.2.2.1")
            => ("cannot infer the range of `{name}`"),
            help("write `in` and a range, or use it as a subscript of an array");
        /// The function `linspace` is called for fewer than two points.
        error MO1263 TooFewPoints (section "10.3.3")
            => ("`linspace` needs at least two points"), help("ask for 2 or more");
    }
}

/// Two expressions that must have the same size.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Pair {
    Sides,
    Operands,
    Alternatives,
    StateAndValue,
}

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Pair::Sides => "the two sides",
            Pair::Operands => "the operands",
            Pair::Alternatives => "the alternatives",
            Pair::StateAndValue => "the state and its new value",
        })
    }
}

fn arrays(sizes: &[Vec<usize>]) -> String {
    match sizes {
        [one] => format!("an array of size {one:?}"),
        all => {
            let all: Vec<String> = all.iter().map(|size| format!("{size:?}")).collect();
            format!("arrays of sizes {}", all.join(" and "))
        }
    }
}

fn argument_of(function: &str) -> &'static str {
    match function {
        "cross" => "two vectors with three elements",
        "skew" => "a vector with three elements",
        "diagonal" => "a vector",
        "transpose" => "a matrix",
        "symmetric" => "a square matrix",
        "scalar" => "an array with one element",
        "vector" => "an array with at most one dimension greater than 1",
        _ => "an array with at most two dimensions greater than 1",
    }
}

fn counted(dimensions: usize) -> String {
    match dimensions {
        1 => "1 dimension".to_string(),
        n => format!("{n} dimensions"),
    }
}
