//! Diagnostics of test files.

use crate::base::cause::causes;

causes! {
    /// Causes found in a test file.
    pub enum TestCause {
        /// Two tests of a file have the same name.
        error MO1404 DuplicateTest { name: String }
            => ("there is already a test `{name}`"),
            help("give each test a name of its own: its snapshots are named after it");
        /// A test expects nothing.
        error MO1405 NothingExpected { name: String }
            => ("the test `{name}` expects nothing"),
            help("add `traces = true`, `events = true`, `flat = true`, `blocks = true`, `diagnostics = [...]` or a table `measures`");
        /// A bound of a measure is not a number or quantity.
        error MO1406 NotAQuantity { text: String }
            => ("`{text}` is not a number, nor a number with a unit"),
            help("write a number in SI units, or a string such as \"12 ms\"");
        /// A measure has no bounds.
        error MO1407 NoBounds { name: String }
            => ("the measure `{name}` has no bounds"),
            help("add `min`, `max`, or `never = true` for a condition that must not happen");
        /// No value is within the bounds of a measure.
        error MO1418 EmptyBounds { name: String }
            => ("no value of the measure `{name}` is within its bounds"),
            help("`min` must not be greater than `max`");
        /// The model of a test file cannot be found.
        error MO1408 NoModelOfTests { wanted: String }
            => ("there is no model for these tests: neither {wanted} exists"),
            help("name its file with `model = \"FILE\"`, relative to the folder of the tests");
    }
}
