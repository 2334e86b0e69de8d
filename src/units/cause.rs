//! Diagnostics of the unit check.

use crate::base::cause::causes;

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
    }
}
