//! Errors of lowering a flat model to a system of equations: codes MO0301 to MO0399.

use crate::base::diag::Diagnostic;
use crate::ir::dae;
use crate::ir::flat::{Origin, Variable};

/// MO0301: parameters whose values depend on each other.
pub fn parameter_cycle(cycle: &[&Variable]) -> Diagnostic {
    let mut path: Vec<&str> = cycle.iter().map(|v| v.name.as_str()).collect();
    path.extend(path.first().copied());
    let message = format!("the values of parameters depend on each other: {}", path.join(" -> "));
    let first = cycle.first().map_or(crate::base::source::Span::NONE, |v| v.span);
    let mut d = Diagnostic::error("MO0301", first, message)
        .label("its value needs itself")
        .help("give one of them a value that does not depend on the others");
    for v in cycle.iter().skip(1) {
        d = d.also(v.span, format!("`{}` is part of the cycle", v.name));
    }
    d
}

/// MO0302: a parameter that takes its start value because it has no other.
pub fn parameter_at_start(v: &Variable) -> Diagnostic {
    Diagnostic::warning(
        "MO0302",
        v.span,
        format!("parameter `{}` has no value: its start value is used", v.name),
    )
    .help(format!("write `{} = ...` where it is declared or modified", last(&v.name)))
    .note("Modelica 3.6, section 8.6: `start` is only a fallback for parameters")
}

/// MO0303: a parameter or constant without any value.
pub fn no_value(v: &Variable) -> Diagnostic {
    Diagnostic::error("MO0303", v.span, format!("`{}` has no value", v.name))
        .label("declared without a value")
        .help(format!(
            "write `{} = ...` where it is declared or modified, or `fixed = false` if initial \
             equations determine it",
            last(&v.name)
        ))
}

/// MO0304: the value of a parameter changes with time.
pub fn varying_parameter(v: &Variable, culprit: &str) -> Diagnostic {
    Diagnostic::error(
        "MO0304",
        v.span,
        format!("the value of parameter `{}` depends on `{culprit}`, which varies", v.name),
    )
    .help("drop `parameter`, or use parameters and constants only in its value")
    .note("Modelica 3.6, section 3.8: variability of declaration equations")
}

/// MO0305: equal variables with different fixed starts.
pub fn conflicting_starts(a: &dae::Variable, b: &dae::Variable) -> Diagnostic {
    Diagnostic::error(
        "MO0305",
        a.span,
        format!("`{}` and `{}` are equal but have different fixed start values", a.name, b.name),
    )
    .label(format!("`{}`", a.name))
    .also(b.span, format!("`{}`", b.name))
    .help("keep `fixed = true` on one of them only")
}

/// MO0306: a discrete variable with two equations.
pub fn assigned_twice(v: &dae::Variable, first: &Origin, second: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0306",
        second.span,
        format!("`{}` is assigned in more than one place", v.name),
    )
    .label("assigned again here")
    .also(first.span, "assigned here first")
    .help("join the when-clauses into one with `elsewhen`")
    .note("Modelica 3.6, section 8.3.5.3: the single assignment rule for when-equations")
}

/// MO0307: a discrete variable without an equation.
pub fn no_discrete_equation(v: &dae::Variable) -> Diagnostic {
    Diagnostic::error("MO0307", v.span, format!("discrete variable `{}` has no equation", v.name))
        .label("nothing assigns it")
        .help("assign it in a when-clause or by an equation with it alone on one side")
}

/// MO0308: a discrete equation that is not an assignment.
pub fn not_assigned_form(origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0308",
        origin.span,
        "an equation between discrete expressions must have a discrete variable alone on one side",
    )
    .label(in_component(origin))
    .help("write `variable = expression`")
    .note("Modelica 3.6, section 8.3.5.1 and appendix B: discrete equations are solved as written")
}

/// MO0309: `==` or `<>` between reals that vary.
pub fn equality_of_reals(op: &str, origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0309",
        origin.span,
        format!("`{op}` between continuous Real expressions has no event"),
    )
    .label(in_component(origin))
    .help("compare with `<=` or `>=`, or with a tolerance: `abs(a - b) < eps`")
    .note("Modelica 3.6, section 3.5: equality of Reals is allowed in functions only")
}

// MO0310 is retired: it reported event-triggering functions before they generated events.

// MO0317 is retired: it reported variable delays before they were supported.

/// MO0321: the initial values of `spatialDistribution` vary during simulation.
pub fn varying_distribution(origin: &Origin) -> Diagnostic {
    let message = "the distribution in the beginning changes while the model runs";
    Diagnostic::error("MO0321", origin.span, message)
        .help("give parameters as `initialPoints` and `initialValues`")
        .note("section 3.7.4.2 of the specification")
}

/// MO0311: `sample` with arguments that vary.
pub fn varying_sample(origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0311",
        origin.span,
        "the start and the interval of `sample` must be parameter expressions",
    )
    .label(in_component(origin))
    .help("for a varying period write `when time >= pre(next) then next = ...`")
}

/// MO0312: `reinit` of something that is not differentiated.
pub fn reinit_of_no_state(v: &dae::Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0312",
        origin.span,
        format!(
            "`reinit` needs a variable whose derivative occurs, and `der({})` does not",
            v.name
        ),
    )
    .label("reinitialised here")
    .also(v.span, format!("`{}` is declared here", v.name))
    .note("Modelica 3.6, section 8.3.6")
}

/// MO0313: a when-clause among initial equations.
pub fn initial_when(origin: &Origin) -> Diagnostic {
    Diagnostic::error("MO0313", origin.span, "a when-clause can not stand in an initial equation")
        .help("use `if`, or `when initial()` in an equation section")
}

/// MO0314: an initial equation of discrete variables that is not in assigned form.
pub fn initial_discrete(origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0314",
        origin.span,
        "an initial equation of discrete variables must give one of them its value",
    )
    .label(in_component(origin))
    .help("write `variable = expression`, or `pre(variable) = parameter expression`")
}

/// MO0315: a when-clause assigns a parameter or an input.
pub fn assigned_parameter(v: &Variable) -> Diagnostic {
    Diagnostic::error(
        "MO0315",
        v.span,
        format!("`{}` is assigned in a when-clause but can not change", v.name),
    )
    .help("declare it `discrete Real`, `Integer` or `Boolean` without `parameter`")
}

/// MO0316: the derivative of a discrete variable.
pub fn rate_of_discrete(v: &dae::Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0316",
        origin.span,
        format!("`{}` changes at events only and has no derivative", v.name),
    )
    .label(format!("`der({})` is used here", v.name))
    .also(v.span, "declared here")
    .help("use `reinit` in the when-clause instead of assigning the variable there")
    .note("Modelica 3.6, section 3.7.4.1: the argument of `der` is continuous")
}

fn last(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, last)| last)
}

fn in_component(origin: &Origin) -> String {
    if origin.component.is_empty() { String::new() } else { format!("in `{}`", origin.component) }
}
