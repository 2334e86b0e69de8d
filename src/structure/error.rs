//! Errors of the structural analysis: codes MO0401 to MO0499.

use super::explain::{list, origin, with_places};
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, EqId, Equation, Variable};
use crate::ir::expr::VarId;
use crate::ir::flat::Origin;
use crate::symbolic::print;

/// MO0401: unknowns that the equations do not determine. `counts`: equations and unknowns of the
/// model.
pub fn too_few_equations(
    dae: &Dae,
    counts: (usize, usize),
    missing: usize,
    sources: &[Source],
    variables: &[VarId],
) -> Diagnostic {
    let of = variables.iter().map(|v| &dae.variables[*v]);
    let names = list(of.clone());
    let message = match (sources.len(), variables.len()) {
        (0, 1) => format!("no equation determines {names}"),
        (0, _) => format!("no equations determine {names}"),
        (rows, cols) => format!(
            "{} can not determine {cols} unknowns: {names}",
            if rows == 1 { "one equation".into() } else { format!("{rows} equations") }
        ),
    };
    let first = variables.first().map_or(Span::NONE, |v| dae.variables[*v].span);
    // Variables of several instances share the line of their declaration, so each label names its
    // own.
    let label = |v: &VarId| match variables.len() {
        1 => "not determined".to_string(),
        _ => format!("`{}` is not determined", dae.variables[*v].name),
    };
    let mut d = Diagnostic::error("MO0401", first, message);
    d.primary.1 = variables.first().map_or_else(String::new, label);
    for v in variables.iter().skip(1).take(4) {
        d = d.also(dae.variables[*v].span, label(v));
    }
    for source in sources.iter().take(4) {
        d = d.also(origin(dae, *source).span, "determines only one of them");
    }
    d.note(total(dae, counts)).help(format!(
        "add {} for {names}, or give {} a value where it is declared",
        if missing == 1 { "an equation".into() } else { format!("{missing} equations") },
        if variables.len() == 1 { "it" } else { "one of them" },
    ))
}

/// MO0402: more equations than unknowns.
pub fn too_many_equations(
    dae: &Dae,
    counts: (usize, usize),
    excess: usize,
    sources: &[Source],
    variables: &[VarId],
) -> Diagnostic {
    let names = list(variables.iter().map(|v| &dae.variables[*v]));
    let message = match (sources.len(), variables.len()) {
        (1, 0) => "this equation has no unknown that it could determine".into(),
        (rows, 0) => format!("{rows} equations have no unknown that they could determine"),
        (rows, 1) => format!("{rows} equations for one unknown: {names}"),
        (rows, cols) => format!("{rows} equations for {cols} unknowns: {names}"),
    };
    let d = Diagnostic::error("MO0402", Span::NONE, message);
    let d = with_places(d, dae, sources, |source, origin| label(dae, source, origin));
    d.note(total(dae, counts)).help(if excess == 1 {
        "remove one of these equations, or make a known quantity in them unknown".to_string()
    } else {
        format!("remove {excess} of these equations, or make known quantities in them unknown")
    })
}

/// MO0403: constraints that repeat or contradict each other for all values.
pub fn dependent(dae: &Dae, equations: &[EqId]) -> Diagnostic {
    let d = Diagnostic::error(
        "MO0403",
        Span::NONE,
        "these equations repeat or contradict each other: the model has no unique solution",
    );
    let sources: Vec<Source> = equations.iter().map(|id| Source::Continuous(*id)).collect();
    with_places(d, dae, &sources, |source, origin| label(dae, source, origin))
        .note("as many equations as unknowns, but some follow from the others")
        .help("remove a redundant constraint, such as a second rigid connection in a loop")
}

/// MO0404: an equation with a function call must be differentiated.
pub fn not_differentiable(dae: &Dae, equation: EqId, constraint: &[EqId]) -> Diagnostic {
    let span = dae.equations[equation].origin.span;
    let mut d = Diagnostic::error(
        "MO0404",
        span,
        "this equation constrains states and must be differentiated, but calls a function without \
         derivative",
    )
    .label("must be differentiated")
    .help("write the function without loops, so that it can be inlined, or break the constraint");
    for id in constraint.iter().filter(|id| **id != equation).take(4) {
        d = d.also(dae.equations[*id].origin.span, "part of the same constraint");
    }
    d
}

/// MO0405: `stateSelect = always` cannot be satisfied.
pub fn not_a_state(v: &Variable) -> Diagnostic {
    Diagnostic::error(
        "MO0405",
        v.span,
        format!("`{}` can not be a state: other states already determine it", v.name),
    )
    .label("declared with `stateSelect = StateSelect.always`")
    .help("use `StateSelect.prefer`, or drop the wish for another variable of the constraint")
}

/// MO0405: `stateSelect = always` of a variable that is discontinuous.
pub fn jumping_state(v: &Variable) -> Diagnostic {
    Diagnostic::error("MO0405", v.span, format!("`{}` can not be a state: it jumps", v.name))
        .label("declared with `stateSelect = StateSelect.always`")
        .help("leave `stateSelect` out: a state is continuous between events (section 4.9.7.1)")
}

/// MO0406: `stateSelect = never` cannot be satisfied.
///
/// A warning if there is a `substitute` that the modeller could have selected as the state instead.
pub fn needed_as_state(v: &Variable, substitute: bool) -> Diagnostic {
    let message = format!("`{}` must be a state: nothing else determines it", v.name);
    let diagnostic = match substitute {
        true => Diagnostic::warning("MO0406", v.span, message),
        false => Diagnostic::error("MO0406", v.span, message),
    };
    diagnostic
        .label("declared with `stateSelect = StateSelect.never`")
        .help("use `StateSelect.avoid`")
}

/// MO0407: `reinit` of a variable that other states determine.
pub fn reinit_of_dependent(v: &Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::error(
        "MO0407",
        origin.span,
        format!("`{}` can not be reinitialised: other states determine it", v.name),
    )
    .label("reinitialised here")
    .also(v.span, "declared here")
    .help(format!("declare `{}` with `stateSelect = StateSelect.always`", v.name))
}

/// MO0408: too many initial equations and fixed starts.
pub fn initially_too_many(
    dae: &Dae,
    excess: usize,
    sources: &[Source],
    variables: &[VarId],
) -> Diagnostic {
    let names = list(variables.iter().map(|v| &dae.variables[*v]));
    let d = Diagnostic::error(
        "MO0408",
        Span::NONE,
        format!("the start of the simulation is determined more than once: {names}"),
    );
    // The conditions that the user is most likely to remove come first.
    let mut sources = sources.to_vec();
    sources.sort_by_key(|source| match source {
        Source::Start(_) => 0,
        Source::Initial(_) => 1,
        _ => 2,
    });
    with_places(d, dae, &sources, |source, origin| label(dae, source, origin)).help(format!(
        "remove {} initial {} or `fixed = true`",
        if excess == 1 { "one".into() } else { excess.to_string() },
        if excess == 1 { "equation" } else { "equations" },
    ))
}

/// MO0409: a variable that is not determined at the start.
pub fn initially_open(v: &Variable) -> Diagnostic {
    Diagnostic::error(
        "MO0409",
        v.span,
        format!("nothing determines `{}` at the start of the simulation", v.name),
    )
    .help("add an initial equation, or `fixed = true` with a start value")
}

fn total(dae: &Dae, (equations, unknowns): (usize, usize)) -> String {
    format!(
        "`{}` has {} for {}",
        dae.name,
        count(equations, "equation"),
        count(unknowns, "unknown")
    )
}

fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

/// The label of an equation: its expanded form, since the source may be a `connect` or an array.
fn label(dae: &Dae, source: Source, origin: &Origin) -> String {
    let text = match source {
        Source::Start(v) => format!("start of `{}`, fixed", dae.variables[v].name),
        Source::Continuous(id) => equation(dae, &dae.equations[id]),
        Source::Initial(i) => equation(dae, &dae.initial[i]),
        Source::Discrete(_) => String::new(),
    };
    if origin.component.is_empty() { text } else { format!("{text} (in `{}`)", origin.component) }
}

fn equation(dae: &Dae, e: &Equation) -> String {
    let names = |v: VarId| dae.variables[v].name.clone();
    let [lhs, rhs] = [e.lhs, e.rhs].map(|side| print::print(&dae.graph, side, &names));
    const LONGEST: usize = 60;
    if lhs.len() + rhs.len() > LONGEST { String::new() } else { format!("{lhs} = {rhs}") }
}
