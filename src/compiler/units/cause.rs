//! Diagnostics of the unit check.

use crate::base::cause::causes;
use crate::base::diag::did_you_mean_or;

causes! {
    /// Causes found by dimensional analysis.
    pub enum UnitCause {
        /// Two expressions that are added, compared or equated have different units.
        warning MO0320 Mismatch { left: String, left_unit: String, right: String, right_unit: String }
            => ("units do not match: `{left}` is in {left_unit}, and `{right}` in {right_unit}"),
            help("correct the equation or one of the units; a factor with a unit converts between them");
        /// An exponent, or the argument of a function such as `exp`, has a unit.
        warning MO0322 NotDimensionless { role: String, text: String, unit: String }
            => ("{role} must be dimensionless, but `{text}` is in {unit}"),
            help("divide it by a reference of the same unit");
        /// Two expressions measure the same thing in units of different size or zero.
        warning MO0323 OtherScale { left: String, left_unit: String, right: String, right_unit: String }
            => ("units do not match: `{left}` is in {left_unit}, and `{right}` in {right_unit}"),
            help("convert one of them, or declare both in the same unit; `displayUnit` changes only what is shown");
        /// An argument of a function has another unit than the input that it is given for.
        warning MO0328 OtherUnitOfArgument { function: String, input: String, unit: String, text: String, text_unit: String }
            => ("units do not match: the input `{input}` of `{function}` is in `{unit}`, and `{text}` in {text_unit}"),
            help("convert the argument, or correct one of the units; `displayUnit` changes only what is shown");
        /// The unit of a variable is unknown.
        warning MO0324 UnknownUnit { unit: String, near: Option<String> } (section "19.1")
            => ("unknown unit `{unit}`"),
            remedy(did_you_mean_or(near, "write it as a product of SI units, such as `m3/(s.Pa)`; \
                                          it is not compared with others"));
    }
}
