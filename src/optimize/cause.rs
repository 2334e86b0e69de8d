//! Diagnostics of plans of designs.

use crate::base::cause::causes;

causes! {
    /// Causes found in the plan of a design.
    pub enum DesignCause {
        /// A plan has no goal, or more than one.
        error MO1412 NoGoal
            => ("the plan needs one goal"),
            help("[goal]: minimize = \"t_switch = when(s > 0.95*s_max)\", or maximize = ...");
        /// A parameter has no range.
        error MO1413 NoRange { name: String }
            => ("`{name}` needs `min` and `max`"),
            help("the search stays between them: {name} = {{ min = ..., max = ... }}");
        /// A plan frees no parameter.
        error MO1414 NothingFree
            => ("the plan frees no parameter"),
            help("[free]: m = {{ min = 0.02, max = 0.05 }}");
        /// The range of a parameter or of a limit is empty.
        error MO1415 EmptyRange { name: String }
            => ("the range of `{name}` is empty"),
            help("`min` must be less than `max`, and `start` between them");
        /// A value is neither a number nor a quantity.
        error MO1416 NotAValue { text: String }
            => ("`{text}` is not a number, nor a number with a unit"),
            help("write a number in SI units, or a string such as \"12 ms\"");
        /// A value is in a unit that its parameter or measure is not.
        error MO1417 OtherUnit { name: String, declared: String, unit: String }
            => ("`{name}` is in `{declared}`, which `{unit}` does not measure"),
            help("give the value in another unit, or without one: it is then in `{declared}`");
    }
}
