//! Structural zeros: incidences that vanish at the values of the parameters, such as `R * i` if the
//! parameter `R` is 0, or `if P > 0 then G * v else 0` if the parameter `P` is 0.
//!
//! A matching that uses one of them leads to a singular matrix at run time. They are therefore
//! matched last; if a system has no perfect matching without them, the equation is reduced to its
//! form at these values, and the parameters that cause it become structural.

use super::incidence::EquationSystem;
use super::parameter_values::ParameterValues;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::graph::bipartite::Edge;
use crate::graph::matching::Matching;
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, EqId, VariableKind};
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::symbolic::rewrite::Rewriter;

/// Maximum length of a chain of equations each of which reduces the next one.
const MAX_ROUNDS: usize = 20;

/// The equations that reduce to simpler ones at the values of the parameters.
pub struct StructuralZeros {
    reduced: FastMap<EqId, ReducedEquation>,
}

/// An equation from which variables vanish.
struct ReducedEquation {
    lhs: ExprId,
    rhs: ExprId,
    residual: ExprId,
    /// The variables that no longer occur in it.
    vanished: FastSet<VarId>,
    /// The parameters that cause the reduction.
    deciding: Vec<VarId>,
}

/// The known values: parameters, and variables that are 0 because parameters are 0.
struct KnownZeros {
    /// Parameter expressions that are 0.
    zeros: FastSet<ExprId>,
    values: FastMap<VarId, ExprId>,
    /// The parameters that make a variable 0.
    because: FastMap<VarId, Vec<VarId>>,
}

impl StructuralZeros {
    /// Analyses all continuous equations. An equation that reduces to `v = 0` may reduce others in
    /// turn.
    pub fn find(dae: &mut Dae) -> StructuralZeros {
        let mut values = ParameterValues::of(dae);
        let zeros = zeros(&dae.graph, &mut values);
        let values = values.into_literals();
        let mut known = KnownZeros { zeros, values, because: FastMap::default() };
        let mut reduced = FastMap::default();
        for _ in 0..MAX_ROUNDS {
            let before = known.because.len();
            for id in dae.equations.ids() {
                if may_reduce(dae, dae.equations[id].residual, &known) {
                    reduce_equation(dae, id, &mut known, &mut reduced);
                }
            }
            if known.because.len() == before {
                break;
            }
        }
        StructuralZeros { reduced }
    }

    /// True if there are no structural zeros.
    pub fn is_empty(&self) -> bool {
        self.reduced.is_empty()
    }

    /// For each edge of a system, whether it is a structural zero.
    pub fn edges(&self, system: &EquationSystem) -> IndexVec<Edge, bool> {
        let rows = system
            .graph
            .rows()
            .flat_map(|row| system.graph.edges(row).map(move |edge| (system.sources[row], edge)));
        rows.map(|(source, edge)| {
            self.is_zero_incidence(source, system.unknowns[system.graph.col(edge)])
        })
        .collect()
    }

    /// The equations that are matched to a variable that vanishes from them; for a differentiated
    /// equation, its origin.
    pub fn mismatched(&self, dae: &Dae, system: &EquationSystem, matching: &Matching) -> Vec<EqId> {
        let pairs = matching.pairs();
        let wrong = pairs.filter(|(row, col)| {
            self.is_zero_incidence(system.sources[*row], system.unknowns[*col])
        });
        let mut found: Vec<EqId> = wrong
            .filter_map(|(row, _)| match system.sources[row] {
                Source::Continuous(id) => Some(origin(dae, id)),
                _ => None,
            })
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Reduces equations to their form at the values of the parameters; false if none changes.
    pub fn apply(&self, dae: &mut Dae, equations: &[EqId]) -> bool {
        let mut changed = false;
        for &id in equations {
            let Some(form) = self.reduced.get(&id) else { continue };
            let e = &mut dae.equations[id];
            (e.lhs, e.rhs, e.residual) = (form.lhs, form.rhs, form.residual);
            for &v in &form.deciding {
                dae.variables[v].structural = true;
            }
            changed = true;
        }
        changed
    }

    fn is_zero_incidence(&self, source: Source, v: VarId) -> bool {
        match source {
            Source::Continuous(id) => {
                self.reduced.get(&id).is_some_and(|f| f.vanished.contains(&v))
            }
            _ => false,
        }
    }
}

fn origin(dae: &Dae, mut id: EqId) -> EqId {
    while let Some(of) = dae.equations[id].derivative_of {
        id = of;
    }
    id
}

/// The operations on parameters whose value is 0.
fn zeros(graph: &Graph, values: &mut ParameterValues) -> FastSet<ExprId> {
    let is_operation = |e: ExprId| matches!(graph.node(e), Node::Unary(..) | Node::Binary(..));
    let operations = graph.ids().filter(|e| is_operation(*e) && graph.ty(*e) == Type::Real);
    operations.filter(|e| values.number(graph, *e) == Some(0.0)).collect()
}

/// Reduces an equation by the known values.
fn reduce_equation(
    dae: &mut Dae,
    id: EqId,
    known: &mut KnownZeros,
    reduced: &mut FastMap<EqId, ReducedEquation>,
) {
    let e = dae.equations[id].clone();
    let mut deciding = Vec::new();
    let mut rewriter = Rewriter::new();
    let mut form = |graph: &mut Graph, root| {
        rewriter.apply(graph, root, &mut |g, n| substitute_known(g, n, known, &mut deciding))
    };
    let (lhs, rhs) = (form(&mut dae.graph, e.lhs), form(&mut dae.graph, e.rhs));
    let residual = form(&mut dae.graph, e.residual);
    let left: FastSet<VarId> = dae.graph.variables(residual).into_iter().collect();
    let is_unknown = |v: &VarId| {
        !matches!(dae.variables[*v].kind, VariableKind::Parameter | VariableKind::Discrete)
    };
    let before = dae.graph.variables(e.residual);
    let vanished: FastSet<VarId> =
        before.into_iter().filter(|v| is_unknown(v) && !left.contains(v)).collect();
    deciding.sort_unstable();
    deciding.dedup();
    for (side, other) in [(e.lhs, rhs), (e.rhs, lhs)] {
        if let Node::Var(v) = dae.graph.node(side)
            && dae.variables[v].kind == VariableKind::Algebraic
            && dae.graph.as_number(other) == Some(0.0)
            && !known.because.contains_key(&v)
        {
            known.because.insert(v, deciding.clone());
            let zero = dae.graph.real(0.0);
            known.values.insert(v, zero);
            // This equation defines the value, so the variable remains in it.
            return;
        }
    }
    if !vanished.is_empty() && !known.defines_zero(dae, id) {
        reduced.insert(id, ReducedEquation { lhs, rhs, residual, vanished, deciding });
    }
}

impl KnownZeros {
    fn is_zero(&self, graph: &Graph, v: VarId) -> bool {
        self.values.get(&v).is_some_and(|value| graph.as_number(*value) == Some(0.0))
    }

    /// True if the equation defines a variable as 0.
    fn defines_zero(&self, dae: &Dae, id: EqId) -> bool {
        let e = &dae.equations[id];
        [e.lhs, e.rhs].into_iter().any(|side| match dae.graph.node(side) {
            Node::Var(v) => self.because.contains_key(&v),
            _ => false,
        })
    }
}

/// True if the expression contains a zero or an `if`.
fn may_reduce(dae: &Dae, e: ExprId, known: &KnownZeros) -> bool {
    dae.graph.any([e], |n, node| match node {
        Node::Var(v) => known.is_zero(&dae.graph, v),
        Node::If(..) => true,
        _ => known.zeros.contains(&n),
    })
}

/// Replaces zeros and conditions on parameters by literals.
fn substitute_known(
    g: &mut Graph,
    n: ExprId,
    known: &KnownZeros,
    deciding: &mut Vec<VarId>,
) -> Option<ExprId> {
    let of = |g: &Graph, n| match g.node(n) {
        Node::Var(v) => known.values.get(&v).copied(),
        _ => None,
    };
    match g.node(n) {
        Node::Const(_) => None,
        Node::Var(v) if known.is_zero(g, v) => {
            deciding.extend(known.because.get(&v).map_or(&[v][..], Vec::as_slice));
            known.values.get(&v).copied()
        }
        _ if known.zeros.contains(&n) => {
            deciding.extend(g.variables(n));
            Some(g.real(0.0))
        }
        _ if g.ty(n) == Type::Boolean => {
            let nodes = g.postorder([n]);
            let fixed = |n: &ExprId| match g.node(*n) {
                Node::Var(v) => known.values.contains_key(&v) && !known.because.contains_key(&v),
                Node::Const(_) | Node::Unary(..) | Node::Binary(..) | Node::If(..) => true,
                _ => false,
            };
            if !nodes.iter().all(fixed) {
                return None;
            }
            let value = Rewriter::new().apply(g, n, &mut |g, n| of(g, n));
            g.as_const(value)?;
            deciding.extend(g.variables(n));
            Some(value)
        }
        _ => None,
    }
}
