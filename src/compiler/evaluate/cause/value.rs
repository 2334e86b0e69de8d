//! Causes found when the value of an expression is needed before simulation.

use crate::base::cause::causes;
use crate::classes::cause::word_of;
use crate::ir::ast::Variability;

causes! {
    /// Causes found when the value of an expression is needed before simulation.
    pub enum ValueCause {
        /// The structure of the model depends on a value that is known only at run time.
        error MO0213 NotEvaluable { path: Option<String> } (section "3.8.3")
            => ("{}", match path {
                Some(path) => {
                    format!("`{path}` must be known before simulation, but is not a parameter")
                }
                None => "this must be known before simulation, \
                         but depends on values that are known only at run time".to_string(),
            }),
            help("{}", match path {
                Some(_) => "make it a parameter or a constant",
                None => "use parameters and constants with values only",
            });
        /// A parameter or constant has no value when it is needed.
        error MO0214 NoValue { kind: Variability, path: String } (section "8.6")
            => ("{} `{path}` has no value", word_of(*kind)), help("give it one: `{path} = ...`");
        /// The value of a parameter or constant depends on itself.
        error MO0218 ValueCycle { path: String } (section "4.4.3")
            => ("the value of `{path}` depends on itself"), help("break the cycle of bindings");
        /// A string that is computed is too long.
        error MO1296 LongString { length: usize, most: usize }
            => ("a string of {length} characters is too long"),
            help("use no more than {most}");
        /// Expressions of a model take too many steps to evaluate.
        error MO0331 TooMuchWork { most: u64, variables: usize, components: usize }
            => ("the model takes more than {most} steps of evaluation; so far it has \
                 {components} components and {variables} variables"),
            help("check the ranges of loops and the sizes of arrays; `--max-size` of `mocc check` \
                  and `mocc simulate` allows more");
        /// The classes of a file take too many steps to check.
        error MO0332 TooManyClasses { most: u64, checked: usize, all: usize }
            => ("the classes of this file take more than {most} steps: \
                 {checked} of {all} are checked"),
            help("check the others one by one with `--model`, or allow more with `--max-size`");
        /// A list of values has a gap.
        error MO0211 MissingValue (section "8.3.1")
            => ("a value is missing in this list"),
            help("leave out values on the left of an equation only");
    }
}
