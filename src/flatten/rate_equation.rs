//! Rate equations, and terms added to them: `annotation(__mocc(adds = "der(w) = friction.term"))`.
//!
//! The rate of a state follows from one equation, a balance of what changes the state: `J*der(w) = tau - c*w`. A model
//! that extends another one can connect something to its connectors, but cannot change an equation that stands in its
//! text. The vendor-specific annotation (Modelica Language Specification 3.6, section 18.1) names the rate and a
//! variable of the model, which is added to the side opposite of the rate: a positive term increases the rate if its
//! coefficient is positive.

use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::ir::ast::Variability;
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::{EquationKind, FlatModel};

use super::annotation::Pair;
use super::cause::{FlattenCause, WrongTerm};

/// The equation that the rate of a state follows from.
#[derive(Clone, Debug)]
pub struct RateEquation {
    /// The state.
    pub state: VarId,
    /// The variables that the equation reads, without parameters.
    pub reads: Vec<VarId>,
    /// Place of the equation.
    pub span: Span,
    at: Slot,
    /// The rate has a positive coefficient on the left side or a negative one on the right side.
    is_left: bool,
}

impl RateEquation {
    /// The rate, as in `der(w)`.
    pub fn name(&self, flat: &FlatModel) -> String {
        format!("der({})", flat.variables[self.state].name)
    }
}

/// Where an equation is in a flat model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Slot {
    Equation(usize),
    Binding(VarId),
}

/// The rate equations of a model, in order: of each state, the first equation that has its rate, or a variable that is
/// equal to its rate, and is not the rate equation of another state. An equation `der(s) = v` between two states only
/// says what `v` is, and is not among them.
pub fn rate_equations(flat: &FlatModel) -> Vec<RateEquation> {
    let sides = sides(flat);
    let mut states: FastSet<VarId> = FastSet::default();
    for (_, left, right, _) in &sides {
        let nodes = flat.graph.postorder([*left, *right]);
        states.extend(nodes.into_iter().filter_map(|e| rate(&flat.graph, e)));
    }
    // Variables that are equal to a rate.
    let mut aliases: FastMap<VarId, VarId> = FastMap::default();
    for (_, left, right, _) in &sides {
        aliases.extend(alias(&flat.graph, *left, *right).filter(|(v, _)| !states.contains(v)));
    }
    let is_parameter = |v: VarId| flat.variables[v].variability <= Variability::Parameter;
    let mut found: Vec<RateEquation> = Vec::new();
    let mut taken: FastSet<VarId> = FastSet::default();
    for (at, left, right, span) in sides {
        if alias(&flat.graph, left, right).is_some_and(|(v, _)| aliases.contains_key(&v)) {
            continue;
        }
        let nodes = flat.graph.postorder([left, right]);
        let (mut rates, mut reads) = (Vec::new(), Vec::new());
        let mut has_parameter = false;
        for e in nodes {
            let Some((node, state)) = state_of(&flat.graph, &aliases, e) else { continue };
            match (node, state) {
                (_, Some(state)) => rates.push((e, state)),
                (v, None) if is_parameter(v) => has_parameter = true,
                (v, None) => reads.push(v),
            }
        }
        let is_definition = !has_parameter
            && rates.len() == 1
            && matches!(reads.as_slice(), [v] if states.contains(v) && *v != rates[0].1);
        let free = rates.iter().find(|(_, state)| !taken.contains(state));
        let Some(&(e, state)) = free else { continue };
        if !is_definition {
            taken.insert(state);
            let is_positive = |side| sign(&flat.graph, side, e, 0);
            let is_left = is_positive(left).unwrap_or_else(|| !is_positive(right).unwrap_or(false));
            found.push(RateEquation { state, reads, span, at, is_left });
        }
    }
    found
}

/// The equations between real numbers: where they are, both sides, and the place in the source.
fn sides(flat: &FlatModel) -> Vec<(Slot, ExprId, ExprId, Span)> {
    let mut out = Vec::new();
    for (k, equation) in flat.equations.iter().enumerate() {
        if let EquationKind::Equal(left, right) = equation.kind {
            out.push((Slot::Equation(k), left, right, equation.origin.span));
        }
    }
    for (v, x) in flat.variables.enumerate() {
        let is_continuous = x.variability == Variability::Continuous && x.ty == Type::Real;
        if let Some(bound) = x.binding.filter(|_| is_continuous)
            && let Some(own) = flat.graph.known_variable(v)
        {
            out.push((Slot::Binding(v), own, bound, x.span));
        }
    }
    out
}

/// The state whose rate a node is.
fn rate(graph: &Graph, e: ExprId) -> Option<VarId> {
    match graph.node(e) {
        Node::Der(state) => Some(state),
        _ => None,
    }
}

/// Of `a = der(x)`, the variable and the state.
fn alias(graph: &Graph, left: ExprId, right: ExprId) -> Option<(VarId, VarId)> {
    let of = |a, b| match graph.node(a) {
        Node::Var(v) => Some((v, rate(graph, b)?)),
        _ => None,
    };
    of(left, right).or_else(|| of(right, left))
}

/// The variable of a node, and the state whose rate it is or is equal to.
fn state_of(
    graph: &Graph,
    aliases: &FastMap<VarId, VarId>,
    e: ExprId,
) -> Option<(VarId, Option<VarId>)> {
    match graph.node(e) {
        Node::Der(state) => Some((state, Some(state))),
        Node::Var(v) => Some((v, aliases.get(&v).copied())),
        _ => None,
    }
}

/// Operators around a rate up to which its sign is searched.
const MAX_DEPTH: usize = 200;

/// Whether a node has a positive coefficient in an expression, as far as signs are written; `None` if it does not occur
/// in it.
fn sign(graph: &Graph, within: ExprId, of: ExprId, depth: usize) -> Option<bool> {
    if within == of || depth > MAX_DEPTH {
        return (within == of).then_some(true);
    }
    let part = |e| sign(graph, e, of, depth + 1);
    let is_negative = |e| graph.as_number(e).is_some_and(|x| x < 0.0);
    match graph.node(within) {
        Node::Unary(Unary::Neg, a) => part(a).map(|positive| !positive),
        Node::Binary(Binary::Sub, a, b) => part(a).or_else(|| part(b).map(|positive| !positive)),
        Node::Binary(Binary::Mul, a, b) => match part(a) {
            Some(positive) => Some(positive != is_negative(b)),
            None => part(b).map(|positive| positive != is_negative(a)),
        },
        Node::Binary(_, a, b) => part(a).or_else(|| part(b)),
        Node::Unary(_, a) | Node::NoEvent(a) | Node::Smooth(_, a) => part(a),
        Node::If(_, a, b) => part(a).or_else(|| part(b)),
        _ => None,
    }
}

/// Adds terms to rate equations, each pair a rate and a variable. Returns what cannot be done.
pub(super) fn apply(flat: &mut FlatModel, pairs: &[Pair]) -> Vec<Diagnostic> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let equations = rate_equations(flat);
    let mut problems = Vec::new();
    for pair in pairs {
        let equation = equations.iter().find(|e| e.name(flat) == pair.left);
        let term = flat.variables.enumerate().find(|(_, x)| x.name == pair.right);
        let term = term.filter(|(_, x)| x.ty == Type::Real).map(|(v, _)| v);
        match (equation, term) {
            (Some(equation), Some(term)) => add(flat, equation, term),
            (equation, _) => {
                let why = if equation.is_none() { WrongTerm::Rate } else { WrongTerm::Term };
                let (rate, term) = (pair.left.clone(), pair.right.clone());
                let cause = FlattenCause::UnusableTerm { rate, term, why };
                problems.push(Diagnostic::new(cause, pair.span));
            }
        }
    }
    problems
}

/// Adds a term to the side opposite of the rate.
fn add(flat: &mut FlatModel, equation: &RateEquation, term: VarId) {
    let graph = &mut flat.graph;
    let term = graph.var(term, Type::Real);
    match equation.at {
        Slot::Equation(k) => {
            let EquationKind::Equal(left, right) = &mut flat.equations[k].kind else { return };
            let side = if equation.is_left { right } else { left };
            *side = graph.add(*side, term);
        }
        Slot::Binding(v) => {
            let bound = &mut flat.variables[v].binding;
            *bound = bound.map(|bound| match equation.is_left {
                true => graph.add(bound, term),
                false => graph.sub(bound, term),
            });
        }
    }
}
