//! Search for variables that equal another one, or its negative, or a constant.
//!
//! `a = b`, `a = -b`, `a + b = 0` put variables into one class (union-find with signs); `v = der(s)`
//! makes v the name of a derivative; `v = e` with a parameter expression e gives v a value. What
//! stands for a class is chosen by [`super::representative`].

use super::Equal;
use super::variability::Variabilities;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::ir::dae::{Kind, Variable};
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::Variability;

/// Longer sums are not looked through for terms that are 0.
const LONGEST: usize = 8;

/// How often equations are looked at again because variables were found to be 0.
const ROUNDS: usize = 5;

/// A variable or its negative.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signed {
    /// The variable.
    pub variable: VarId,
    /// It is meant with the opposite sign.
    pub negative: bool,
}

/// What the search found. A class is known by its root.
pub struct Classes {
    /// Which variables are equal up to sign.
    pub union: SignedUnion,
    /// The value of the root of each constant class.
    pub value: FastMap<VarId, ExprId>,
    /// `der(root) = other root`, up to sign. Every root is at most once the name of a derivative,
    /// and following the names never leads back.
    pub named: FastMap<VarId, Signed>,
    /// Roots that are the name of a derivative.
    pub is_name: FastSet<VarId>,
}

/// Takes the equations that only say that variables are equal out of `equations`; the rest remains.
/// An equation that repeats what is known already remains too, to be counted as one too many.
pub fn search(
    graph: &mut Graph,
    variables: &IndexVec<VarId, Variable>,
    equations: Vec<Equal>,
) -> (Classes, Vec<Equal>) {
    let union = SignedUnion::new(variables.len());
    let mut search = Search {
        graph,
        variables,
        variability: Variabilities::default(),
        chains: SignedUnion::new(variables.len()),
        with_input: variables.iter().map(|v| v.kind == Kind::Input).collect(),
        flagged: IndexVec::filled(false, variables.len()),
        past: variables
            .enumerate()
            .filter(|(_, v)| v.kind == Kind::Discrete && v.fixed == Some(true))
            .filter_map(|(id, v)| Some((id, v.start?)))
            .collect(),
        classes: Classes {
            union,
            value: FastMap::default(),
            named: FastMap::default(),
            is_name: FastSet::default(),
        },
    };
    // Aliases first, so that the other two see whole classes; constants before names of
    // derivatives, because a constant is no name.
    let mut remaining = equations;
    remaining.retain(|e| !search.unite(e));
    remaining.retain(|e| !search.note_constant(e));
    // What is 0 may leave two terms where there were more. That matters where flows rest, see
    // `semilinear`; elsewhere a sum is no worse than a name.
    search.flags(&remaining);
    for _ in 0..ROUNDS {
        if !search.flagged.iter().any(|f| *f) {
            break;
        }
        let before = remaining.len();
        remaining.retain(|e| !search.unite(e));
        if remaining.len() == before {
            break;
        }
        remaining.retain(|e| !search.note_constant(e));
    }
    remaining.retain(|e| !search.note_name(e));
    (search.classes, remaining)
}

struct Search<'a> {
    graph: &'a mut Graph,
    variables: &'a IndexVec<VarId, Variable>,
    variability: Variabilities,
    /// Roots joined by names of derivatives: a name within one chain would close a circle.
    chains: SignedUnion,
    with_input: IndexVec<VarId, bool>,
    /// Classes with a variable that a `semiLinear` gives.
    flagged: IndexVec<VarId, bool>,
    /// The fixed starts of discrete classes, by root.
    past: FastMap<VarId, ExprId>,
    classes: Classes,
}

/// A term of a sum: `v` or `der(v)`.
#[derive(Clone, Copy)]
struct Term {
    variable: VarId,
    differentiated: bool,
    negative: bool,
}

impl Search<'_> {
    /// Notes which classes `semiLinear` gives a variable of.
    fn flags(&mut self, equations: &[Equal]) {
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
                    self.flagged[root] = true;
                }
            }
        }
    }

    /// `a = b` and the like, between variables of one kind.
    fn unite(&mut self, e: &Equal) -> bool {
        let (union, value) = (&mut self.classes.union, &self.classes.value);
        let graph = &*self.graph;
        let mut is_zero = |v: VarId| {
            let known = value.get(&union.find(v).variable);
            known.is_some_and(|e| graph.as_number(*e) == Some(0.0))
        };
        let Some([a, b]) = terms(graph, e, LONGEST, &mut is_zero) else { return false };
        let negative = a.negative == b.negative;
        let of_one_kind = |x: &Variable, y: &Variable| match (x.kind, y.kind) {
            (Kind::Algebraic | Kind::Input, Kind::Algebraic | Kind::Input) => x.ty == Type::Real,
            (Kind::Discrete, Kind::Discrete) => x.ty == y.ty && !negative,
            _ => false,
        };
        let (x, y) = (&self.variables[a.variable], &self.variables[b.variable]);
        if a.differentiated || b.differentiated || x.ty != y.ty || !of_one_kind(x, y) {
            return false;
        }
        let roots = [a, b].map(|t| self.classes.union.find(t.variable).variable);
        let longer = two_terms(self.graph, e).is_none();
        if longer && !roots.iter().any(|r| self.flagged[*r]) {
            return false;
        }
        let has_value = |r: &VarId| self.classes.value.contains_key(r);
        if roots.iter().all(|r| self.with_input[*r]) || roots.iter().any(has_value) {
            return false;
        }
        // What two discrete variables were before the start may differ though they are equal.
        let past = roots.map(|r| self.past.get(&r).copied());
        if matches!(past, [Some(p), Some(q)] if p != q) {
            return false;
        }
        let united = self.classes.union.unite(a.variable, b.variable, negative);
        let root = self.classes.union.find(a.variable).variable;
        self.with_input[root] = roots.iter().any(|r| self.with_input[*r]);
        self.flagged[root] = roots.iter().any(|r| self.flagged[*r]);
        if let Some(start) = past[0].or(past[1]) {
            self.past.insert(root, start);
        }
        united
    }

    /// `v = e` with a parameter expression `e`.
    fn note_constant(&mut self, e: &Equal) -> bool {
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
            // Texts have no place in a running program: one that never changes is known here.
            let text = self.variables[v].ty == Type::String
                && self.variables[v].kind == Kind::Discrete
                && self.graph.as_const(other).is_some();
            if is_constant && (text || self.variables[v].kind == Kind::Algebraic) {
                return Some((v, if negative { self.graph.neg(other) } else { other }));
            }
        }
        // `v + p = 0` and the like.
        let [a, b] = two_terms(self.graph, e)?;
        let kind = |t: &Term| self.variables[t.variable].kind;
        let is_parameter = |t: &Term| matches!(kind(t), Kind::Parameter | Kind::InitialParameter);
        let (v, p) = if is_parameter(&b) { (a, b) } else { (b, a) };
        if v.differentiated || p.differentiated || kind(&v) != Kind::Algebraic || !is_parameter(&p)
        {
            return None;
        }
        let read = self.graph.var(p.variable, self.variables[p.variable].ty);
        let negative = v.negative == p.negative;
        Some((v.variable, if negative { self.graph.neg(read) } else { read }))
    }

    /// `v = der(s)`. A second name of one derivative is an alias of the first.
    fn note_name(&mut self, e: &Equal) -> bool {
        let Some([a, b]) = two_terms(self.graph, e) else { return false };
        let (v, s) = match (a.differentiated, b.differentiated) {
            (false, true) => (a, b),
            (true, false) => (b, a),
            _ => return false,
        };
        let is_algebraic = |t: &Term| self.variables[t.variable].kind == Kind::Algebraic;
        if !is_algebraic(&v) || !is_algebraic(&s) {
            return false;
        }
        let c = &mut self.classes;
        let (of_v, of_s) = (c.union.find(v.variable), c.union.find(s.variable));
        let (name, state) = (of_v.variable, of_s.variable);
        let is_known = |root: VarId| c.value.contains_key(&root) || self.with_input[root];
        let closes_circle = self.chains.find(name).variable == self.chains.find(state).variable;
        if is_known(name) || is_known(state) || closes_circle {
            return false;
        }
        let negative = (v.negative == s.negative) ^ of_v.negative ^ of_s.negative;
        if let Some(first) = c.named.get(&state).copied() {
            if c.named.contains_key(&name) || c.is_name.contains(&name) {
                return false;
            }
            c.union.attach(name, first.variable, negative ^ first.negative);
            return true;
        }
        if !c.is_name.insert(name) {
            return false;
        }
        c.named.insert(state, Signed { variable: name, negative });
        self.chains.unite(name, state, false);
        true
    }
}

/// `lhs - rhs`, if it is the sum of two terms of different variables.
fn two_terms(graph: &Graph, e: &Equal) -> Option<[Term; 2]> {
    terms(graph, e, 2, &mut |_| false)
}

/// As [`two_terms`], of at most so many terms of which all others are 0.
fn terms(
    graph: &Graph,
    e: &Equal,
    most: usize,
    is_zero: &mut impl FnMut(VarId) -> bool,
) -> Option<[Term; 2]> {
    let mut open = vec![(e.lhs, false), (e.rhs, true)];
    open.retain(|(side, _)| graph.as_number(*side) != Some(0.0));
    let mut found = Vec::with_capacity(2);
    while let Some((e, negative)) = open.pop() {
        if open.len() + found.len() >= most {
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

    /// Makes `a` equal `b`, or `-b`; false if they were in one class already.
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

    /// Puts the class of one root under another root.
    fn attach(&mut self, root: VarId, under: VarId, negative: bool) {
        self.parent[root] = Signed { variable: under, negative };
        self.size[under] += self.size[root];
    }
}
