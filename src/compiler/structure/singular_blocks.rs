//! Equations that are singular at the values of the parameters, whatever the states are.
//!
//! *In:* the blocks of the continuous phases. *Out:* an error for each block with constant
//! coefficients whose equations depend on each other, and for each other block of smooth equations of which one is a
//! combination of others with constant factors. If they are consistent, and nothing else
//! depends on what they leave open, a warning: the potentials of a circuit without a ground are
//! arbitrary, but its currents are not.

use super::error::{self, Consequence};
use super::parameter_values::ParameterValues;
use super::solve;
use crate::base::diag::{Diagnostic, Problems};
use crate::base::index::{FastMap, FastSet};
use crate::ir::blocks::{Block, Source, Torn};
use crate::ir::builtin::Shape;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::numeric::null_space::NullSpace;
use crate::symbolic::gradient::{Leaf, gradient};
use crate::symbolic::linear;

/// Larger blocks are left to the simulation.
const MAX_ORDER: usize = 150;
/// Larger blocks without constant coefficients are, too.
const MAX_ORDER_AT_POINTS: usize = 40;
/// Points at which equations are compared: a dependence at all of them is one in general.
const POINTS: usize = 3;
/// Parameters whose values a message names.
const NAMED_PARAMETERS: usize = 4;
/// Sums below this fraction of their terms are zero.
const NEGLIGIBLE: f64 = 1e-9;

/// Reports singular blocks, and returns the unknowns that are undetermined without consequence.
pub fn report(dae: &mut Dae, blocks: &[Block], problems: &mut Problems) -> Vec<VarId> {
    if !blocks.iter().any(|block| matches!(block, Block::Torn(_))) {
        return Vec::new();
    }
    let mut check = SingularityCheck { values: ParameterValues::of(dae), dae };
    let mut harmless = Vec::new();
    let mut is_repeated = false;
    for block in blocks {
        let Block::Torn(torn) = block else { continue };
        // Derivatives of equations that repeat each other do so, too: the first ones are reported.
        if is_repeated {
            break;
        }
        let singular = check.singular(torn).or_else(|| {
            let found = check.repeated(torn);
            is_repeated |= found.is_some();
            found
        });
        let Some(singular) = singular else { continue };
        let free: Vec<VarId> = singular.free();
        let consequence = if check.contradicts(&singular) {
            Consequence::NoSolution
        } else if check.has_effect(&singular) {
            Consequence::Arbitrary
        } else {
            Consequence::None
        };
        let mut problem = error::dependent_block(check.dae, &singular.sources, &free, consequence);
        if let ([source], [unknown]) = (singular.sources.as_slice(), singular.members.as_slice()) {
            let parameters = check.parameters_of_coefficient(*source, *unknown);
            problem = parameters.into_iter().fold(problem, Diagnostic::note);
        }
        problems.push(problem);
        if consequence == Consequence::None {
            harmless.extend(free);
        }
    }
    harmless
}

/// A block whose equations depend on each other.
struct SingularBlock {
    members: Vec<VarId>,
    sources: Vec<Source>,
    null_space: NullSpace,
}

impl SingularBlock {
    /// The members that the equations do not determine.
    fn free(&self) -> Vec<VarId> {
        let is_free = |k: usize| self.null_space.right.iter().any(|x| x[k] != 0.0);
        (0..self.members.len()).filter(|k| is_free(*k)).map(|k| self.members[k]).collect()
    }
}

struct SingularityCheck<'a> {
    dae: &'a mut Dae,
    values: ParameterValues,
}

impl SingularityCheck<'_> {
    /// The block, if smooth equations of it repeat others, whatever the values of its unknowns are.
    fn repeated(&mut self, torn: &Torn) -> Option<SingularBlock> {
        let (members, sources) = parts(torn);
        if members.len() < 2 || members.len() > MAX_ORDER_AT_POINTS {
            return None;
        }
        let residuals: Vec<ExprId> =
            sources.iter().map(|source| solve::residual(self.dae, *source)).collect();
        if !residuals.iter().all(|e| is_smooth(&self.dae.graph, *e)) {
            return None;
        }
        let place: FastMap<VarId, usize> =
            members.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let mut found: Option<NullSpace> = None;
        for point in 0..POINTS {
            let mut matrix = Vec::with_capacity(members.len());
            for &residual in &residuals {
                let graph = &mut self.dae.graph;
                let row = self.values.coefficients(graph, residual, &place, |values, graph, e| {
                    Some(values.sample_of(graph, e, point, |_| false))
                });
                matrix.push(row?);
            }
            let null_space = NullSpace::of(&matrix);
            let [combination] = null_space.left.as_slice() else { return None };
            match &found {
                None => found = Some(null_space),
                Some(first) if is_along(&first.left[0], combination) => {}
                Some(_) => return None,
            }
        }
        let null_space = found?;
        // The same combination of the equations themselves is a constant.
        let sum = |values: &ParameterValues, graph: &Graph, point: usize| -> Vec<f64> {
            let of = |e: &ExprId| values.sample_of(graph, *e, point, |_| false);
            residuals.iter().zip(&null_space.left[0]).map(|(e, w)| w * of(e)).collect()
        };
        let first = sum(&self.values, &self.dae.graph, 0);
        for point in 1..POINTS {
            let other = sum(&self.values, &self.dae.graph, point);
            if !vanishes(first.iter().copied().chain(other.iter().map(|x| -x))) {
                return None;
            }
        }
        Some(SingularBlock { members, sources, null_space })
    }

    /// The block, if it is linear with constant coefficients and singular.
    fn singular(&mut self, torn: &Torn) -> Option<SingularBlock> {
        let order = torn.unknowns.len() + torn.explicit.len();
        if !torn.linear || order > MAX_ORDER {
            return None;
        }
        let (members, sources) = parts(torn);
        let place: FastMap<VarId, usize> =
            members.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let mut matrix = Vec::with_capacity(order);
        for &source in &sources {
            let residual = solve::residual(self.dae, source);
            matrix.push(self.values.coefficients(
                &mut self.dae.graph,
                residual,
                &place,
                |values, graph, e| values.number(graph, e),
            )?);
        }
        let null_space = NullSpace::of(&matrix);
        (!null_space.right.is_empty()).then_some(SingularBlock { members, sources, null_space })
    }

    /// The values of the parameters in the coefficient of an unknown, as sentences.
    fn parameters_of_coefficient(&mut self, source: Source, unknown: VarId) -> Vec<String> {
        let residual = solve::residual(self.dae, source);
        let graph = &mut self.dae.graph;
        let partials =
            gradient(graph, residual, |leaf| matches!(leaf, Leaf::Var(v) if v == unknown));
        let mut read: Vec<VarId> =
            partials.into_iter().flat_map(|(_, partial)| graph.variables(partial)).collect();
        read.sort_unstable();
        read.dedup();
        let sentence = |v: VarId| {
            let value = self.values.literal(&self.dae.graph, v)?;
            Some(format!("`{}` is {value}", self.dae.variables[v].name))
        };
        read.into_iter().filter_map(sentence).take(NAMED_PARAMETERS).collect()
    }

    /// True if the equations have no solution for general values of everything else.
    fn contradicts(&mut self, block: &SingularBlock) -> bool {
        let members: FastSet<VarId> = block.members.iter().copied().collect();
        let residuals: Vec<ExprId> =
            block.sources.iter().map(|source| solve::residual(self.dae, *source)).collect();
        let at = |is_zero: &dyn Fn(VarId) -> bool| -> Vec<f64> {
            let of = |e: &ExprId| self.values.sample(&self.dae.graph, *e, is_zero);
            residuals.iter().map(of).collect()
        };
        let mut values = at(&|v| members.contains(&v));
        if !values.iter().all(|x| x.is_finite()) {
            values = at(&|_| false);
        }
        let left = &block.null_space.left;
        left.iter().any(|w| !vanishes(w.iter().zip(&values).map(|(w, r)| w * r)))
    }

    /// True if something else changes with what the block leaves open.
    fn has_effect(&mut self, block: &SingularBlock) -> bool {
        let free = block.free();
        let is_rate = |v: &VarId| self.dae.variables[*v].derivative_of.is_some();
        if free.iter().any(is_rate) {
            return true;
        }
        let others: Vec<Source> = self.dae.equations.ids().map(Source::Continuous).collect();
        let others = others.into_iter().filter(|source| !block.sources.contains(source));
        let mut expressions: Vec<ExprId> =
            others.map(|source| solve::residual(self.dae, source)).collect();
        let dae = &mut *self.dae;
        for relation in &dae.relations {
            expressions.push(dae.graph.sub(relation.lhs, relation.rhs));
        }
        expressions.extend(dae.discrete.iter().map(|d| d.value));
        expressions.extend(dae.reinits.iter().map(|r| r.value));
        expressions.extend(dae.asserts.iter().map(|a| a.assert.condition));
        let free: FastSet<VarId> = free.into_iter().collect();
        expressions.into_iter().any(|e| self.changes(e, block, &free))
    }

    /// True if an expression changes along the null space of a block.
    fn changes(&mut self, e: ExprId, block: &SingularBlock, free: &FastSet<VarId>) -> bool {
        let graph = &mut self.dae.graph;
        if !graph.variables(e).iter().any(|v| free.contains(v)) {
            return false;
        }
        if graph.ty(e) != Type::Real
            || linear::hidden_variables(graph, e).iter().any(|v| free.contains(v))
        {
            return true;
        }
        let wanted = |leaf| matches!(leaf, Leaf::Var(v) if free.contains(&v));
        let slopes: FastMap<VarId, f64> = gradient(graph, e, wanted)
            .into_iter()
            .filter_map(|(leaf, partial)| match leaf {
                Leaf::Var(v) => Some((v, self.values.sample(&self.dae.graph, partial, |_| false))),
                _ => None,
            })
            .collect();
        block.null_space.right.iter().any(|x| {
            let along = block.members.iter().zip(x);
            !vanishes(along.map(|(v, x)| slopes.get(v).copied().unwrap_or(0.0) * x))
        })
    }
}

/// The variables of a block, and its equations.
fn parts(torn: &Torn) -> (Vec<VarId>, Vec<Source>) {
    let explicit = torn.explicit.iter();
    let members = torn.unknowns.iter().copied().chain(explicit.clone().map(|a| a.variable));
    let sources = torn.residuals.iter().map(|r| r.source).chain(explicit.map(|a| a.source));
    (members.collect(), sources.collect())
}

/// Whether an expression consists of smooth functions, without branches.
fn is_smooth(graph: &Graph, e: ExprId) -> bool {
    graph.postorder([e]).into_iter().all(|node| match graph.node(node) {
        Node::Const(_) | Node::Var(_) | Node::Time | Node::Der(_) => true,
        Node::Unary(op, _) => op.facts().is_some_and(|f| f.shape == Shape::Smooth),
        Node::Binary(op, ..) => op.facts().is_some_and(|f| f.shape == Shape::Smooth),
        _ => false,
    })
}

/// Whether two combinations are the same up to a factor.
fn is_along(a: &[f64], b: &[f64]) -> bool {
    let largest = (0..a.len()).fold(0, |m, k| if a[k].abs() > a[m].abs() { k } else { m });
    a.iter().zip(b).all(|(x, y)| {
        vanishes([x * b[largest], -y * a[largest]].into_iter())
            || (x * b[largest]).abs() + (y * a[largest]).abs()
                <= NEGLIGIBLE * (a[largest] * b[largest]).abs()
    })
}

/// True if a sum is zero up to rounding.
fn vanishes(terms: impl Iterator<Item = f64>) -> bool {
    let (mut sum, mut size) = (0.0, 0.0);
    for term in terms {
        sum += term;
        size += f64::abs(term);
    }
    f64::abs(sum) <= NEGLIGIBLE * size
}
