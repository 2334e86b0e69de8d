//! Rewrites the expressions of the flat model: replaces eliminated variables, turns derivatives
//! into variables and `sample` into flags, numbers relations, and removes `noEvent` and `smooth`.

use super::alias::Signed;
use super::error;
use super::representative::Replacement;
use super::variability::Variabilities;
use crate::base::diag::Problems;
use crate::base::index::{FastMap, IndexVec};
use crate::base::source::Span;
use crate::ir::builtin::{Rounding, Shape};
use crate::ir::dae::{DiscreteEquation, Relation, Sample, Trigger, Variable, VariableKind};
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{Origin, Variability};
use crate::symbolic::gradient::Leaf;
use crate::symbolic::linear;

/// Whether relations generate events.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum RelationMode {
    /// They do: in equations and in the conditions of when-clauses.
    Events,
    /// They remain operators: below `noEvent` and `smooth`, in expressions that are only evaluated
    /// at events (bodies of when-clauses, initial equations), in assertions, and in attributes.
    Literal,
}

/// The relations and clocks that the rewriting has collected.
pub struct EventSources {
    /// Numbered relations.
    pub relations: Vec<Relation>,
    /// Clocks.
    pub samples: Vec<Sample>,
}

/// A rewriting of all expressions of a model; each node is rewritten once per mode.
pub struct Rewriting<'a> {
    /// All expressions.
    pub graph: &'a mut Graph,
    /// All variables.
    pub variables: &'a mut IndexVec<VarId, Variable>,
    /// Errors of the model.
    pub problems: &'a mut Problems,
    replacement: IndexVec<VarId, Replacement>,
    variability: Variabilities,
    done: FastMap<(ExprId, RelationMode), ExprId>,
    relations: Vec<Relation>,
    /// The number of each relation, by its form `a < b`, and whether the stored one is its
    /// negation.
    relation_ids: FastMap<(ExprId, ExprId), (u32, bool)>,
    samples: Vec<Sample>,
    sample_ids: FastMap<(ExprId, ExprId), VarId>,
    /// Equations of the rounded values in event-triggering functions, see [`super::discontinuous`].
    pub(super) jumps: Vec<DiscreteEquation>,
    pub(super) jump_ids: FastMap<(ExprId, Rounding, Type), VarId>,
}

impl<'a> Rewriting<'a> {
    /// A rewriting that has not processed any expression.
    pub fn new(
        graph: &'a mut Graph,
        variables: &'a mut IndexVec<VarId, Variable>,
        replacement: IndexVec<VarId, Replacement>,
        problems: &'a mut Problems,
    ) -> Self {
        Rewriting {
            graph,
            variables,
            problems,
            replacement,
            variability: Variabilities::default(),
            done: FastMap::default(),
            relations: Vec::new(),
            relation_ids: FastMap::default(),
            samples: Vec::new(),
            sample_ids: FastMap::default(),
            jumps: Vec::new(),
            jump_ids: FastMap::default(),
        }
    }

    /// The relations and clocks.
    pub fn finish(self) -> EventSources {
        EventSources { relations: self.relations, samples: self.samples }
    }

    /// The Boolean variables of the clocks found so far.
    pub fn sample_flags(&self) -> impl Iterator<Item = VarId> {
        self.samples.iter().map(|s| s.flag)
    }

    /// The variability of a rewritten expression.
    pub fn variability(&mut self, e: ExprId) -> Variability {
        self.variability.of(self.graph, self.variables, e)
    }

    /// The variable that represents `v`; `None` if it has been replaced by a value.
    pub fn representative(&self, v: VarId) -> Option<Signed> {
        match self.replacement.get(v) {
            Some(Replacement::Alias(s)) => Some(*s),
            Some(Replacement::Value(_)) => None,
            _ => Some(Signed { variable: v, negative: false }),
        }
    }

    /// True if the variable is 0 for all values of the parameters.
    pub fn is_zero(&self, v: VarId) -> bool {
        let value = match self.replacement.get(v) {
            Some(Replacement::Value(value)) => Some(*value),
            Some(Replacement::Alias(s)) => match self.replacement.get(s.variable) {
                Some(Replacement::Value(value)) => Some(*value),
                _ => None,
            },
            _ => None,
        };
        value.is_some_and(|e| self.graph.as_number(e) == Some(0.0))
    }

    /// Adds a discrete Boolean that is hidden from the user.
    pub fn add_flag(&mut self, name: String, span: Span) -> VarId {
        let flag = Variable::new(name, Type::Boolean, VariableKind::Discrete, span);
        self.variables.push(Variable { hidden: true, ..flag })
    }

    /// Rewrites the attributes of all variables.
    pub fn attributes(&mut self) {
        for id in self.variables.ids() {
            let origin = Origin { span: self.variables[id].span, component: "".into() };
            let v = &self.variables[id];
            let [start, min, max, nominal] = [v.start, v.min, v.max, v.nominal]
                .map(|e| e.map(|e| self.apply(e, RelationMode::Literal, &origin)));
            let is_real = self.variables[id].ty == Type::Real;
            let [start, min, max, nominal] = [start, min, max, nominal]
                .map(|e| e.map(|e| if is_real { self.graph.as_real(e) } else { e }));
            let v = &mut self.variables[id];
            (v.start, v.min, v.max, v.nominal) = (start, min, max, nominal);
        }
    }

    /// The eliminated variables with the expressions that they equal.
    pub fn eliminated(&mut self) -> Vec<(VarId, ExprId)> {
        let mut list = Vec::new();
        for v in self.variables.ids() {
            let value = match self.replacement.get(v) {
                None | Some(Replacement::Kept) => continue,
                Some(Replacement::Alias(s)) => self.read(*s),
                Some(Replacement::Value(e)) => {
                    let origin = Origin { span: self.variables[v].span, component: "".into() };
                    self.apply(*e, RelationMode::Literal, &origin)
                }
            };
            list.push((v, value));
        }
        list
    }

    /// Rewrites `root` iteratively; results are shared by all calls.
    pub fn apply(&mut self, root: ExprId, mode: RelationMode, origin: &Origin) -> ExprId {
        let mut stack = vec![(root, mode, false)];
        let mut operands = Vec::new();
        while let Some((e, mode, ready)) = stack.pop() {
            if self.done.contains_key(&(e, mode)) {
                continue;
            }
            let below = match self.graph.node(e) {
                Node::NoEvent(_) | Node::Smooth(..) => RelationMode::Literal,
                _ => mode,
            };
            if !ready {
                if let Some(new) = self.leaf(e, origin) {
                    // The value of a constant may contain `noEvent` or `smooth` itself.
                    if new != e && matches!(self.replaced(e), Some(Replacement::Value(_))) {
                        if let Some(&value) = self.done.get(&(new, RelationMode::Literal)) {
                            self.done.insert((e, mode), value);
                        } else {
                            stack.push((e, mode, false));
                            stack.push((new, RelationMode::Literal, false));
                        }
                    } else {
                        self.done.insert((e, mode), new);
                    }
                    continue;
                }
                stack.push((e, mode, true));
                self.graph.for_each_operand(e, |a| stack.push((a, below, false)));
                continue;
            }
            operands.clear();
            self.graph.for_each_operand(e, |a| operands.push(self.done[&(a, below)]));
            let new = self.node(e, &operands, mode, origin);
            self.done.insert((e, mode), new);
        }
        self.done[&(root, mode)]
    }

    fn replaced(&self, e: ExprId) -> Option<Replacement> {
        match self.graph.node(e) {
            Node::Var(v) | Node::Pre(v) => self.replacement.get(v).copied(),
            _ => None,
        }
    }

    /// The replacement of a leaf; `None` for a node with operands.
    fn leaf(&mut self, e: ExprId, origin: &Origin) -> Option<ExprId> {
        match self.graph.node(e) {
            Node::Const(_)
            | Node::Time
            | Node::Initial
            | Node::Terminal
            | Node::Relation(_)
            | Node::Recorded(..) => Some(e),
            Node::Var(v) => Some(match self.replacement.get(v) {
                Some(Replacement::Alias(s)) => self.read(*s),
                Some(Replacement::Value(value)) => *value,
                _ => e,
            }),
            Node::Pre(v) => Some(match self.replacement.get(v) {
                Some(Replacement::Alias(s)) => {
                    let s = *s;
                    let pre = self.graph.pre(s.variable, self.variables[s.variable].ty);
                    if s.negative { self.graph.neg(pre) } else { pre }
                }
                Some(Replacement::Value(value)) => *value,
                _ => e,
            }),
            Node::Der(v) => Some(self.rate(v, origin)),
            _ => None,
        }
    }

    /// `der(v)` as a variable; zero for variables that do not change between events.
    fn rate(&mut self, v: VarId, origin: &Origin) -> ExprId {
        if let Some(s) = self.representative(v) {
            match self.variables[s.variable].kind {
                VariableKind::Differentiated { derivative } => {
                    return self.read(Signed { variable: derivative, negative: s.negative });
                }
                VariableKind::Discrete => {
                    let declared = &self.variables[v];
                    self.problems.push(error::rate_of_discrete(declared, origin));
                }
                _ => {}
            }
        }
        self.graph.real(0.0)
    }

    fn read(&mut self, s: Signed) -> ExprId {
        let e = self.graph.var(s.variable, self.variables[s.variable].ty);
        if s.negative { self.graph.neg(e) } else { e }
    }

    fn node(
        &mut self,
        e: ExprId,
        operands: &[ExprId],
        mode: RelationMode,
        origin: &Origin,
    ) -> ExprId {
        match (self.graph.node(e), operands) {
            (Node::NoEvent(_) | Node::Smooth(..), &[a]) => return a,
            // Initialization first tries the actual system directly.
            (Node::Homotopy(..), &[actual, _]) => return actual,
            (Node::Sample(..), &[start, interval]) => return self.sample(start, interval, origin),
            _ => {}
        }
        let new = self.graph.rebuild(e, operands);
        if mode == RelationMode::Literal || self.variability(new) < Variability::Continuous {
            return new;
        }
        match self.graph.node(new) {
            Node::Binary(op, a, b) if op.is_relation() => self.relation(op, a, b, new, origin),
            Node::Binary(op, a, b) => match op.shape() {
                Shape::Rounds(rounding) => self.quotient(a, b, rounding, origin),
                Shape::Remainder(rounding) => self.remainder(a, b, rounding, origin),
                _ => new,
            },
            Node::Unary(op, a) => match op.shape() {
                Shape::Rounds(rounding) => {
                    self.rounded_variable(a, rounding, self.graph.ty(new), origin)
                }
                _ => new,
            },
            _ => new,
        }
    }

    /// Assigns a number to `a op b`. A relation and its negation share one number.
    pub(super) fn relation(
        &mut self,
        op: Binary,
        a: ExprId,
        b: ExprId,
        e: ExprId,
        origin: &Origin,
    ) -> ExprId {
        let (key, negated) = match op {
            Binary::Less => ((a, b), false),
            Binary::GreaterEqual => ((a, b), true),
            Binary::Greater => ((b, a), false),
            Binary::LessEqual => ((b, a), true),
            _ => {
                let are_reals = [a, b].iter().any(|e| self.graph.ty(*e) == Type::Real);
                let problem = error::equality_between_events(op.name(), are_reals, origin);
                self.problems.push(problem);
                return e;
            }
        };
        let (number, stored_negated) = match self.relation_ids.get(&key) {
            Some(&found) => found,
            None => {
                let number = self.relations.len() as u32;
                let trigger = self.trigger(a, b);
                let origin = origin.clone();
                self.relations.push(Relation { op, lhs: a, rhs: b, trigger, origin });
                self.relation_ids.insert(key, (number, negated));
                (number, negated)
            }
        };
        let read = self.graph.intern(Node::Relation(number), Type::Boolean);
        if negated == stored_negated { read } else { self.graph.not(read) }
    }

    fn trigger(&mut self, a: ExprId, b: ExprId) -> Trigger {
        let difference = self.graph.sub(a, b);
        match self.instant_of_equality(difference) {
            Some(instant) => Trigger::Time { instant },
            None => Trigger::State,
        }
    }

    /// When an expression is zero that is time, or minus time, except for what is constant between
    /// events.
    pub(super) fn instant_of_equality(&mut self, difference: ExprId) -> Option<ExprId> {
        let (coefficient, rest) = linear::split(self.graph, difference, Leaf::Time)?;
        if self.variability(rest) > Variability::Discrete {
            return None;
        }
        match self.graph.as_number(coefficient)? {
            1.0 => Some(self.graph.neg(rest)),
            -1.0 => Some(rest),
            _ => None,
        }
    }

    fn sample(&mut self, start: ExprId, interval: ExprId, origin: &Origin) -> ExprId {
        let flag = match self.sample_ids.get(&(start, interval)) {
            Some(&flag) => flag,
            None => {
                if self.variability(start).max(self.variability(interval)) > Variability::Parameter
                {
                    self.problems.push(error::varying_sample(origin));
                }
                let flag = self.add_flag(format!("$sample{}", self.samples.len() + 1), origin.span);
                self.samples.push(Sample { start, interval, flag });
                self.sample_ids.insert((start, interval), flag);
                flag
            }
        };
        self.graph.var(flag, Type::Boolean)
    }
}
