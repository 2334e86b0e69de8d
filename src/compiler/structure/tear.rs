//! Tears blocks of simultaneous equations.

use super::error_growth::{ErrorGrowth, LONG_SEQUENCE};
use super::incidence::EquationSystem;
use super::{error_growth, solve, sort};
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::graph::bipartite::{Bipartite, Col, Edge, Row};
use crate::graph::tearing::{self, TearingSelect};
use crate::ir::blocks::{Assignment, Residual, Torn};
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, Node, VarId};
use crate::symbolic::gradient::{Leaf, gradient};
use crate::symbolic::linear;

/// How blocks are torn.
pub struct Tearing<'a> {
    /// What is known of the growth of rounding errors.
    pub growth: ErrorGrowth,
    /// Variables at which nonlinear blocks are torn first.
    pub is_preferred: &'a dyn Fn(VarId) -> bool,
}

/// Tears a block of equations that must be solved together.
pub fn tear(
    dae: &mut Dae,
    system: &EquationSystem,
    pairs: &[(Row, Col)],
    tearing: &mut Tearing<'_>,
) -> Torn {
    let (graph, _) = sort::subgraph(system, pairs);
    let unknowns: IndexVec<Col, VarId> = pairs.iter().map(|p| system.unknowns[p.1]).collect();
    let residuals: IndexVec<Row, ExprId> =
        pairs.iter().map(|p| solve::residual(dae, system.sources[p.0])).collect();
    let members: FastSet<VarId> = unknowns.iter().copied().collect();
    let linear = linear::is_linear(&dae.graph, residuals.iter().copied(), |v| members.contains(&v));
    let Coefficients { partials, mut solvable } =
        coefficients(dae, &graph, &residuals, &unknowns, &members);
    if !linear {
        exclude_slight_effects(dae, &graph, &partials, &unknowns, &mut solvable);
    }
    let sizes = (linear && pairs.len() >= LONG_SEQUENCE)
        .then(|| tearing.growth.scaled_sizes(dae, &graph, &partials));
    let select = match linear {
        true => IndexVec::new(),
        false => unknowns.iter().map(|v| select((tearing.is_preferred)(*v))).collect(),
    };
    let source = |row: Row| system.sources[pairs[row.0 as usize].0];
    loop {
        let torn = tearing::tear(&graph, &solvable, &select);
        let unstable = sizes
            .as_ref()
            .map(|s| error_growth::unstable_edges(&graph, s, &torn))
            .unwrap_or_default();
        if !unstable.is_empty() {
            unstable.into_iter().for_each(|edge| solvable[edge] = false);
            continue;
        }
        let mut explicit = Vec::with_capacity(torn.explicit.len());
        let mut rejected = None;
        for (row, col) in torn.explicit {
            let variable = unknowns[col];
            match solve::explicit(dae, source(row), variable) {
                Some(value) => explicit.push(Assignment { variable, value, source: source(row) }),
                None => {
                    rejected = graph.edge(row, col);
                    break;
                }
            }
        }
        // The partial derivative may suggest that an equation is solvable although its form is not.
        if let Some(edge) = rejected {
            solvable[edge] = false;
            continue;
        }
        return Torn {
            unknowns: torn.tearing.into_iter().map(|col| unknowns[col]).collect(),
            explicit,
            residuals: torn
                .residual
                .into_iter()
                .map(|row| Residual { value: residuals[row], source: source(row) })
                .collect(),
            linear,
        };
    }
}

fn select(is_preferred: bool) -> TearingSelect {
    if is_preferred { TearingSelect::Prefer } else { TearingSelect::Default }
}

/// What is known of each incidence.
struct Coefficients {
    /// The partial derivative of the residual by the unknown, if it is not zero.
    partials: IndexVec<Edge, Option<ExprId>>,
    /// Whether the equation is linear in the unknown with a coefficient that cannot vanish.
    solvable: IndexVec<Edge, bool>,
}

/// The coefficients of a block. One reverse sweep per equation gives all of them.
fn coefficients(
    dae: &mut Dae,
    graph: &Bipartite,
    residuals: &IndexVec<Row, ExprId>,
    unknowns: &IndexVec<Col, VarId>,
    members: &FastSet<VarId>,
) -> Coefficients {
    let mut solvable = IndexVec::filled(false, graph.edge_count());
    let mut known = IndexVec::filled(None, graph.edge_count());
    for row in graph.rows() {
        let residual = residuals[row];
        let wanted = |leaf| matches!(leaf, Leaf::Var(v) if members.contains(&v));
        let partials: FastMap<Leaf, ExprId> =
            gradient(&mut dae.graph, residual, wanted).into_iter().collect();
        let hidden = linear::hidden_variables(&dae.graph, residual);
        for edge in graph.edges(row) {
            let v = unknowns[graph.col(edge)];
            known[edge] = partials.get(&Leaf::Var(v)).copied();
            solvable[edge] = !hidden.contains(&v)
                && known[edge].is_some_and(|partial| {
                    solve::is_never_zero(dae, partial) && keeps_its_magnitude(dae, partial)
                });
        }
    }
    Coefficients { partials: known, solvable }
}

/// Smallest effect of an unknown that is solved for, relative to the largest effect in its equation.
const SLIGHTEST_EFFECT: f64 = 1e-3;

/// Excludes solutions for unknowns that hardly matter in their equation, such as the pressure in the enthalpy of a
/// liquid: the result would be far from every sensible value until all others are exact. Effects are coefficients
/// times nominal values, and count where both are numbers.
fn exclude_slight_effects(
    dae: &Dae,
    graph: &Bipartite,
    partials: &IndexVec<Edge, Option<ExprId>>,
    unknowns: &IndexVec<Col, VarId>,
    solvable: &mut IndexVec<Edge, bool>,
) {
    let effect = |edge: Edge| {
        let nominal = dae.variables[unknowns[graph.col(edge)]].nominal?;
        let coefficient = dae.graph.as_number(partials[edge]?)?;
        Some((coefficient * dae.graph.as_number(nominal)?).abs())
    };
    for row in graph.rows() {
        let largest = graph.edges(row).filter_map(effect).fold(0.0, f64::max);
        for edge in graph.edges(row) {
            solvable[edge] &= effect(edge).is_none_or(|e| e >= SLIGHTEST_EFFECT * largest);
        }
    }
}

/// Maximum ratio between the branches of a coefficient.
const MAX_RATIO: f64 = 100.0;

/// False for a coefficient that jumps between magnitudes, such as the slope of a switch: after
/// division by the small one, rounding errors could dominate the result.
fn keeps_its_magnitude(dae: &Dae, coefficient: ExprId) -> bool {
    let g = &dae.graph;
    g.all([coefficient], |_, node| match node {
        Node::If(_, a, b) => match (g.as_number(a), g.as_number(b)) {
            (Some(a), Some(b)) => {
                let ratio = (a / b).abs();
                (1.0 / MAX_RATIO..=MAX_RATIO).contains(&ratio)
            }
            _ => a == b,
        },
        _ => true,
    })
}
