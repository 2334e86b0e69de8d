//! Redundant initial conditions. *In:* the initialization problem. *Out:* the same without fixed
//! starts and initial equations that follow from the others; these become assertions that are
//! checked at the start.
//!
//! A condition without an unknown of its own belongs to an over-determined part of the system
//! (Dulmage and Mendelsohn 1958). If that part can be solved one equation after the other, and the
//! equations that remain hold, symbolically or at the values of the parameters, the condition is
//! redundant. If they do not hold, it stays in the system, which is then reported as
//! over-determined. If neither is known before the simulation, the check at the start decides.

use super::incidence::EquationSystem;
use super::parameter_values::ParameterValues;
use super::structural_zeros::StructuralZeros;
use super::{initial_propagation, solve};
use crate::base::index::IndexVec;
use crate::graph::bipartite::{Bipartite, Row};
use crate::graph::matching::{self, Matching};
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, GuardedAssert, VariableKind};
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{Assert, AssertionLevel, Origin};

/// Tolerance of the check at the start, relative to the size and the nominal value.
const TOLERANCE: f64 = 1e-6;

/// Removes the fixed starts and initial equations that follow from the others.
pub fn without_redundant(
    dae: &mut Dae,
    system: EquationSystem,
    zeros: &StructuralZeros,
) -> EquationSystem {
    let matched = conditions_last(&system, zeros);
    let conditions = matched.free_rows().filter(|row| is_condition(system.sources[*row]));
    let open: Vec<Row> = conditions.collect();
    if open.is_empty() {
        return system;
    }
    let mut values = ParameterValues::of(dae);
    let may_follow = |row: &Row| {
        let part = over_determined(&system.graph, &matched, *row);
        initial_propagation::is_consistent(dae, &system, &part, &mut values) != Some(false)
    };
    let redundant: Vec<Row> = open.into_iter().filter(may_follow).collect();
    for &row in &redundant {
        let assert = check_at_start(dae, system.sources[row]);
        dae.asserts.push(assert);
    }
    let kept = system.sources.enumerate().filter(|(row, _)| !redundant.contains(row));
    let sources = kept.map(|(_, source)| *source).collect();
    EquationSystem::new(dae, sources, system.unknowns.iter().copied().collect())
}

/// The variables with a fixed start that contradicts the value that equations give them, with that
/// value. Starts whose values are known only at run time are checked there.
pub fn contradicted_constants(dae: &mut Dae) -> Vec<(VarId, ExprId)> {
    let is_fixed = |v: VarId| dae.variables[v].fixed == Some(true);
    let is_parameter = |e: ExprId| solve::is_parameter_expression(dae, e);
    let fixed: Vec<(VarId, ExprId)> = (dae.eliminated.iter().copied())
        .filter(|(v, value)| {
            is_fixed(*v) && dae.variables[*v].ty == Type::Real && is_parameter(*value)
        })
        .collect();
    if fixed.is_empty() {
        return Vec::new();
    }
    let mut values = ParameterValues::of(dae);
    let mut contradicted = Vec::new();
    for (v, value) in fixed {
        let start = solve::start(dae, v);
        match initial_propagation::agree(&dae.graph, value, start, &mut values) {
            Some(true) if value == start => {}
            Some(false) => contradicted.push((v, value)),
            _ => {
                let assert = check_at_start(dae, Source::Start(v));
                dae.asserts.push(assert);
            }
        }
    }
    contradicted
}

/// A maximum matching in which the rows that stay free are initial conditions if possible.
fn conditions_last(system: &EquationSystem, zeros: &StructuralZeros) -> Matching {
    let vanished = zeros.edges(system);
    let mut cost = IndexVec::new();
    for row in system.graph.rows() {
        let last = is_condition(system.sources[row]);
        for edge in system.graph.edges(row) {
            cost.push(Some(if last { 2 } else { u8::from(vanished[edge]) }));
        }
    }
    matching::maximum_preferring(&system.graph, &cost, Matching::empty(&system.graph))
}

/// True for the equations that hold only at the start.
fn is_condition(source: Source) -> bool {
    matches!(source, Source::Start(_) | Source::Initial(_))
}

/// The rows that compete with a free row for columns, and the free row itself. They contain one
/// unknown less than there are rows.
fn over_determined(graph: &Bipartite, matched: &Matching, free: Row) -> Vec<Row> {
    let mut seen: IndexVec<Row, bool> = IndexVec::filled(false, graph.row_count());
    seen[free] = true;
    let mut rows = vec![free];
    let mut at = 0;
    while at < rows.len() {
        for &col in graph.cols(rows[at]) {
            if let Some(other) = matched.col_to_row[col]
                && !std::mem::replace(&mut seen[other], true)
            {
                rows.push(other);
            }
        }
        at += 1;
    }
    rows
}

/// Checks a condition when `initial()`.
fn check_at_start(dae: &mut Dae, condition: Source) -> GuardedAssert {
    let (a, b) = solve::sides(dae, condition);
    let holds = match dae.graph.ty(a) {
        Type::Real => is_near(dae, a, b),
        _ => dae.graph.binary(Binary::Equal, a, b),
    };
    let active = Some(dae.graph.intern(Node::Initial, Type::Boolean));
    let (text, origin) = match condition {
        Source::Start(v) => (
            format!(
                "the fixed start of `{}` contradicts the other equations",
                dae.variables[v].name
            ),
            Origin { span: dae.variables[v].span, component: "".into() },
        ),
        other => (
            "this initial equation contradicts the other equations".to_owned(),
            super::explain::origin(dae, other),
        ),
    };
    let message = dae.graph.string(&text);
    let assert = Assert { condition: holds, message, level: AssertionLevel::Error };
    GuardedAssert { active, assert, origin }
}

/// `abs(a - b) <= 1e-6*(nominal + abs(b))`
fn is_near(dae: &mut Dae, a: ExprId, b: ExprId) -> ExprId {
    let nominal = nominal(dae, a);
    let g = &mut dae.graph;
    let difference = g.sub(a, b);
    let (error, size) = (g.unary(Unary::Abs, difference), g.unary(Unary::Abs, b));
    let (nominal, tolerance) = (g.real(nominal), g.real(TOLERANCE));
    let scale = g.add(nominal, size);
    let bound = g.mul(tolerance, scale);
    g.binary(Binary::LessEqual, error, bound)
}

/// The nominal value of a variable; 1 for other expressions.
fn nominal(dae: &Dae, e: ExprId) -> f64 {
    let declared = match dae.graph.node(e) {
        Node::Var(v) if dae.variables[v].kind != VariableKind::Parameter => {
            dae.variables[v].nominal
        }
        _ => None,
    };
    let size = declared.and_then(|e| dae.graph.as_number(e)).map_or(1.0, f64::abs);
    if size > 0.0 && size.is_finite() { size } else { 1.0 }
}
