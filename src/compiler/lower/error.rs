//! Diagnostics of lowering a flat model to a system of equations.

use crate::base::cause::causes;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::dae;
use crate::ir::flat::{Origin, Variable};

// MO0310 and MO0317 are retired: they reported event-triggering functions and variable delays before these were
// supported.
causes! {
    /// Causes found while a flat model is lowered.
    pub enum LoweringCause {
        /// The values of parameters depend on each other.
        error MO0301 ParameterCycle { path: String } (section "4.4.3")
            => ("the values of parameters depend on each other: {path}"),
            help("give one of them a value that does not depend on the others");
        /// A parameter has no value but a start value.
        warning MO0302 ParameterAtStart { name: String } (section "8.6")
            => ("parameter `{name}` has no value: its start value is used"),
            help("write `{} = ...` where it is declared or modified", last(name));
        /// A parameter or constant has neither a value nor a start value.
        error MO0303 NoValue { name: String }
            => ("`{name}` has no value"),
            help("write `{} = ...` where it is declared or modified, or `fixed = false` if initial \
                  equations determine it", last(name));
        /// The value of a parameter depends on a variable.
        error MO0304 VaryingParameter { name: String, depends_on: String } (section "3.8")
            => ("the value of parameter `{name}` depends on `{depends_on}`, which varies"),
            help("remove `parameter`, or use only parameters and constants in its value");
        /// Two equal variables have different fixed start values.
        error MO0305 ConflictingStarts { first: String, second: String }
            => ("`{first}` and `{second}` are equal but have different fixed start values"),
            help("keep `fixed = true` on one of them only");
        /// A discrete variable is assigned by more than one when-clause or equation.
        error MO0306 AssignedTwice { name: String } (section "8.3.5.4")
            => ("`{name}` is assigned in more than one place"),
            help("join the when-clauses into one with `elsewhen`");
        /// A discrete variable is never assigned.
        error MO0307 NoDiscreteEquation { name: String }
            => ("discrete variable `{name}` has no equation"),
            help("assign it in a when-clause or by an equation with it alone on one side");
        /// An equation between discrete expressions is not an assignment.
        error MO0308 NotAssignedForm (section "B")
            => ("an equation between discrete expressions must have a discrete variable alone on one side"),
            help("write `variable = expression`");
        /// `==` or `<>` compares values that vary between events.
        error MO0309 EqualityBetweenEvents { operator: String, values: &'static str, remedy: &'static str } (section "3.5")
            => ("cannot compare {values} with `{operator}` outside of functions"),
            help("{remedy}");
        /// `pre` of a continuous variable outside of a when-clause.
        error MO0325 PreOfContinuous { name: String } (section "3.7.5")
            => ("`pre({name})` outside of a when-clause: `{name}` is continuous"),
            help("use it in a `when`, or `delay({name}, T)` for an earlier value");
        /// A discrete variable has two different first values.
        error MO0335 TwoFirstValues { name: String } (section "8.6")
            => ("`{name}` has two different values at the start"),
            help("keep one of them: an initial equation, or `fixed = true`");
        /// A parameter with `fixed = false` has a value as well.
        warning MO0337 GuessOfParameter { name: String } (section "8.6")
            => ("the value of `{name}` is only its first guess: it has `fixed = false`"),
            help("remove `fixed = false` if no initial equation determines it, or else write the value as `start`");
        /// The interval of `sample` varies.
        error MO0311 VaryingSample (section "3.7.5")
            => ("the start and the interval of `sample` must be parameter expressions"),
            help("for a varying period write `when time >= pre(next) then next = ...`");
        /// `reinit` of a variable that is not differentiated.
        error MO0312 ReinitWithoutDerivative { name: String } (section "8.3.6")
            => ("cannot reinitialize `{name}`: its derivative does not occur in the model"),
            help("reinitialize a state, or assign `{name}` in a when-clause");
        /// An initial equation section contains a when-clause.
        error MO0313 InitialWhen (section "8.3.5.2")
            => ("an initial equation cannot be a when-clause"),
            help("use `if`, or `when initial()` in an equation section");
        /// An initial equation between discrete expressions is not an assignment.
        error MO0314 InitialNotAssignedForm (section "8.6")
            => ("an initial equation of discrete variables must have one of them alone on one side"),
            help("write `variable = expression`, or `pre(variable) = parameter expression`");
        /// A when-clause assigns a parameter, a constant or an input.
        error MO0315 AssignedParameter { name: String } (section "4.4.4")
            => ("cannot assign `{name}`: it does not change during simulation"),
            help("declare it without `parameter` or `constant`");
        /// The derivative of a discrete variable.
        error MO0316 DerivativeOfDiscrete { name: String } (section "3.7.4")
            => ("cannot differentiate `{name}`: it changes only at events"),
            help("use `reinit` in the when-clause instead of assigning the variable there");
        /// The initial distribution of `spatialDistribution` varies.
        error MO0321 VaryingDistribution (section "3.7.4.2")
            => ("`initialPoints` and `initialValues` of `spatialDistribution` must be parameter expressions"),
            help("use only parameters and constants in them");
    }
}

/// A parameter with `fixed = false` and a value.
pub fn guess_of_parameter(v: &Variable) -> Diagnostic {
    Diagnostic::new(LoweringCause::GuessOfParameter { name: v.name.clone() }, v.span)
}

/// Parameters whose values depend on each other.
pub fn parameter_cycle(cycle: &[&Variable]) -> Diagnostic {
    let mut path: Vec<&str> = cycle.iter().map(|v| v.name.as_str()).collect();
    path.extend(path.first().copied());
    let cause = LoweringCause::ParameterCycle { path: path.join(" -> ") };
    let first = cycle.first().map_or(Span::NONE, |v| v.span);
    let mut d = Diagnostic::new(cause, first).label("its value depends on itself");
    for v in cycle.iter().skip(1) {
        d = d.also(v.span, format!("`{}` is part of the cycle", v.name));
    }
    d
}

/// A parameter that takes its start value because it has no other.
pub fn parameter_at_start(v: &Variable) -> Diagnostic {
    Diagnostic::new(LoweringCause::ParameterAtStart { name: v.name.clone() }, v.span)
}

/// A parameter or constant without any value.
pub fn no_value(v: &Variable) -> Diagnostic {
    Diagnostic::new(LoweringCause::NoValue { name: v.name.clone() }, v.span)
        .label("declared without a value")
}

/// The value of a parameter changes with time.
pub fn varying_parameter(v: &Variable, culprit: &str) -> Diagnostic {
    let (name, depends_on) = (v.name.clone(), culprit.to_owned());
    Diagnostic::new(LoweringCause::VaryingParameter { name, depends_on }, v.span)
}

/// Equal variables with different fixed starts.
pub fn conflicting_starts(a: &dae::Variable, b: &dae::Variable) -> Diagnostic {
    let (first, second) = (a.name.clone(), b.name.clone());
    Diagnostic::new(LoweringCause::ConflictingStarts { first, second }, a.span)
        .label(format!("`{}`", a.name))
        .also(b.span, format!("`{}`", b.name))
}

/// A discrete variable with two equations.
pub fn assigned_twice(v: &dae::Variable, first: &Origin, second: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::AssignedTwice { name: v.name.clone() }, second.span)
        .label("assigned again here")
        .also(first.span, "assigned here first")
}

/// A discrete variable whose first value is given twice, with different values.
pub fn two_first_values(v: &dae::Variable, origin: &Origin) -> Diagnostic {
    let cause = LoweringCause::TwoFirstValues { name: v.name.clone() };
    Diagnostic::new(cause, origin.span)
        .label("another value here")
        .also(v.span, format!("start of `{}`", v.name))
}

/// A discrete variable without an equation.
pub fn no_discrete_equation(v: &dae::Variable) -> Diagnostic {
    Diagnostic::new(LoweringCause::NoDiscreteEquation { name: v.name.clone() }, v.span)
        .label("nothing assigns it")
}

/// A discrete equation that is not an assignment.
pub fn not_assigned_form(origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::NotAssignedForm, origin.span).label(in_component(origin))
}

/// `pre` of a continuous variable outside of a when-clause.
pub fn pre_of_continuous(v: &dae::Variable, origin: &Origin) -> Diagnostic {
    let cause = LoweringCause::PreOfContinuous { name: v.name.clone() };
    Diagnostic::new(cause, origin.span).label(in_component(origin))
}

/// `==` or `<>` between values that vary between events, which are Reals or of a discrete type.
pub fn equality_between_events(op: &str, are_reals: bool, origin: &Origin) -> Diagnostic {
    let operator = op.to_owned();
    let (values, remedy) = match are_reals {
        true => (
            "continuous Real expressions",
            "compare with `<=` or `>=`, or with a tolerance: `abs(a - b) < eps`",
        ),
        false => (
            "values that change between events",
            "write relations without `noEvent`, and in the model rather than in a function, so that they generate events",
        ),
    };
    let cause = LoweringCause::EqualityBetweenEvents { operator, values, remedy };
    Diagnostic::new(cause, origin.span).label(in_component(origin))
}

/// The initial values of `spatialDistribution` vary during simulation.
pub fn varying_distribution(origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::VaryingDistribution, origin.span)
}

/// `sample` with arguments that vary.
pub fn varying_sample(origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::VaryingSample, origin.span).label(in_component(origin))
}

/// `reinit` of something that is not differentiated.
pub fn reinit_of_no_state(v: &dae::Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::ReinitWithoutDerivative { name: v.name.clone() }, origin.span)
        .label("reinitialized here")
        .also(v.span, format!("`{}` is declared here", v.name))
}

/// A when-clause among initial equations.
pub fn initial_when(origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::InitialWhen, origin.span)
}

/// An initial equation of discrete variables that is not in assigned form.
pub fn initial_discrete(origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::InitialNotAssignedForm, origin.span).label(in_component(origin))
}

/// A when-clause assigns a parameter or an input.
pub fn assigned_parameter(v: &Variable) -> Diagnostic {
    Diagnostic::new(LoweringCause::AssignedParameter { name: v.name.clone() }, v.span)
}

/// An algorithm assigns a parameter.
pub fn assigned_by_algorithm(v: &Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::AssignedParameter { name: v.name.clone() }, v.span)
        .label("a parameter or constant")
        .also(origin.span, "assigned here")
}

/// The derivative of a discrete variable.
pub fn rate_of_discrete(v: &dae::Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::new(LoweringCause::DerivativeOfDiscrete { name: v.name.clone() }, origin.span)
        .label(format!("`der({})` is used here", v.name))
        .also(v.span, "declared here")
}

fn last(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, last)| last)
}

fn in_component(origin: &Origin) -> String {
    if origin.component.is_empty() { String::new() } else { format!("in `{}`", origin.component) }
}
