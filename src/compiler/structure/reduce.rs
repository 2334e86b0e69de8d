//! Index reduction: the equations to differentiate, and the states.

use super::incidence::EquationSystem;
use super::{apply, error, inline, is_continuous, name_order, solve};
use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::graph::bipartite::{Col, Edge, Row};
use crate::graph::dummy_derivatives::{self, Coefficient};
use crate::graph::pantelides::{self, Reduction, StructurallySingular};
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, EqId, Variable, VariableKind};
use crate::ir::expr::{ExprId, Node, VarId};
use crate::ir::flat::StateSelect;
use crate::symbolic::function_derivative::FunctionDerivatives;
use crate::symbolic::gradient::{Leaf, gradient};
use crate::symbolic::linear;

/// The result of the index reduction.
pub struct Reduced {
    /// The statically selected states.
    pub is_state: IndexVec<VarId, bool>,
    /// The constraints with the variables that they determine.
    pub pivots: Vec<ConstraintPivot>,
}

/// A constraint and the variable that it determines, see [`dummy_derivatives::Pivot`].
pub struct ConstraintPivot {
    /// Constraints of different rounds are independent.
    pub round: usize,
    /// The constraint.
    pub constraint: EqId,
    /// The variable that it determines.
    pub determined: VarId,
    /// The variables that it could determine.
    pub candidates: Vec<VarId>,
    /// The pivot varies and may become singular.
    pub varying: bool,
    /// The partial derivatives with respect to the candidates vary.
    pub nonlinear: bool,
}

/// Appends the differentiated equations to the system and selects the states. The system must be
/// structurally determined (see [`super::explain::check_determined`]).
pub fn reduce(dae: &mut Dae, problems: &mut Problems) -> Option<Reduced> {
    reduce_with(dae, FunctionDerivatives::default(), problems)
}

fn reduce_with(
    dae: &mut Dae,
    mut functions: FunctionDerivatives,
    problems: &mut Problems,
) -> Option<Reduced> {
    let system = system_by_name(dae);
    let derivative = derivatives(dae, &system);
    let not_differentiable: Vec<Row> = (dae.equations.ids())
        .filter(|id| calls_a_function(dae, dae.equations[*id].residual))
        .filter(|id| !functions.cover(&dae.graph, dae.equations[*id].residual))
        .map(|id| Row(id.0))
        .collect();
    let given = given_derivatives(dae);
    let reduction =
        match pantelides::pantelides(&system.graph, &derivative, &not_differentiable, &given) {
            Ok(reduction) => reduction,
            Err(StructurallySingular::NotDifferentiable { row, rows }) => {
                let equation = EqId(row.0);
                let residual = dae.equations[equation].residual;
                if inline::calls_of(dae, equation)
                    || functions.add(&mut dae.graph, &mut dae.functions, residual)
                {
                    return reduce_with(dae, functions, problems);
                }
                problems.push(error::not_differentiable(dae, EqId(row.0), &equations(&rows)));
                return None;
            }
            Err(StructurallySingular::TooFewUnknowns { rows, .. }) => {
                problems.push(error::dependent(dae, &equations(&rows)));
                return None;
            }
        };
    let coefficients = coefficients(dae, &system, &reduction);
    let reinitialised: FastSet<VarId> = dae.reinits.iter().map(|r| r.state).collect();
    let wanted = |v: &VarId| {
        priority(&dae.variables[*v]) + if reinitialised.contains(v) { 5_000 } else { 0 }
    };
    let priority = system.unknowns.iter().map(wanted).collect();
    let choice = dummy_derivatives::choose(&reduction, &priority, &coefficients);
    if choice.dependent > 0 {
        let constraints: Vec<EqId> = (dae.equations.ids())
            .filter(|id| reduction.differentiated[Row(id.0)].is_some())
            .collect();
        problems.push(error::dependent(dae, &constraints));
        return None;
    }
    let columns = apply::differentiate(dae, &system.unknowns, &reduction, &mut functions);
    let mut is_state = IndexVec::filled(false, dae.variables.len());
    for &col in &choice.states {
        is_state[columns[col]] = true;
    }
    check_selected_states(dae, &is_state, problems);
    let pivots = choice.pivots.into_iter().map(|pivot| ConstraintPivot {
        round: pivot.round,
        constraint: EqId(pivot.constraint.0),
        determined: columns[pivot.determined],
        candidates: pivot.candidates.iter().map(|col| columns[*col]).collect(),
        varying: pivot.varying,
        nonlinear: pivot.nonlinear,
    });
    let pivots = pivots.collect();
    Some(Reduced { is_state, pivots })
}

/// The equations whose derivatives are given by others, which follow.
pub fn given_derivatives(dae: &Dae) -> Vec<(Row, Row)> {
    let given = dae.equations.enumerate().filter_map(|(id, e)| Some((e.derivative_of?, id)));
    given.map(|(of, derivative)| (Row(of.0), Row(derivative.0))).collect()
}

/// All continuous equations and variables. Among equals, the variable whose name comes later becomes a dummy
/// first, whatever the order of declarations: columns are in reverse order of the names.
fn system_by_name(dae: &Dae) -> EquationSystem {
    let sources = dae.equations.ids().map(Source::Continuous).collect();
    let mut unknowns: Vec<VarId> = dae.variables.ids().filter(|v| is_continuous(dae, *v)).collect();
    unknowns.sort_by(|a, b| name_order::compare(&dae.variables[*b].name, &dae.variables[*a].name));
    EquationSystem::new(dae, sources, unknowns)
}

/// All continuous equations in all continuous variables, states and derivatives included.
pub fn full_system(dae: &Dae) -> EquationSystem {
    let sources = dae.equations.ids().map(Source::Continuous).collect();
    let unknowns = dae.variables.ids().filter(|v| is_continuous(dae, *v)).collect();
    EquationSystem::new(dae, sources, unknowns)
}

/// The derivative of each column: the list A of Pantelides.
pub fn derivatives(dae: &Dae, system: &EquationSystem) -> IndexVec<Col, Option<Col>> {
    let of = |v: &VarId| match dae.variables[*v].kind {
        VariableKind::Differentiated { derivative } => system.column[derivative],
        _ => None,
    };
    system.unknowns.iter().map(of).collect()
}

/// The priority of a variable as a state: by `stateSelect`, then by convention.
pub fn priority(variable: &Variable) -> i32 {
    let preference = match variable.state_select {
        StateSelect::Never => -10_000,
        StateSelect::Avoid => -1_000,
        StateSelect::Default => 0,
        StateSelect::Prefer => 1_000,
        StateSelect::Always => 10_000,
    };
    let fixed = if variable.fixed == Some(true) { 100 } else { 0 };
    let start = if variable.start.is_some() { 50 } else { 0 };
    // A variable near the top of the model is more meaningful to the user than one deep inside.
    let depth = variable.name.bytes().filter(|b| *b == b'.').count().min(20) as i32;
    preference + fixed + start - depth
}

fn equations(rows: &[Row]) -> Vec<EqId> {
    rows.iter().map(|row| EqId(row.0)).collect()
}

fn calls_a_function(dae: &Dae, residual: ExprId) -> bool {
    let nodes = dae.graph.postorder([residual]);
    let calls = nodes.into_iter().filter(|e| matches!(dae.graph.node(*e), Node::Call { .. }));
    // A call whose arguments change at events only is constant between them.
    let varies = |_, node| match node {
        Node::Var(v) | Node::Der(v) => is_continuous(dae, v),
        Node::Time | Node::Recorded(..) => true,
        _ => false,
    };
    dae.graph.any(calls, varies)
}

/// The kinds of the partial derivatives of the equations that were differentiated.
fn coefficients(
    dae: &mut Dae,
    system: &EquationSystem,
    reduction: &Reduction,
) -> IndexVec<Edge, Coefficient> {
    let mut coefficients = IndexVec::filled(Coefficient::Varying, system.graph.edge_count());
    for row in system.graph.rows() {
        if reduction.differentiated[row].is_none() {
            continue;
        }
        let residual = dae.equations[EqId(row.0)].residual;
        let partials: FastMap<Leaf, ExprId> =
            gradient(&mut dae.graph, residual, |leaf| leaf != Leaf::Time).into_iter().collect();
        let hidden = linear::hidden_variables(&dae.graph, residual);
        for edge in system.graph.edges(row) {
            let v = system.unknowns[system.graph.col(edge)];
            if let Some(&partial) = partials.get(&Leaf::Var(v))
                && !hidden.contains(&v)
            {
                coefficients[edge] = match dae.graph.as_number(partial) {
                    Some(value) => Coefficient::Constant(value),
                    None if solve::is_never_zero(dae, partial) => Coefficient::Parameter,
                    None => Coefficient::Varying,
                };
            }
        }
    }
    coefficients
}

/// True if an equation relates the variable to another one that could have been the state.
fn has_substitute(dae: &Dae, id: VarId) -> bool {
    dae.equations.iter().any(|e| {
        let reads = dae.graph.postorder([e.residual]);
        let reads = |wanted: &dyn Fn(VarId) -> bool| {
            reads.iter().any(|n| matches!(dae.graph.node(*n), Node::Var(v) if wanted(v)))
        };
        reads(&|v| v == id)
            && reads(&|v| v != id && dae.variables[v].kind == VariableKind::Algebraic)
    })
}

/// Reports `stateSelect` attributes that the selection does not satisfy, and `reinit` of variables
/// that are not states.
fn check_selected_states(dae: &Dae, is_state: &IndexVec<VarId, bool>, problems: &mut Problems) {
    for (id, v) in dae.variables.enumerate() {
        let is_differentiated = matches!(v.kind, VariableKind::Differentiated { .. });
        if is_differentiated && v.state_select == StateSelect::Always && !is_state[id] {
            problems.push(error::not_a_state(v));
        }
        if v.kind == VariableKind::Algebraic
            && v.state_select == StateSelect::Always
            && jumps(dae, id)
        {
            problems.push(error::jumping_state(v));
        }
        if v.state_select == StateSelect::Never && is_state[id] {
            problems.push(error::needed_as_state(v, has_substitute(dae, id)));
        }
    }
    for reinit in &dae.reinits {
        if !is_state[reinit.state] {
            problems.push(error::reinit_of_dependent(&dae.variables[reinit.state], &reinit.origin));
        }
    }
}

/// True if relations select the value of a variable, so that it may jump and cannot be a state.
fn jumps(dae: &Dae, v: VarId) -> bool {
    let chosen = |e: ExprId| match dae.graph.node(e) {
        Node::If(c, ..) => {
            let nodes = dae.graph.postorder([c]);
            nodes.into_iter().any(|n| matches!(dae.graph.node(n), Node::Relation(_)))
        }
        _ => false,
    };
    let mut equations = dae.equations.iter();
    equations.any(|e| {
        [(e.lhs, e.rhs), (e.rhs, e.lhs)]
            .into_iter()
            .any(|(side, value)| dae.graph.node(side) == Node::Var(v) && chosen(value))
    })
}
