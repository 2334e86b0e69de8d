//! Causes found in calls of built-in operators.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;

causes! {
    /// Causes found in calls of built-in operators.
    pub enum BuiltinCause {
        /// The time of a `delay` varies, and it has no bound.
        error MO1247 UnboundedDelay (section "3.7.4.1")
            => ("this delay changes during simulation"),
            help("give the longest delay as third argument: `delay(x, t, t_max)`");
        /// The time of a `delay` is negative.
        error MO1248 NegativeDelay (section "3.7.4.1")
            => ("a delay cannot be negative"), help("give a time of 0 or more");
        /// The bound of a `delay` varies.
        error MO1249 VaryingDelayBound (section "3.7.4.1")
            => ("the longest delay changes during simulation"),
            help("give a parameter that no delay exceeds");
        /// The time of a `delay` exceeds its bound.
        error MO1250 DelayTooLong { delay: f64, longest: f64 } (section "3.7.4.1")
            => ("a delay of {delay} s is longer than the longest, {longest} s"),
            help("give a parameter that no delay exceeds");
        /// The position of a `spatialDistribution` never changes.
        error MO1251 FixedPosition (section "3.7.4.2")
            => ("this position never changes"),
            help("give the integral of the velocity, `der(x) = v`");
        /// The initial points of a `spatialDistribution` are invalid.
        error MO1252 InitialPoints { why: WrongPoints } (section "3.7.4.2")
            => ("{why}"),
            help("give as many values as points, from 0 at one end to 1 at the other");
        /// A function is called with iterators that is not a reduction.
        error MO1264 NotAReduction { function: String } (section "10.3.4.1")
            => ("`{function}` cannot run over iterators"),
            help("use `sum`, `product`, `min`, `max` or `array`");
        /// The operator `reinit` is outside of a when-equation.
        error MO1265 ReinitOutsideWhen (section "8.3.6")
            => ("`reinit` is outside of a when-equation"),
            help("write it in a `when` of an `equation` section");
        /// The operator `terminate` is outside of a when-equation.
        error MO1266 TerminateOutsideWhen (section "8.3.8")
            => ("`terminate` is outside of a when-equation"),
            help("write it in a `when`, whose condition decides when it acts");
        /// An equation or statement is used as a value.
        error MO1267 CallWithoutValue { name: Name } (section "8.3")
            => ("`{name}` is an equation or statement, and has no value"),
            help("write it as an equation or statement of its own");
        /// An operator that only has a value is written as an equation or statement.
        error MO1293 UnusedValue { name: Name } (section "8.3")
            => ("this is not an equation or statement: `{name}` only has a value"),
            help("use the value, as in `y = {name}(...)`, or remove the line");
        /// An operator on variables of a model is used in a function.
        error MO1297 OperatorInFunction { name: Name } (section "12.2")
            => ("`{name}` has no meaning in a function"),
            help("a function only knows the values of its arguments: pass what it needs as an input");
        /// An operator such as `pre` has an argument that is not a variable.
        error MO1268 ArgumentNotVariable { function: String } (section "3.7.5")
            => ("the argument of `{function}` must be a variable"),
            help("give the expression a name, and use that as the argument");
        /// The operator `cardinality` has an argument that is not a connector.
        error MO1269 CardinalityOfOther (section "3.7.4.3")
            => ("the argument of `cardinality` must be a connector"), help("name a connector");
        /// The roots of connection graphs are asked for where the connections are not known yet.
        error MO1350 RootOutsideEquations (section "9.4.1")
            => ("the roots of connection graphs are not known here"),
            help("ask for them in an equation or in the value of a variable");
        /// `rooted` is asked of a variable that is not in exactly one branch.
        error MO1351 RootedWithoutBranch (section "9.4.1")
            => ("`rooted` needs a variable that is in exactly one `Connections.branch`"),
            help("use `Connections.isRoot`, or ask at one end of the branch");
        /// The argument of a stream operator is not a stream variable.
        error MO1352 NotAStream (section "15.2")
            => ("the argument must be a `stream` variable of a connector"),
            help("name a variable that its connector declares with `stream`");
        /// A variable of which a connection graph knows nothing.
        error MO1353 NotAGraphNode (section "9.4.1")
            => ("the argument must be an overdetermined variable or record of a connector"),
            help("name one whose type has a function `equalityConstraint`");
        /// A counter or resolution of a clock is out of range.
        error MO0355 ClockCounter (section "16.3")
            => ("counters and factors of clocks must be 0 or more, and their resolution 1 or more"),
            help("give Integer parameters or literals in this range");
        /// Something other than a block is used as the state of a state machine.
        error MO0356 NotAState (section "17.1")
            => ("a state of a state machine must be a block"),
            help("name a component of a class with `block`; `transition` takes two and a condition");
        /// A `String` has an invalid format.
        error MO1270 NumberFormat { format: String } (section "3.7.1")
            => ("cannot write a number in the format `{format}`"),
            help("write it as in C without the %: \"8.3f\", \".6g\", \"12.4e\"");
    }
}

/// Why the initial points of a `spatialDistribution` are invalid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WrongPoints {
    Count { points: usize, values: usize },
    TooFew,
    NotRising,
}

impl fmt::Display for WrongPoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WrongPoints::Count { points, values } => {
                write!(f, "{points} initial points have {values} initial values")
            }
            WrongPoints::TooFew => {
                f.write_str("there must be at least two initial points, 0 and 1")
            }
            WrongPoints::NotRising => f.write_str("the initial points do not rise from 0 to 1"),
        }
    }
}
