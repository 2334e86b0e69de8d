//! Diagnostics of a run.

use std::fmt;

use crate::base::cause::causes;

causes! {
    /// Causes found during a run.
    pub enum RunCause {
        /// The settings of a run are out of range.
        error MO0901 Settings { why: String }
            => ("{why}");
        /// A value is infinite or undefined.
        error MO0902 NotFinite { time: f64, value: NonFinite }
            => ("at time {time} s {value}"), remedy(value.advice().map(str::to_owned));
        /// The equations of a loop do not determine an unknown.
        error MO0903 SingularLoop { time: f64, unknown: String }
            => ("at time {time} s the equations do not determine `{unknown}`: their matrix is singular"),
            help("check whether a coefficient of this variable becomes zero here");
        /// The iteration of an algebraic loop does not converge.
        error MO0904 NoSolution { time: f64, unknown: String }
            => ("at time {time} s the iteration finds no solution for `{unknown}`"),
            help("check that there is a solution at all; if so, give `start` and `nominal` values near it");
        /// A loop of discrete and continuous equations has no consistent solution.
        error MO0905 MixedLoop { time: f64, unknown: String }
            => ("at time {time} s the iteration finds no consistent value of `{unknown}`"),
            help("break the loop between the discrete and the continuous equations with `pre`");
        /// An assertion inside a function failed.
        error MO0906 FunctionAssertion { time: f64, function: String, text: String }
            => ("at time {time} s an assertion in `{function}` failed: {text}");
        /// A function does not return.
        error MO0907 NonTerminatingFunction { time: f64, function: String }
            => ("at time {time} s function `{function}` does not return"),
            help("check the condition that ends its loop, or its calls of itself");
        /// A state has no finite start value.
        error MO0908 NoFiniteStart { time: f64, state: String }
            => ("at time {time} s `{state}` has no finite start value");
        /// The integrator cannot take a step.
        error MO0909 StepTooSmall { time: f64, step: f64, state: Option<String> }
            => ("at time {time} s the step became too small ({step:e} s){}", to_follow(state)),
            help("look for a jump, a pole, or a function with infinite slope; loosen the tolerance");
        /// The maximum number of steps is exceeded.
        error MO0910 TooManySteps { time: f64, limit: u64 }
            => ("at time {time} s the limit of {limit} steps is exhausted"),
            help("loosen the tolerance, or look for an oscillation at this time");
        /// A relation switches back and forth without progress in time.
        error MO0911 Chattering { time: f64, relation: String, events: usize, duration: f64 }
            => ("at time {time} s {relation} switches without end: {events} events within {duration:e} s"),
            help("give the two branches a hysteresis or a smooth transition, or model the state between \
                  them (locked, resting) explicitly");
        /// An assertion of the model failed.
        error MO0912 Assertion { time: f64, text: String }
            => ("at time {time} s: {text}");
        /// The event iteration does not end.
        error MO0913 EndlessEventIteration { time: f64, names: Vec<String> }
            => (
                "at time {time} s the event iteration does not end: {} {} changing",
                names.join(", "),
                if names.len() == 1 { "keeps" } else { "keep" }
            ),
            help("break the cycle of conditions that trigger each other with `pre`");
        /// The interval of a `sample` is not positive.
        error MO0914 SampleInterval { interval: f64 } (section "3.7.5")
            => ("the interval of a `sample` is {interval} s, not positive");
        /// The interval of a `sample` is very short for the run.
        error MO0940 TooManyTicks { interval: f64, ticks: f64 }
            => ("a `sample` with an interval of {interval:e} s has {ticks:.2e} events in this run"),
            help("lengthen the interval, end the run earlier, or allow more with `--max-events`");
        /// A string is too long.
        error MO0941 StringTooLong { time: f64, name: String }
            => ("at time {time} s `{name}` is longer than a million characters"),
            help("shorten it: the strings of a run are all kept");
        /// The sensitivities of a run do not exist.
        error MO0917 NoSensitivities { time: f64, why: &'static str }
            => ("at time {time} s cannot compute the sensitivities: {why}");
        /// Consistent linear equations leave an unknown undetermined.
        warning MO0918 Undetermined { time: f64, unknown: String }
            => ("at time {time} s nothing determines `{unknown}`"),
            help("check what ties it down: a ground, a fixed place or a reference may be missing");
        /// A value is outside of the bounds of its variable.
        warning MO0919 BeyondBound { time: Option<f64>, name: String, value: f64, attribute: &'static str, bound: f64 }
            => ("{} is {value}, {} its `{attribute}` of {bound}", at(*time, name), side(attribute)),
            help("{}", if time.is_some() {
                "check the parameters and start values that lead there, or the bound"
            } else {
                "give it another value, or another bound"
            });
        /// The integrator cannot solve for its stages.
        error MO0930 SingularIteration { time: f64, state: Option<String> }
            => ("at time {time} s the iteration matrix of the integrator is singular{}", in_row(state)),
            help("look for a jump, a pole, or a function with infinite slope; loosen the tolerance");
        /// More variables than are reported one by one are outside of their bounds.
        warning MO0931 MoreBeyondBounds { time: f64 }
            => ("at time {time} s more variables are beyond their bounds");
        /// Events accumulate, and the solution passes the threshold at which they occur.
        error MO0932 PassedThrough { time: f64, relation: String, events: u32 }
            => ("at time {time} s the solution passes the border of `{relation}`: of {events} events there, \
                 the last turned it back by less than rounding errors"),
            help("give the model a state of rest that it enters when the bounces become small, with \
                  its own equations");
        /// A comparison without events makes the steps collapse.
        warning MO0933 HiddenSwitching { time: f64, expression: String, switches: u32, steps: u32 }
            => ("at time {time} s the steps are very short: `{expression}` switches without an event, \
                 {switches} times in {steps} steps"),
            help("remove `noEvent`, or write an `if` in place of `sign`, so that each switch is an event, \
                  or give the two branches a hysteresis or a smooth transition");
        /// Steps or events are so short that the run would not end.
        error MO0934 HopelessProgress { time: f64, total: f64, doing: &'static str }
            => ("at time {time} s {doing} are so short that the run would take {total:e} of them"),
            remedy(Some(if *doing == "steps" {
                "look for the fastest oscillation or decay of the model, which the steps must follow, \
                 and for expressions that jump; an implicit method, `--method radau`, steps over decays"
            } else {
                "lengthen the interval of the `sample` or `delay` that causes them, or end the run earlier"
            }.to_owned()));
        /// An Integer is too large for its neighbours to be told apart.
        error MO0935 IntegerTooLarge { time: f64, name: String, value: f64 } (section "4.8.2")
            => ("at time {time} s Integer `{name}` is {value:e}: from 2^53 = 9.007e15 on, Integers are not exact"),
            help("declare it as Real, or keep it smaller");
        /// A relation changes faster than the steps of the integrator.
        warning MO0936 UnresolvedRelation { relation: String }
            => ("`{relation}` changes faster than the steps: it may have been true or false for moments \
                 that no step saw"),
            help("shorten the steps with `--max-step`, to less than the shortest of these moments");
        /// A sine or cosine of time has more periods than steps can follow.
        warning MO0947 UnresolvedOscillation { periods: f64 }
            => ("a sine or cosine of time has {periods:.3e} periods in this run, more than steps can follow: \
                 events or pulses that depend on it may be missing"),
            help("end the run earlier, or describe what the oscillation does on average");
        /// The value of a delayed expression before the start depends on itself, and was not found.
        error MO0948 UnsettledHistory { time: f64 } (section "3.7.4.1")
            => ("at time {time} s the delayed expression has no value: before the start, `delay` gives the value \
                 at the start, which depends on it"),
            help("check that the equations have a solution at rest with the delay left out");
        /// The method that was chosen for a run failed, and another one took its place.
        warning MO0942 OtherMethod { method: &'static str, failure: String }
            => ("these results are those of {method}, because the first run failed: {failure}"),
            help("check them at a tighter `--tolerance`; `--method` and `--mode` choose by what means a \
                  model is run");
        /// A model does not come to rest.
        error MO0937 NotSettled { time: f64, state: String }
            => ("the model does not come to rest: at time {time} s {} still moves", named(state)),
            help("damp what oscillates, hold what drifts, or search a steady state from the initial \
                  values with `--solve`");
        /// No state near the initial values has derivatives of zero.
        error MO0938 NoSteadyState { time: f64, state: String }
            => ("no steady state is found near the initial values: {} does not come to rest", named(state)),
            help("give start values nearer to it, or let the model settle without `--solve`");
        /// A model has no linear system at a point.
        error MO0939 NotLinear { time: f64, why: &'static str }
            => ("the model cannot be linearized at time {time} s: {why}");
        /// A model that integrates itself stays where it is.
        error MO0945 ForeignNoStep { time: f64 }
            => ("the FMU makes no step at time {time} s"),
            help("choose a longer `--interval`, or report this to the maker of the FMU");
        /// A run ends before the rows that were asked for.
        error MO0946 EndsBeforeRow { time: f64, row: f64, why: String }
            => ("the run ends at {time} s, but a value at {row} s is compared: {why}"),
            help("cut the recording where the model ends, or remove what ends the run");
        /// An invariant of mocc is violated.
        error MO0999 Bug { what: String }
            => ("{what}"), help("this is a bug in mocc, please report it with the model");
    }
}

/// A value that is infinite or undefined, and the operation that produced it.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // the messages below are the documentation
pub enum NonFinite {
    Quotient {
        text: String,
        divisor: String,
    },
    Root {
        argument: String,
        value: f64,
    },
    Logarithm {
        argument: String,
        value: f64,
    },
    OutsideUnitInterval {
        text: String,
        argument: String,
        value: f64,
    },
    Power {
        text: String,
        base: f64,
        exponent: f64,
    },
    /// The motion along the border of a relation.
    Sliding {
        relation: String,
    },
    /// An unknown of the model.
    Unknown {
        name: String,
        value: f64,
    },
    /// A variable that no equation determines at this instant.
    Given {
        name: String,
        value: f64,
    },
    Expression {
        text: String,
        value: f64,
    },
    /// The derivative of a state, or its slope.
    Derivative {
        state: String,
    },
    /// A value that the message cannot name.
    Unnamed(&'static str),
}

impl fmt::Display for NonFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use NonFinite::*;
        match self {
            Quotient { text, divisor } => {
                write!(f, "division by zero: `{divisor}` is 0 in `{text}`")
            }
            Root { argument, value } => {
                write!(f, "root of a negative number: `{argument}` is {value}")
            }
            Logarithm { argument, value } => {
                write!(f, "logarithm of `{argument}`, which is {value}")
            }
            OutsideUnitInterval { text, argument, value } => {
                write!(f, "`{text}` with `{argument}` = {value}")
            }
            Power { text, base, exponent } => {
                write!(f, "`{text}` has no finite value for base {base} and exponent {exponent}")
            }
            Sliding { relation } => write!(
                f,
                "the motion along the border of `{relation}` is not determined: on both sides the distance to it changes at the same rate"
            ),
            Unknown { name, value } | Given { name, value } => write!(f, "`{name}` is {value}"),
            Expression { text, value } => write!(f, "`{text}` is {value}"),
            Derivative { state } => {
                write!(f, "the derivative of `{state}` is not finite, or its slope is not")
            }
            Unnamed(what) => write!(f, "{what} is not finite"),
        }
    }
}

impl NonFinite {
    /// How to avoid it.
    fn advice(&self) -> Option<&'static str> {
        use NonFinite::*;
        match self {
            Quotient { .. } => Some("keep the divisor away from zero, or test it with `if`"),
            Root { .. } => Some(
                "guard the argument, for instance by `max(0, ...)`, or check the sign of its terms",
            ),
            Logarithm { .. } => Some("keep the argument of the logarithm positive"),
            OutsideUnitInterval { .. } => Some("keep the argument between -1 and 1"),
            Power { .. } => Some(
                "use an Integer exponent for a negative base, and a positive one for a base of zero",
            ),
            Sliding { .. } => Some("give the two branches a hysteresis or a smooth transition"),
            Unknown { .. } => Some("check the equation that determines it"),
            Expression { .. } => Some("check the magnitudes of its operands"),
            Derivative { .. } => Some(
                "look for a pole, or a function with infinite slope there, such as a root of zero",
            ),
            Given { .. } | Unnamed(_) => None,
        }
    }
}

/// A state, or the whole model.
fn named(state: &str) -> String {
    if state.is_empty() { "the model".to_owned() } else { format!("`{state}`") }
}

fn to_follow(state: &Option<String>) -> String {
    state.as_ref().map_or_else(String::new, |name| format!(" to follow `{name}`"))
}

fn in_row(state: &Option<String>) -> String {
    state.as_ref().map_or_else(String::new, |name| format!(" for `{name}`"))
}

/// A parameter, or a variable at an instant.
fn at(time: Option<f64>, name: &str) -> String {
    match time {
        Some(time) => format!("at time {time} s `{name}`"),
        None => format!("parameter `{name}`"),
    }
}

/// The side of a bound on which a value violates it.
fn side(attribute: &str) -> &'static str {
    if attribute == "max" { "above" } else { "below" }
}
