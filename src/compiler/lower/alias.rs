//! Alias elimination: finds variables that equal another one, its negative, or a constant.
//!
//! `a = b`, `a = -b`, `a + b = 0` put variables into one class (union-find with signs); `v =
//! der(s)` makes v the name of a derivative; `v = e` with a parameter expression e gives v a value.
//! [`super::representative`] chooses the variable that represents a class.

use super::Equal;
use super::variability::Variabilities;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::ir::dae::{Variable, VariableKind};
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::Variability;

/// Longer sums are not searched for terms that are 0.
const MAX_TERMS: usize = 8;

/// Maximum number of passes over the equations after variables were found to be 0.
const MAX_ROUNDS: usize = 5;

/// A variable or its negative.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signed {
    /// The variable.
    pub variable: VarId,
    /// True for the negative of the variable.
    pub negative: bool,
}

/// The classes of equal variables, each identified by its root.
pub struct AliasClasses {
    /// The variables that are equal up to sign.
    pub union: SignedUnion,
    /// The value of the root of each constant class.
    pub value: FastMap<VarId, ExprId>,
    /// `der(root) = other root`, up to sign. Every root is the name of at most one derivative, and
    /// the names form no cycle.
    pub derivative_name: FastMap<VarId, Signed>,
    /// Roots that are the name of a derivative.
    pub is_derivative_name: FastSet<VarId>,
}

/// Removes the equations that only state that variables are equal, and returns the rest. A
/// redundant equation is kept, so that it counts as one equation too many.
pub fn find_aliases(
    graph: &mut Graph,
    variables: &IndexVec<VarId, Variable>,
    equations: Vec<Equal>,
) -> (AliasClasses, Vec<Equal>) {
    let union = SignedUnion::new(variables.len());
    let mut search = AliasSearch {
        graph,
        variables,
        variability: Variabilities::default(),
        chains: SignedUnion::new(variables.len()),
        with_input: variables.iter().map(|v| v.kind == VariableKind::Input).collect(),
        in_semilinear: IndexVec::filled(false, variables.len()),
        fixed_start: variables
            .enumerate()
            .filter(|(_, v)| v.kind == VariableKind::Discrete && v.fixed == Some(true))
            .filter_map(|(id, v)| Some((id, v.start?)))
            .collect(),
        classes: AliasClasses {
            union,
            value: FastMap::default(),
            derivative_name: FastMap::default(),
            is_derivative_name: FastSet::default(),
        },
    };
    // Aliases first, so that the other two steps see complete classes; constants before names of
    // derivatives, because a constant cannot be one.
    let mut remaining = equations;
    remaining.retain(|e| !search.unite(e));
    remaining.retain(|e| !search.add_constant(e));
    // Variables that are 0 may reduce a sum to two terms. That matters for zero flows, see
    // `semilinear`; elsewhere a sum is as good as an alias.
    search.mark_semilinear(&remaining);
    for _ in 0..MAX_ROUNDS {
        if !search.in_semilinear.iter().any(|f| *f) {
            break;
        }
        let before = remaining.len();
        remaining.retain(|e| !search.unite(e));
        if remaining.len() == before {
            break;
        }
        remaining.retain(|e| !search.add_constant(e));
    }
    remaining.retain(|e| !search.add_derivative_name(e));
    (search.classes, remaining)
}

struct AliasSearch<'a> {
    graph: &'a mut Graph,
    variables: &'a IndexVec<VarId, Variable>,
    variability: Variabilities,
    /// Roots joined by names of derivatives: a name within one chain would close a cycle.
    chains: SignedUnion,
    with_input: IndexVec<VarId, bool>,
    /// Classes with a variable that is defined by `semiLinear`.
    in_semilinear: IndexVec<VarId, bool>,
    /// The fixed starts of discrete classes, by root.
    fixed_start: FastMap<VarId, ExprId>,
    classes: AliasClasses,
}

/// A term of a sum: `v` or `der(v)`.
#[derive(Clone, Copy)]
struct Term {
    variable: VarId,
    differentiated: bool,
    negative: bool,
}

impl AliasSearch<'_> {
    /// Marks the classes with a variable that is defined by `semiLinear`.
    fn mark_semilinear(&mut self, equations: &[Equal]) {
        for e in equations {
            for (side, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
                let v = match self.graph.node(side) {
                    Node::Var(v) => v,
                    Node::Unary(Unary::Neg, a) => match self.graph.node(a) {
                        Node::Var(v) => v,
                        _ => continue,
                    },
                    _ => continue,
                };
                let Node::Smooth(_, inner) = self.graph.node(other) else { continue };
                let Node::If(c, ..) = self.graph.node(inner) else { continue };
                let Node::Binary(Binary::GreaterEqual, _, zero) = self.graph.node(c) else {
                    continue;
                };
                if self.graph.as_number(zero) == Some(0.0) {
                    let root = self.classes.union.find(v).variable;
                    self.in_semilinear[root] = true;
                }
            }
        }
    }

    /// Unites the variables of `a = b` and similar equations if they are of one kind.
    fn unite(&mut self, e: &Equal) -> bool {
        let (union, value) = (&mut self.classes.union, &self.classes.value);
        let graph = &*self.graph;
        let mut is_zero = |v: VarId| {
            let known = value.get(&union.find(v).variable);
            known.is_some_and(|e| graph.as_number(*e) == Some(0.0))
        };
        let Some([a, b]) = terms(graph, e, MAX_TERMS, &mut is_zero) else { return false };
        let negative = a.negative == b.negative;
        let of_one_kind = |x: &Variable, y: &Variable| match (x.kind, y.kind) {
            (
                VariableKind::Algebraic | VariableKind::Input,
                VariableKind::Algebraic | VariableKind::Input,
            ) => x.ty == Type::Real,
            (VariableKind::Discrete, VariableKind::Discrete) => x.ty == y.ty && !negative,
            _ => false,
        };
        let (x, y) = (&self.variables[a.variable], &self.variables[b.variable]);
        if a.differentiated || b.differentiated || x.ty != y.ty || !of_one_kind(x, y) {
            return false;
        }
        let roots = [a, b].map(|t| self.classes.union.find(t.variable).variable);
        let longer = two_terms(self.graph, e).is_none();
        if longer && !roots.iter().any(|r| self.in_semilinear[*r]) {
            return false;
        }
        let has_value = |r: &VarId| self.classes.value.contains_key(r);
        if roots.iter().all(|r| self.with_input[*r]) || roots.iter().any(has_value) {
            return false;
        }
        // Equal discrete variables may have different `pre` values at the start.
        let fixed_start = roots.map(|r| self.fixed_start.get(&r).copied());
        if matches!(fixed_start, [Some(p), Some(q)] if p != q) {
            return false;
        }
        let united = self.classes.union.unite(a.variable, b.variable, negative);
        let root = self.classes.union.find(a.variable).variable;
        self.with_input[root] = roots.iter().any(|r| self.with_input[*r]);
        self.in_semilinear[root] = roots.iter().any(|r| self.in_semilinear[*r]);
        if let Some(start) = fixed_start[0].or(fixed_start[1]) {
            self.fixed_start.insert(root, start);
        }
        united
    }

    /// Adds the value of `v = e` with a parameter expression `e`.
    fn add_constant(&mut self, e: &Equal) -> bool {
        let Some((v, value)) = self.constant(e) else { return false };
        let Signed { variable: root, negative } = self.classes.union.find(v);
        if self.with_input[root] || self.classes.value.contains_key(&root) {
            return false;
        }
        let value = if negative { self.graph.neg(value) } else { value };
        let value = self.graph.as_real(value);
        self.classes.value.insert(root, value);
        true
    }

    fn constant(&mut self, e: &Equal) -> Option<(VarId, ExprId)> {
        for (side, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
            let (v, negative) = match self.graph.node(side) {
                Node::Var(v) => (v, false),
                Node::Unary(Unary::Neg, a) => match self.graph.node(a) {
                    Node::Var(v) => (v, true),
                    _ => continue,
                },
                _ => continue,
            };
            let is_constant =
                self.variability.of(self.graph, self.variables, other) <= Variability::Parameter;
            // A String that never changes is a constant: the simulator does not store strings.
            let string = self.variables[v].ty == Type::String
                && self.variables[v].kind == VariableKind::Discrete
                && self.graph.as_const(other).is_some();
            if is_constant && (string || self.variables[v].kind == VariableKind::Algebraic) {
                return Some((v, if negative { self.graph.neg(other) } else { other }));
            }
        }
        // `v + p = 0` and the like.
        let [a, b] = two_terms(self.graph, e)?;
        let kind = |t: &Term| self.variables[t.variable].kind;
        let is_parameter =
            |t: &Term| matches!(kind(t), VariableKind::Parameter | VariableKind::InitialParameter);
        let (v, p) = if is_parameter(&b) { (a, b) } else { (b, a) };
        if v.differentiated
            || p.differentiated
            || kind(&v) != VariableKind::Algebraic
            || !is_parameter(&p)
        {
            return None;
        }
        let read = self.graph.var(p.variable, self.variables[p.variable].ty);
        let negative = v.negative == p.negative;
        Some((v.variable, if negative { self.graph.neg(read) } else { read }))
    }

    /// Adds the name of `v = der(s)`. A second name of a derivative is an alias of the first.
    fn add_derivative_name(&mut self, e: &Equal) -> bool {
        let Some([a, b]) = two_terms(self.graph, e) else { return false };
        let (v, s) = match (a.differentiated, b.differentiated) {
            (false, true) => (a, b),
            (true, false) => (b, a),
            _ => return false,
        };
        let is_algebraic = |t: &Term| self.variables[t.variable].kind == VariableKind::Algebraic;
        if !is_algebraic(&v) || !is_algebraic(&s) {
            return false;
        }
        let c = &mut self.classes;
        let (of_v, of_s) = (c.union.find(v.variable), c.union.find(s.variable));
        let (name, state) = (of_v.variable, of_s.variable);
        let is_known = |root: VarId| c.value.contains_key(&root) || self.with_input[root];
        let closes_cycle = self.chains.find(name).variable == self.chains.find(state).variable;
        if is_known(name) || is_known(state) || closes_cycle {
            return false;
        }
        let negative = (v.negative == s.negative) ^ of_v.negative ^ of_s.negative;
        if let Some(first) = c.derivative_name.get(&state).copied() {
            if c.derivative_name.contains_key(&name) || c.is_derivative_name.contains(&name) {
                return false;
            }
            c.union.attach(name, first.variable, negative ^ first.negative);
            return true;
        }
        if !c.is_derivative_name.insert(name) {
            return false;
        }
        c.derivative_name.insert(state, Signed { variable: name, negative });
        self.chains.unite(name, state, false);
        true
    }
}

/// `lhs - rhs`, if it is the sum of two terms of different variables.
fn two_terms(graph: &Graph, e: &Equal) -> Option<[Term; 2]> {
    terms(graph, e, 2, &mut |_| false)
}

/// Like [`two_terms`], for a sum of at most `max_terms` terms of which all others are 0.
fn terms(
    graph: &Graph,
    e: &Equal,
    max_terms: usize,
    is_zero: &mut impl FnMut(VarId) -> bool,
) -> Option<[Term; 2]> {
    let mut open = vec![(e.lhs, false), (e.rhs, true)];
    open.retain(|(side, _)| graph.as_number(*side) != Some(0.0));
    let mut found = Vec::with_capacity(2);
    while let Some((e, negative)) = open.pop() {
        if open.len() + found.len() >= max_terms {
            return None;
        }
        match graph.node(e) {
            Node::Var(variable) if is_zero(variable) => {}
            Node::Var(variable) => found.push(Term { variable, differentiated: false, negative }),
            Node::Der(variable) => found.push(Term { variable, differentiated: true, negative }),
            Node::Unary(Unary::Neg, a) => open.push((a, !negative)),
            Node::Binary(Binary::Add, a, b) => open.extend([(b, negative), (a, negative)]),
            Node::Binary(Binary::Sub, a, b) => open.extend([(b, !negative), (a, negative)]),
            _ => return None,
        }
    }
    let [a, b] = <[Term; 2]>::try_from(found).ok()?;
    let distinct = a.variable != b.variable || a.differentiated != b.differentiated;
    distinct.then_some([a, b])
}

/// Disjoint sets of variables that are equal up to sign (Tarjan 1975, with path compression).
pub struct SignedUnion {
    parent: IndexVec<VarId, Signed>,
    size: IndexVec<VarId, u32>,
}

impl SignedUnion {
    fn new(count: usize) -> Self {
        let single = |i| Signed { variable: VarId(i as u32), negative: false };
        SignedUnion { parent: (0..count).map(single).collect(), size: IndexVec::filled(1, count) }
    }

    /// The root of the class of `v`, and whether `v` is its negative.
    pub fn find(&mut self, v: VarId) -> Signed {
        let mut path = Vec::new();
        let mut at = v;
        while self.parent[at].variable != at {
            path.push(at);
            at = self.parent[at].variable;
        }
        let mut negative = false;
        for &member in path.iter().rev() {
            negative ^= self.parent[member].negative;
            self.parent[member] = Signed { variable: at, negative };
        }
        Signed { variable: at, negative }
    }

    /// Makes `a` equal to `b` or `-b`; false if they are already in one class.
    fn unite(&mut self, a: VarId, b: VarId, negative: bool) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a.variable == b.variable {
            return false;
        }
        let negative = negative ^ a.negative ^ b.negative;
        if self.size[a.variable] <= self.size[b.variable] {
            self.attach(a.variable, b.variable, negative);
        } else {
            self.attach(b.variable, a.variable, negative);
        }
        true
    }

    /// Attaches the class of one root to another root.
    fn attach(&mut self, root: VarId, under: VarId, negative: bool) {
        self.parent[root] = Signed { variable: under, negative };
        self.size[under] += self.size[root];
    }
}
