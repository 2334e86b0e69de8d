//! Diagnostics of the structural analysis.

use super::culprit::Blame;
use super::explain::{list, origin, with_labels, with_places};
use crate::base::cause::causes;
use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::Span;
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, EqId, Equation, Stated, Variable};
use crate::ir::expr::{ExprId, VarId};
use crate::ir::flat::Origin;
use crate::symbolic::print;

causes! {
    /// Causes found by the structural analysis.
    pub enum StructureCause {
        /// The equations do not determine all unknowns.
        error MO0401 TooFewEquations { equations: usize, unknowns: usize, missing: usize, names: String }
            (section "8.4")
            => ("{}", too_few_text(*equations, *unknowns, names)),
            help("add {} for {names}, or give {} a value where it is declared",
                 if *missing == 1 { "an equation".into() } else { format!("{missing} equations") },
                 if *unknowns == 1 { "it" } else { "one of them" });
        /// There are more equations than unknowns.
        error MO0402 TooManyEquations { equations: usize, unknowns: usize, excess: usize, names: String }
            (section "8.4")
            => ("{}", too_many(*equations, *unknowns, names)), remedy(Some(remove(*excess, *unknowns)));
        /// Constraints repeat or contradict each other for all values.
        error MO0403 DependentEquations
            => ("these equations repeat or contradict each other: the model has no unique solution"),
            help("remove a redundant constraint, such as a second rigid connection in a loop");
        /// A constraint between states calls a function that cannot be differentiated.
        error MO0404 NotDifferentiable
            => ("this equation constrains states and must be differentiated, but calls a function \
                 without derivative"),
            help("write the function so that it does not call itself, or break the constraint");
        /// `stateSelect = always` of a variable that other states determine.
        error MO0405 DependentState { name: String } (section "4.8.7.1")
            => ("`{name}` cannot be a state: other states already determine it"),
            help("use `StateSelect.prefer`, or do so for another variable of the constraint");
        /// `stateSelect = never` of a variable that nothing else determines.
        error MO0406 NeededAsState { name: String } (section "4.8.7.1")
            => ("`{name}` must be a state: nothing else determines it"),
            help("use `StateSelect.avoid`");
        /// `reinit` of a variable that other states determine.
        error MO0407 ReinitOfDependent { name: String } (section "8.3.6")
            => ("cannot reinitialize `{name}`: other states determine it"),
            help("declare `{name}` with `stateSelect = StateSelect.always`");
        /// There are too many initial equations and fixed start values.
        error MO0408 TooManyInitialConditions { names: String, excess: usize } (section "8.6")
            => ("the start of the simulation is determined more than once: {names}"),
            help("remove {} or `fixed = true`", match excess {
                1 => "one initial equation".to_owned(),
                n => format!("{n} initial equations"),
            });
        /// A variable is not determined at the start of the simulation.
        error MO0409 NoInitialCondition { name: String } (section "8.6")
            => ("nothing determines `{name}` at the start of the simulation"),
            help("add an initial equation, or `fixed = true` with a start value");
        /// Linear equations depend on each other: some repeat or contradict the others.
        error MO0410 DependentLinearEquations { names: String, kind: Dependence }
            => ("{}", kind.message(names)), remedy(Some(kind.remedy().to_owned()));
        /// `stateSelect = always` of a variable that is discontinuous.
        error MO0430 DiscontinuousState { name: String } (section "4.8.7.1")
            => ("`{name}` cannot be a state: it is discontinuous"),
            help("omit `stateSelect`");
    }
}

/// Unknowns that the equations do not determine. `counts`: equations and unknowns of the model.
pub fn too_few_equations(
    dae: &Dae,
    counts: (usize, usize),
    missing: usize,
    sources: &[Source],
    variables: &[VarId],
) -> Diagnostic {
    let spans = || sources.iter().map(|source| origin(dae, *source).span).collect();
    too_few(dae, missing, sources.len(), variables, spans).note(total(dae, counts))
}

/// Unknowns that fewer equations, at these places, do not determine.
fn too_few(
    dae: &Dae,
    missing: usize,
    equations: usize,
    variables: &[VarId],
    places: impl Fn() -> Vec<Span>,
) -> Diagnostic {
    let names = list(variables.iter().map(|v| &dae.variables[*v]));
    let unknowns = variables.len();
    let cause = StructureCause::TooFewEquations { equations, unknowns, missing, names };
    let first = variables.first().map_or(Span::NONE, |v| dae.variables[*v].span);
    // Variables of several instances share the line of their declaration, so each label names its
    // own.
    let label = |v: &VarId| match variables.len() {
        1 => "not determined".to_string(),
        _ => format!("`{}` is not determined", dae.variables[*v].name),
    };
    let mut d = Diagnostic::new(cause, first);
    d.primary.1 = variables.first().map_or_else(String::new, label);
    for v in variables.iter().skip(1).take(4) {
        d = d.also(dae.variables[*v].span, label(v));
    }
    for span in places().into_iter().take(4) {
        d = d.also(span, "determines only one of them");
    }
    d
}

/// More equations than unknowns.
pub fn too_many_equations(
    dae: &Dae,
    counts: (usize, usize),
    excess: usize,
    sources: &[Source],
    variables: &[VarId],
) -> Diagnostic {
    let names = list(variables.iter().map(|v| &dae.variables[*v]));
    let (equations, unknowns) = (sources.len(), variables.len());
    let cause = StructureCause::TooManyEquations { equations, unknowns, excess, names };
    let d = Diagnostic::new(cause, Span::NONE);
    let d = with_places(d, dae, sources, |source, origin| label(dae, source, origin));
    d.note(total(dae, counts))
}

/// What is to blame for a singular system, in terms of the flat system as it is written.
pub struct Blamed<'a> {
    /// The system.
    pub dae: &'a Dae,
    /// Its equations as they are written.
    pub stated: &'a Stated,
    /// Those to blame.
    pub blame: &'a Blame,
    /// Equations and unknowns of the model.
    pub counts: (usize, usize),
}

impl Blamed<'_> {
    /// More equations than unknowns, the guilty ones first.
    pub fn too_many_equations(&self) -> Diagnostic {
        let Blamed { dae, stated, blame, counts } = self;
        let part = &blame.over;
        let names = list(part.unknowns.iter().map(|v| &dae.variables[*v]));
        let (equations, unknowns) = (part.equations.len(), part.unknowns.len());
        let excess = equations.saturating_sub(unknowns).max(1);
        let cause = StructureCause::TooManyEquations { equations, unknowns, excess, names };
        let shown = part.equations.iter().chain(&part.context).map(|k| {
            let e = &stated.equations[*k];
            let text = in_component(sides(dae, e.lhs, e.rhs), &e.origin);
            (e.origin.clone(), text)
        });
        let d = with_labels(Diagnostic::new(cause, Span::NONE), shown);
        self.component_counts(d).note(total(dae, *counts))
    }

    /// Unknowns that the equations do not determine, those of unbalanced components first.
    pub fn too_few_equations(&self) -> Diagnostic {
        let Blamed { dae, stated, blame, counts } = self;
        let part = &blame.under;
        let missing = part.unknowns.len().saturating_sub(part.equations.len()).max(1);
        let d = too_few(dae, missing, part.equations.len(), &part.unknowns, || {
            part.equations.iter().map(|k| stated.equations[*k].origin.span).collect()
        });
        self.component_counts(d).note(total(dae, *counts))
    }

    /// Adds the balance of the components in which the fault was found.
    fn component_counts(&self, mut d: Diagnostic) -> Diagnostic {
        const SHOWN: usize = 4;
        if self.stated.ownership.components.len() < 2 {
            return d;
        }
        for c in self.blame.counts.iter().take(SHOWN) {
            let whose = if c.component.is_empty() {
                "the model itself, without its components,".to_owned()
            } else {
                format!("`{}`", c.component)
            };
            let equations = count(c.equations, "equation");
            let unknowns = count(c.unknowns, "unknown");
            d = d.note(format!("{whose} has {equations} for {unknowns} that it must determine"));
        }
        d
    }
}

/// Constraints that repeat or contradict each other for all values.
pub fn dependent(dae: &Dae, equations: &[EqId]) -> Diagnostic {
    let d = Diagnostic::new(StructureCause::DependentEquations, Span::NONE);
    let sources: Vec<Source> = equations.iter().map(|id| Source::Continuous(*id)).collect();
    with_places(d, dae, &sources, |source, origin| label(dae, source, origin))
        .note("as many equations as unknowns, but some follow from the others")
}

/// Linear equations that depend on each other; a warning if they have solutions and nothing else
/// depends on the choice.
pub fn dependent_block(
    dae: &Dae,
    sources: &[Source],
    free: &[VarId],
    consequence: Consequence,
) -> Diagnostic {
    let names = list(free.iter().map(|v| &dae.variables[*v]));
    let is_discrete = matches!(sources.first(), Some(Source::Discrete(_)));
    let kind = match (sources.len(), consequence) {
        (1, _) if is_discrete => Dependence::OwnValue,
        (1, _) => Dependence::NoCoefficient,
        (_, Consequence::NoSolution) => Dependence::Contradiction,
        _ => Dependence::Repetition,
    };
    let cause = StructureCause::DependentLinearEquations { names, kind };
    let d = Diagnostic::new(cause, Span::NONE);
    let d = with_places(d, dae, sources, |source, origin| label(dae, source, origin));
    match consequence {
        Consequence::None => {
            d.with_severity(Severity::Warning).note("nothing else depends on their values")
        }
        _ => d,
    }
}

/// How linear equations fail to determine their unknowns.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Dependence {
    /// The unknown has the coefficient 0 in its only equation.
    NoCoefficient,
    /// The equation of a discrete variable says that it equals itself.
    OwnValue,
    /// Equations repeat each other.
    Repetition,
    /// Equations contradict each other.
    Contradiction,
}

impl Dependence {
    fn message(self, names: &str) -> String {
        match self {
            Dependence::NoCoefficient => {
                format!("this equation does not determine {names}: its coefficient is 0")
            }
            Dependence::OwnValue => format!("this equation only says that {names} equals itself"),
            Dependence::Repetition => {
                format!("the equations do not determine {names}: they depend on each other")
            }
            Dependence::Contradiction => {
                format!("the equations of {names} contradict each other")
            }
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Dependence::NoCoefficient => {
                "give the parameters in its coefficient other values, or write another equation"
            }
            Dependence::OwnValue => {
                "write what determines it; its value before an event is `pre(...)`"
            }
            Dependence::Repetition => {
                "add an equation that ties one of them down, such as a ground, a fixed place or a \
                 reference, and remove one that follows from the others"
            }
            Dependence::Contradiction => "correct or remove one of them",
        }
    }
}

/// What follows from equations that depend on each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Consequence {
    /// They contradict each other.
    NoSolution,
    /// The results depend on unknowns that nothing determines.
    Arbitrary,
    /// Nothing else depends on the unknowns that nothing determines.
    None,
}

/// An equation with a function call must be differentiated.
pub fn not_differentiable(dae: &Dae, equation: EqId, constraint: &[EqId]) -> Diagnostic {
    let span = dae.equations[equation].origin.span;
    let cause = StructureCause::NotDifferentiable;
    let mut d = Diagnostic::new(cause, span).label("must be differentiated");
    for id in constraint.iter().filter(|id| **id != equation).take(4) {
        d = d.also(dae.equations[*id].origin.span, "part of the same constraint");
    }
    d
}

/// `stateSelect = always` cannot be satisfied.
pub fn not_a_state(v: &Variable) -> Diagnostic {
    Diagnostic::new(StructureCause::DependentState { name: v.name.clone() }, v.span)
        .label("declared with `stateSelect = StateSelect.always`")
}

/// `stateSelect = always` of a variable that is discontinuous.
pub fn jumping_state(v: &Variable) -> Diagnostic {
    Diagnostic::new(StructureCause::DiscontinuousState { name: v.name.clone() }, v.span)
        .label("declared with `stateSelect = StateSelect.always`")
}

/// `stateSelect = never` cannot be satisfied.
///
/// A warning if there is a `substitute` that the modeller could have selected as the state instead.
pub fn needed_as_state(v: &Variable, substitute: bool) -> Diagnostic {
    let severity = if substitute { Severity::Warning } else { Severity::Error };
    Diagnostic::new(StructureCause::NeededAsState { name: v.name.clone() }, v.span)
        .with_severity(severity)
        .label("declared with `stateSelect = StateSelect.never`")
}

/// `reinit` of a variable that other states determine.
pub fn reinit_of_dependent(v: &Variable, origin: &Origin) -> Diagnostic {
    Diagnostic::new(StructureCause::ReinitOfDependent { name: v.name.clone() }, origin.span)
        .label("reinitialized here")
        .also(v.span, "declared here")
}

/// Too many initial equations and fixed starts.
pub fn initially_too_many(
    dae: &Dae,
    excess: usize,
    sources: &[Source],
    variables: &[VarId],
) -> Diagnostic {
    let names = list(variables.iter().map(|v| &dae.variables[*v]));
    let cause = StructureCause::TooManyInitialConditions { names, excess };
    // The conditions that the user is most likely to remove come first.
    let mut sources = sources.to_vec();
    sources.sort_by_key(|source| match source {
        Source::Start(_) => 0,
        Source::Initial(_) => 1,
        _ => 2,
    });
    let d = Diagnostic::new(cause, Span::NONE);
    with_places(d, dae, &sources, |source, origin| label(dae, source, origin))
}

/// A variable that is not determined at the start.
pub fn initially_open(v: &Variable) -> Diagnostic {
    Diagnostic::new(StructureCause::NoInitialCondition { name: v.name.clone() }, v.span)
}

fn too_few_text(equations: usize, unknowns: usize, names: &str) -> String {
    match (equations, unknowns) {
        (0, 1) => format!("no equation determines {names}"),
        (0, _) => format!("no equations determine {names}"),
        (1, _) => format!("one equation cannot determine {unknowns} unknowns: {names}"),
        _ => format!("{equations} equations cannot determine {unknowns} unknowns: {names}"),
    }
}

fn too_many(equations: usize, unknowns: usize, names: &str) -> String {
    match (equations, unknowns) {
        (1, 0) => "this equation has no unknown that it could determine".into(),
        (_, 0) => format!("{equations} equations have no unknown that they could determine"),
        (_, 1) => format!("{equations} equations for one unknown: {names}"),
        _ => format!("{equations} equations for {unknowns} unknowns: {names}"),
    }
}

fn remove(excess: usize, unknowns: usize) -> String {
    let remedy = if excess == 1 {
        "remove one of these equations, or make a known quantity in them unknown".to_owned()
    } else {
        format!("remove {excess} of these equations, or make known quantities in them unknown")
    };
    // Balances without an unknown are those of connections that leave a level open.
    match unknowns {
        0 => format!("{remedy}; connected parts need a ground, a fixed place or a reference"),
        _ => remedy,
    }
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
    in_component(text, origin)
}

/// A text with the component that an equation belongs to.
fn in_component(text: String, origin: &Origin) -> String {
    if origin.component.is_empty() { text } else { format!("{text} (in `{}`)", origin.component) }
}

fn equation(dae: &Dae, e: &Equation) -> String {
    sides(dae, e.lhs, e.rhs)
}

/// `lhs = rhs`, if it is short.
fn sides(dae: &Dae, lhs: ExprId, rhs: ExprId) -> String {
    let names = |v: VarId| dae.variables[v].name.clone();
    let [lhs, rhs] = [lhs, rhs].map(|side| print::print(&dae.graph, side, &names));
    const LONGEST: usize = 60;
    if lhs.len() + rhs.len() > LONGEST { String::new() } else { format!("{lhs} = {rhs}") }
}
