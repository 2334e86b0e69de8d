//! Equations that terms can be added to: `annotation(__mocc(adds = "der(w) = friction.term"))`.
//!
//! The rate of a state follows from one equation, a balance of what changes the state: `J*der(w) = tau - c*w`. Other
//! variables have an equation that is solved for them: `F = c*s + d*v`. A model that extends another one can connect
//! something to its connectors, but cannot change an equation that stands in its text. The vendor-specific annotation
//! (Modelica Language Specification 3.6, section 18.1) names the rate or the variable, and a variable of the model that is
//! added to the other side: a positive term increases a rate if its coefficient is positive.

use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::ir::ast::Variability;
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::{Equation, EquationKind, FlatModel};
use crate::symbolic::print::print;

use super::annotation::Pair;
use super::cause::{FlattenCause, WrongTerm};

/// An equation that a term can be added to.
#[derive(Clone, Debug)]
pub struct OpenEquation {
    /// What follows from it.
    pub determines: Determined,
    /// The variables that it reads, without parameters.
    pub reads: Vec<VarId>,
    /// It reads a parameter.
    pub has_parameter: bool,
    /// Place of the equation.
    pub span: Span,
    /// It has a rate on the side opposite of what it determines, or determines one.
    pub has_rate: bool,
    at: Slot,
    /// What it determines has a positive coefficient on the left side or a negative one on the right side.
    is_left: bool,
}

/// What follows from an equation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Determined {
    /// The rate of a state.
    Rate(VarId),
    /// A variable.
    Variable(VarId),
}

impl OpenEquation {
    /// What it determines, as in `der(w)` or `F`.
    pub fn name(&self, flat: &FlatModel) -> String {
        match self.determines {
            Determined::Rate(state) => format!("der({})", flat.variables[state].name),
            Determined::Variable(v) => flat.variables[v].name.clone(),
        }
    }

    /// Its terms that vary, as Modelica text with the sign that they have on the side opposite of what the equation
    /// determines; without the inputs of the model, and without long ones.
    pub fn terms(&self, flat: &FlatModel) -> Vec<String> {
        let (own, other) = match self.at {
            Slot::Equation(k) => match flat.equations[k].kind {
                EquationKind::Equal(left, right) if self.is_left => (Some(left), right),
                EquationKind::Equal(left, right) => (Some(right), left),
                _ => return Vec::new(),
            },
            Slot::Binding(v) => match flat.variables[v].binding {
                Some(bound) => (None, bound),
                None => return Vec::new(),
            },
        };
        let mut all = Vec::new();
        split(&flat.graph, other, true, &mut all);
        own.into_iter().for_each(|own| split(&flat.graph, own, false, &mut all));
        let is_variable = |v: &VarId| flat.variables[*v].variability > Variability::Parameter;
        let is_plain = |e| match flat.graph.node(e) {
            Node::Var(v) => flat.variables[v].is_open_input(),
            _ => false,
        };
        let solved_for = match self.determines {
            Determined::Variable(v) => flat.graph.known_variable(v),
            Determined::Rate(_) => None,
        };
        let has_rate =
            |e| flat.graph.postorder([e]).iter().any(|e| rate(&flat.graph, *e).is_some());
        let varies = |e: ExprId| flat.graph.variables(e).iter().any(is_variable);
        all.retain(|(e, _)| varies(*e) && !has_rate(*e) && !is_plain(*e) && solved_for != Some(*e));
        let names = |v: VarId| flat.variables[v].name.clone();
        let text = |(e, is_positive): (ExprId, bool)| {
            let text = print(&flat.graph, e, &names);
            if is_positive { text } else { format!("-({text})") }
        };
        all.into_iter().map(text).filter(|text| text.len() <= LONGEST_TERM).collect()
    }

    /// Where it is.
    pub(super) fn slot(&self) -> Slot {
        self.at
    }

    /// True if both are one equation.
    pub fn is_same(&self, other: &OpenEquation) -> bool {
        self.at == other.at
    }
}

/// Where an equation is in a flat model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Slot {
    /// One of the equations, by its position.
    Equation(usize),
    /// The binding of a variable.
    Binding(VarId),
}

/// The rate equations of a model, in order: of each state, the first equation that has its rate, or a variable that is
/// equal to its rate, and is not the rate equation of another state. An equation `der(s) = v` between two states only
/// says what `v` is, and is not among them.
pub fn rate_equations(flat: &FlatModel) -> Vec<OpenEquation> {
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
    let mut found: Vec<OpenEquation> = Vec::new();
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
            let determines = Determined::Rate(state);
            let has_rate = true;
            found.push(OpenEquation {
                determines,
                reads,
                has_parameter,
                span,
                at,
                is_left,
                has_rate,
            });
        }
    }
    found
}

/// The equation that is solved for a variable, with an expression on the other side. Of several, one without rates is
/// preferred, and one with the variable on its left: of `F = m*der(v)` and `F = -c*s`, the second determines `F`.
pub fn explicit_equation(flat: &FlatModel, v: VarId) -> Option<OpenEquation> {
    let own = flat.graph.known_variable(v);
    let has_rate = |e| flat.graph.postorder([e]).iter().any(|e| rate(&flat.graph, *e).is_some());
    let with = |is_left: bool| {
        let of_equation = move |(k, equation): (usize, &Equation)| {
            let EquationKind::Equal(left, right) = equation.kind else { return None };
            let (side, other) = if is_left { (left, right) } else { (right, left) };
            (Some(side) == own).then_some((Slot::Equation(k), other, equation.origin.span, is_left))
        };
        flat.equations.iter().enumerate().filter_map(of_equation)
    };
    let bound = flat.variables[v].binding.filter(|_| is_continuous(flat, v));
    let bound = bound.map(|bound| (Slot::Binding(v), bound, flat.variables[v].span, true));
    let is_variable = |v: &VarId| flat.variables[*v].variability > Variability::Parameter;
    let is_plain = |e| matches!(flat.graph.node(e), Node::Var(_) | Node::Der(_) | Node::Const(_));
    let open = bound.into_iter().chain(with(true)).chain(with(false)).filter_map(|found| {
        let (at, other, span, is_left) = found;
        let (reads, parameters): (Vec<VarId>, Vec<VarId>) =
            flat.graph.variables(other).into_iter().partition(is_variable);
        let has_parameter = !parameters.is_empty();
        let determines = Determined::Variable(v);
        let has_rate = has_rate(other);
        let is_open = !is_plain(other) && !reads.is_empty();
        is_open.then_some(OpenEquation {
            determines,
            reads,
            has_parameter,
            span,
            at,
            is_left,
            has_rate,
        })
    });
    open.min_by_key(|e| e.has_rate)
}

fn is_continuous(flat: &FlatModel, v: VarId) -> bool {
    let x = &flat.variables[v];
    x.variability == Variability::Continuous && x.ty == Type::Real
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
        if let Some(bound) = x.binding.filter(|_| is_continuous(flat, v))
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

/// Letters of a term that is still a name for people.
const LONGEST_TERM: usize = 60;

/// The terms of a sum, and whether each is added.
fn split(graph: &Graph, e: ExprId, is_positive: bool, out: &mut Vec<(ExprId, bool)>) {
    let mut left = vec![(e, is_positive)];
    while let Some((e, is_positive)) = left.pop() {
        match graph.node(e) {
            Node::Unary(Unary::Neg, a) => left.push((a, !is_positive)),
            Node::Binary(Binary::Add, a, b) => left.extend([(b, is_positive), (a, is_positive)]),
            Node::Binary(Binary::Sub, a, b) => left.extend([(b, !is_positive), (a, is_positive)]),
            _ => out.push((e, is_positive)),
        }
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

/// Adds terms to equations, each pair what an equation determines and a variable. Returns what cannot be done.
pub(super) fn apply(flat: &mut FlatModel, pairs: &[Pair]) -> Vec<Diagnostic> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let rates = rate_equations(flat);
    let by_name = |flat: &FlatModel, name: &str| -> Option<VarId> {
        let found = flat.variables.enumerate().find(|(_, x)| x.name == name && x.ty == Type::Real);
        found.map(|(v, _)| v)
    };
    let mut problems = Vec::new();
    for pair in pairs {
        let equation = match pair.left.starts_with("der(") {
            true => rates.iter().find(|e| e.name(flat) == pair.left).cloned(),
            false => by_name(flat, &pair.left).and_then(|v| explicit_equation(flat, v)),
        };
        match (equation, by_name(flat, &pair.right)) {
            (Some(equation), Some(term)) => add(flat, &equation, term),
            (equation, _) => {
                let why = if equation.is_none() { WrongTerm::Equation } else { WrongTerm::Term };
                let (determined, term) = (pair.left.clone(), pair.right.clone());
                let cause = FlattenCause::UnusableTerm { determined, term, why };
                problems.push(Diagnostic::new(cause, pair.span));
            }
        }
    }
    problems
}

/// Adds a term to the side opposite of what the equation determines.
fn add(flat: &mut FlatModel, equation: &OpenEquation, term: VarId) {
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
