//! Incidences that are there in the text and not in the numbers: `R * i` where the parameter `R` is 0,
//! `if P > 0 then G * v else 0` where the parameter `P` is 0.
//!
//! A matching that rests on one of them gives a singular matrix at run time. So such incidences are
//! used last; and where a system can not be matched without them, the equation takes the form that
//! it has at these values, and the parameters that decide it fix the structure from then on.

use super::incidence::System;
use crate::base::index::{FastMap, FastSet, Id, IndexVec};
use crate::graph::bipartite::Edge;
use crate::graph::matching::Matching;
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, EqId, Kind};
use crate::ir::expr::{Const, ExprId, Graph, Node, Type, VarId};
use crate::symbolic::eval;
use crate::symbolic::rewrite::Rewriter;

/// So long may a chain of equations be of which each makes the next one come down.
const ROUNDS: usize = 20;

/// What equations are at the values of the parameters.
pub struct Vanishing {
    forms: FastMap<EqId, Form>,
}

/// An equation from which variables vanish.
struct Form {
    lhs: ExprId,
    rhs: ExprId,
    residual: ExprId,
    /// What it does not read then.
    gone: FastSet<VarId>,
    /// The parameters that decide it.
    decisive: Vec<VarId>,
}

/// What is literally known: parameters, and variables that are 0 because parameters are.
struct Known {
    /// Expressions of parameters alone that are 0.
    zeros: FastSet<ExprId>,
    values: FastMap<VarId, ExprId>,
    /// The parameters that make a variable 0.
    because: FastMap<VarId, Vec<VarId>>,
}

impl Vanishing {
    /// Looks at all continuous equations. An equation that comes down to `v = 0` makes others come
    /// down in turn.
    pub fn find(dae: &mut Dae) -> Vanishing {
        let values = values(dae);
        let zeros = zeros(&dae.graph, &values);
        let mut known = Known { zeros, values, because: FastMap::default() };
        let mut forms = FastMap::default();
        for _ in 0..ROUNDS {
            let before = known.because.len();
            for id in dae.equations.ids() {
                if is_suspicious(dae, dae.equations[id].residual, &known) {
                    look(dae, id, &mut known, &mut forms);
                }
            }
            if known.because.len() == before {
                break;
            }
        }
        Vanishing { forms }
    }

    /// True if nothing vanishes.
    pub fn is_empty(&self) -> bool {
        self.forms.is_empty()
    }

    /// For each edge of a system whether it vanishes.
    pub fn edges(&self, system: &System) -> IndexVec<Edge, bool> {
        let rows = system
            .graph
            .rows()
            .flat_map(|row| system.graph.edges(row).map(move |edge| (system.sources[row], edge)));
        rows.map(|(source, edge)| self.is_gone(source, system.unknowns[system.graph.col(edge)]))
            .collect()
    }

    /// The equations that a matching gives a variable which vanishes from them; of a differentiated
    /// equation the one that the model has.
    pub fn mismatched(&self, dae: &Dae, system: &System, matching: &Matching) -> Vec<EqId> {
        let pairs = matching.pairs();
        let wrong =
            pairs.filter(|(row, col)| self.is_gone(system.sources[*row], system.unknowns[*col]));
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

    /// Gives equations the form that they have at the values of their parameters; false if there is
    /// nothing to change.
    pub fn apply(&self, dae: &mut Dae, equations: &[EqId]) -> bool {
        let mut changed = false;
        for &id in equations {
            let Some(form) = self.forms.get(&id) else { continue };
            let e = &mut dae.equations[id];
            (e.lhs, e.rhs, e.residual) = (form.lhs, form.rhs, form.residual);
            for &v in &form.decisive {
                dae.variables[v].structural = true;
            }
            changed = true;
        }
        changed
    }

    fn is_gone(&self, source: Source, v: VarId) -> bool {
        match source {
            Source::Continuous(id) => self.forms.get(&id).is_some_and(|f| f.gone.contains(&v)),
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

/// The values of the parameters, as far as the text gives them.
fn values(dae: &mut Dae) -> FastMap<VarId, ExprId> {
    let mut values: FastMap<VarId, ExprId> = FastMap::default();
    let mut rewriter = Rewriter::new();
    for k in 0..dae.parameters.len() {
        let (v, e) = dae.parameters[k];
        let value = rewriter.apply(&mut dae.graph, e, &mut |g, n| match g.node(n) {
            Node::Var(p) => values.get(&p).copied(),
            _ => None,
        });
        if dae.variables[v].vanishes {
            values.insert(v, dae.graph.real(0.0));
        } else if dae.graph.as_const(value).is_some() {
            values.insert(v, value);
        }
    }
    values
}

/// The sums, products and the like of parameters that are 0 at their values.
fn zeros(graph: &Graph, values: &FastMap<VarId, ExprId>) -> FastSet<ExprId> {
    let mut known: Vec<Option<f64>> = Vec::with_capacity(graph.len());
    let mut zeros = FastSet::default();
    // Operands have lower numbers.
    for e in graph.ids() {
        let of = |a: ExprId| known.get(a.idx()).copied().flatten();
        let value = match graph.node(e) {
            Node::Const(c) => Some(c.register()),
            Node::Var(v) => {
                values.get(&v).and_then(|value| graph.as_const(*value)).map(Const::register)
            }
            Node::Unary(op, a) => of(a).map(|a| eval::unary(op, a)),
            Node::Binary(op, a, b) => match (of(a), of(b)) {
                (Some(a), Some(b)) => Some(eval::binary(op, a, b)),
                _ => None,
            },
            Node::If(c, a, b) => of(c).and_then(|c| of(if c != 0.0 { a } else { b })),
            Node::NoEvent(a) => of(a),
            _ => None,
        };
        let composite = matches!(graph.node(e), Node::Unary(..) | Node::Binary(..));
        if composite && graph.ty(e) == Type::Real && value == Some(0.0) {
            zeros.insert(e);
        }
        known.push(value);
    }
    zeros
}

/// The form of an equation with what is known now.
fn look(dae: &mut Dae, id: EqId, known: &mut Known, forms: &mut FastMap<EqId, Form>) {
    let e = dae.equations[id].clone();
    let mut decisive = Vec::new();
    let mut rewriter = Rewriter::new();
    let mut form = |graph: &mut Graph, root| {
        rewriter.apply(graph, root, &mut |g, n| decided(g, n, known, &mut decisive))
    };
    let (lhs, rhs) = (form(&mut dae.graph, e.lhs), form(&mut dae.graph, e.rhs));
    let residual = form(&mut dae.graph, e.residual);
    let left: FastSet<VarId> = dae.graph.variables(residual).into_iter().collect();
    let is_unknown =
        |v: &VarId| !matches!(dae.variables[*v].kind, Kind::Parameter | Kind::Discrete);
    let before = dae.graph.variables(e.residual);
    let gone: FastSet<VarId> =
        before.into_iter().filter(|v| is_unknown(v) && !left.contains(v)).collect();
    decisive.sort_unstable();
    decisive.dedup();
    for (side, other) in [(e.lhs, rhs), (e.rhs, lhs)] {
        if let Node::Var(v) = dae.graph.node(side)
            && dae.variables[v].kind == Kind::Algebraic
            && dae.graph.as_number(other) == Some(0.0)
            && !known.because.contains_key(&v)
        {
            known.because.insert(v, decisive.clone());
            let zero = dae.graph.real(0.0);
            known.values.insert(v, zero);
            // This equation says so: in itself the variable stays.
            return;
        }
    }
    if !gone.is_empty() && !known.says_zero(dae, id) {
        forms.insert(id, Form { lhs, rhs, residual, gone, decisive });
    }
}

impl Known {
    fn is_zero(&self, graph: &Graph, v: VarId) -> bool {
        self.values.get(&v).is_some_and(|value| graph.as_number(*value) == Some(0.0))
    }

    /// True if the equation gives a variable its value 0.
    fn says_zero(&self, dae: &Dae, id: EqId) -> bool {
        let e = &dae.equations[id];
        [e.lhs, e.rhs].into_iter().any(|side| match dae.graph.node(side) {
            Node::Var(v) => self.because.contains_key(&v),
            _ => false,
        })
    }
}

/// True if something that is 0, or a selection, stands in it.
fn is_suspicious(dae: &Dae, e: ExprId, known: &Known) -> bool {
    dae.graph.postorder([e]).into_iter().any(|n| match dae.graph.node(n) {
        Node::Var(v) => known.is_zero(&dae.graph, v),
        Node::If(..) => true,
        _ => known.zeros.contains(&n),
    })
}

/// What is 0, and conditions on parameters, as literals.
fn decided(g: &mut Graph, n: ExprId, known: &Known, decisive: &mut Vec<VarId>) -> Option<ExprId> {
    let of = |g: &Graph, n| match g.node(n) {
        Node::Var(v) => known.values.get(&v).copied(),
        _ => None,
    };
    match g.node(n) {
        Node::Const(_) => None,
        Node::Var(v) if known.is_zero(g, v) => {
            decisive.extend(known.because.get(&v).map_or(&[v][..], Vec::as_slice));
            known.values.get(&v).copied()
        }
        _ if known.zeros.contains(&n) => {
            decisive.extend(g.variables(n));
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
            decisive.extend(g.variables(n));
            Some(value)
        }
        _ => None,
    }
}
