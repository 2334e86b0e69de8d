//! Flat model to hybrid differential-algebraic system: Modelica 3.6, appendix B.
//!
//! *In:* a [`FlatModel`]. *Out:* a [`Dae`]: derivatives become variables, aliases and constants are
//! eliminated, relations are numbered, when-clauses become discrete equations with an activation
//! condition, and parameters are sorted. The effort is near-linear in the size of the model: every
//! expression is visited once.
pub mod alias;
pub mod classify;
pub mod determined_by_initialization;
pub mod discontinuous;
pub mod error;
#[cfg(test)]
pub mod fixture;
pub mod given_derivative;
pub mod homotopy;
pub mod initial;
pub mod parameter;
pub mod representative;
pub mod rewriting;
pub mod semilinear;
pub mod variability;
pub mod when;

#[cfg(test)]
mod tests;

use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::ir::dae::{self, Dae, DiscreteEquation, VariableKind};
use crate::ir::expr::{ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{Delay, EquationKind, FlatModel, Origin, Transport, Variability, Variable};
use rewriting::{RelationMode, Rewriting};

/// Lowers a flat model. Errors are added to `problems`; `None` if there are any.
pub fn lower(mut flat: FlatModel, problems: &mut Problems) -> Option<Dae> {
    let errors_before = problems.error_count();
    determined_by_initialization::parameters(&mut flat);
    when::reinits_at_the_start(&mut flat);
    let mut variables = classify::variables(&flat, problems);
    let sections = classify::sections(&mut flat);
    classify::check_pre(&flat.graph, &variables, &sections.equal, problems);
    let stated = dae::Stated {
        equations: sections.equal.iter().map(Equal::stated).collect(),
        by_when: classify::assigned_in(&sections.whens),
        ownership: std::mem::take(&mut flat.ownership),
    };
    let (equal, given) = given_derivative::set_aside(&mut flat, sections.equal);
    let (classes, mut equal) = alias::find_aliases(&mut flat.graph, &variables, equal);
    let replacement =
        representative::choose(&mut flat.graph, &mut variables, classes, &sections.roots, problems);

    let mut rewriting = Rewriting::new(&mut flat.graph, &mut variables, replacement, problems);
    semilinear::merge_chains(&mut equal, &mut rewriting);
    let by_when = when::assigned(&sections.whens, &rewriting);
    let (mut equations, mut discrete) = split(equal, &by_when, &mut rewriting);
    given_derivative::append(&flat.given_derivatives, given, &mut equations, &mut rewriting);
    hold_initial_values(&flat.variables, &mut discrete, &mut rewriting);
    let actions = when::lower(&sections.whens, &mut discrete, &mut rewriting);
    let mut asserts = actions.asserts;
    let at_start = rewriting.graph.intern(Node::Initial, Type::Boolean);
    for (assert, origin) in &sections.asserts {
        // The first row is recorded when `initial()` is already false.
        if rewriting.graph.any([assert.condition], |_, node| node == Node::Initial) {
            asserts.push(when::guarded(Some(at_start), assert, origin, &mut rewriting));
        }
        asserts.push(when::guarded(None, assert, origin, &mut rewriting));
    }
    for e in &flat.initial_equations {
        if let EquationKind::Assert(assert) = &e.kind {
            asserts.push(when::guarded(Some(at_start), assert, &e.origin, &mut rewriting));
        }
    }
    let written = (flat.initial_equations.as_slice(), &flat.variables);
    let mut initial = initial::equations(written, &mut discrete, &mut rewriting);
    rewriting.attributes();
    let eliminated = rewriting.eliminated();
    let parameters = parameter::ordered(&flat.variables, &mut initial, &mut rewriting);
    for &v in &flat.synthetic {
        rewriting.variables[v].hidden = true;
    }
    let delays = delays(&flat.delays, &flat.recorded, &mut rewriting);
    let transports = transports(flat.transports, &mut rewriting);
    discrete.list.append(&mut rewriting.jumps);
    classify::check_discrete_equations(&discrete.list, &mut rewriting);
    let events = rewriting.finish();

    (problems.error_count() == errors_before).then(|| Dae {
        name: flat.name,
        graph: flat.graph,
        variables,
        parameters,
        equations,
        discrete: discrete.list,
        initial,
        relations: events.relations,
        samples: events.samples,
        reinits: actions.reinits,
        asserts,
        terminates: actions.terminates,
        eliminated,
        functions: flat.functions,
        delays,
        transports,
        stated,
        experiment: flat.experiment,
    })
}

/// Adds equations that hold discrete parameters at the value determined by initialization.
fn hold_initial_values(
    flat: &IndexVec<VarId, Variable>,
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) {
    for (id, v) in flat.enumerate() {
        let Some(own) = r.representative(id).map(|s| s.variable) else { continue };
        if classify::is_determined_by_initialization(v)
            && r.variables[own].kind == VariableKind::Discrete
            && !discrete.of.contains_key(&own)
        {
            let before = r.graph.pre(own, r.variables[own].ty);
            discrete.push(own, before, classify::declaration_origin(v), r);
        }
    }
}

/// The delayed variables with their delay times. `recorded` are the inputs that recordings determine.
fn delays(flat: &[Delay], recorded: &[VarId], r: &mut Rewriting<'_>) -> Vec<dae::Delay> {
    let mut list = Vec::with_capacity(flat.len());
    for &Delay { variable, time, span } in flat {
        let origin = Origin { span, component: "".into() };
        let time = r.apply(time, RelationMode::Literal, &origin);
        let own = r.representative(variable);
        let is_same = |input: &VarId| own.is_some() && r.representative(*input) == own;
        let input = recorded.iter().copied().find(is_same);
        list.push(dae::Delay { variable, time: r.graph.as_real(time), input });
    }
    list
}

/// The transport lines of `spatialDistribution` with rewritten initial values.
fn transports(mut all: Vec<Transport>, r: &mut Rewriting<'_>) -> Vec<Transport> {
    for line in &mut all {
        let origin = Origin { span: line.span, component: "".into() };
        for (place, value) in &mut line.initial {
            for e in [place, value] {
                *e = r.apply(*e, RelationMode::Literal, &origin);
                if r.variability(*e) > Variability::Parameter {
                    r.problems.push(error::varying_distribution(&origin));
                }
                *e = r.graph.as_real(*e);
            }
        }
    }
    all
}

/// An equation `lhs = rhs` that is being lowered.
pub struct Equal {
    /// Left-hand side.
    pub lhs: ExprId,
    /// Right-hand side.
    pub rhs: ExprId,
    /// The source of the equation.
    pub origin: Origin,
}

impl Equal {
    /// As messages refer to it.
    fn stated(&self) -> dae::StatedEquation {
        dae::StatedEquation { lhs: self.lhs, rhs: self.rhs, origin: self.origin.clone() }
    }
}

/// Discrete equations with an index by variable.
#[derive(Default)]
pub struct DiscreteEquations {
    /// The equations in order of appearance.
    pub list: Vec<DiscreteEquation>,
    /// The position of the equation of each variable.
    pub of: FastMap<VarId, usize>,
}

impl DiscreteEquations {
    /// Adds `variable := value`; a second equation for one variable is an error.
    pub fn push(&mut self, variable: VarId, value: ExprId, origin: Origin, r: &mut Rewriting<'_>) {
        if let Some(&first) = self.of.get(&variable) {
            let declared = &r.variables[variable];
            r.problems.push(error::assigned_twice(declared, &self.list[first].origin, &origin));
            return;
        }
        self.of.insert(variable, self.list.len());
        self.list.push(DiscreteEquation { variable, value, origin });
    }
}

/// Splits equations into continuous ones and discrete ones, the latter in assigned form.
fn split(
    equal: Vec<Equal>,
    by_when: &FastSet<VarId>,
    r: &mut Rewriting<'_>,
) -> (IndexVec<dae::EqId, dae::Equation>, DiscreteEquations) {
    let mut continuous = IndexVec::new();
    let mut discrete = DiscreteEquations::default();
    for Equal { lhs, rhs, origin } in equal {
        let lhs = r.apply(lhs, RelationMode::Events, &origin);
        let rhs = r.apply(rhs, RelationMode::Events, &origin);
        let is_real = r.graph.common_type(lhs, rhs) == Type::Real;
        if !(is_real && r.variability(lhs).max(r.variability(rhs)) == Variability::Continuous) {
            let taken = |v| by_when.contains(&v) || discrete.of.contains_key(&v);
            if let Some((variable, value)) = assigned_form(lhs, rhs, taken, r) {
                discrete.push(variable, value, origin, r);
                continue;
            }
            if !is_real {
                r.problems.push(error::not_assigned_form(&origin));
                continue;
            }
        }
        continuous.push(continuous_equation(lhs, rhs, origin, r));
    }
    (continuous, discrete)
}

fn continuous_equation(
    lhs: ExprId,
    rhs: ExprId,
    origin: Origin,
    r: &mut Rewriting<'_>,
) -> dae::Equation {
    let [lhs, rhs] = [lhs, rhs].map(|side| r.graph.as_real(side));
    let residual = r.graph.sub(lhs, rhs);
    dae::Equation { lhs, rhs, residual, origin, derivative_of: None }
}

/// `v := value` from an equation with a discrete variable, possibly negated, alone on one side. If
/// both sides qualify, the variable without an equation is chosen.
fn assigned_form(
    lhs: ExprId,
    rhs: ExprId,
    taken: impl Fn(VarId) -> bool,
    r: &mut Rewriting<'_>,
) -> Option<(VarId, ExprId)> {
    let sides = [alone(lhs, r).map(|s| (s, rhs)), alone(rhs, r).map(|s| (s, lhs))];
    let free = sides.iter().flatten().find(|((v, _), _)| !taken(*v));
    let &((variable, negation), other) = free.or(sides.iter().flatten().next())?;
    let value = match negation {
        Some(op) => r.graph.unary(op, other),
        None => other,
    };
    Some((variable, value))
}

fn alone(side: ExprId, r: &Rewriting<'_>) -> Option<(VarId, Option<Unary>)> {
    let (variable, negation) = match r.graph.node(side) {
        Node::Var(v) => (v, None),
        Node::Unary(op @ (Unary::Not | Unary::Neg), a) => match r.graph.node(a) {
            Node::Var(v) => (v, Some(op)),
            _ => return None,
        },
        _ => return None,
    };
    (r.variables[variable].kind == VariableKind::Discrete).then_some((variable, negation))
}
