//! How fast values change, and which are known before the model runs (section 3.8 of the specification).

use super::Evaluator;
use super::cause::types::TypeCause;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::ir::ast::Variability;
use crate::ir::expr::{Binary, Const, ExprId, Node, Type, Unary, VarId};
use crate::ir::instance::InstanceKind;
impl Evaluator<'_> {
    /// The variability of an expression: the fastest of its operands.
    pub fn variability(&self, e: ExprId) -> Variability {
        let mut most = Variability::Constant;
        for n in self.graph.postorder([e]) {
            let v = match self.graph.node(n) {
                Node::Var(v) => self.variable_variability(v),
                Node::Time | Node::Der(_) | Node::Recorded(..) => Variability::Continuous,
                Node::Pre(_)
                | Node::Initial
                | Node::Terminal
                | Node::Sample(..)
                | Node::Clocked(..) => Variability::Discrete,
                _ => Variability::Constant,
            };
            most = most.max(v);
        }
        most
    }

    /// Whether a value may change between events: relations and rounding functions change at events
    /// only, except inside functions (section 3.8.3). `noEvent` is the user's responsibility.
    pub fn changes_between_events(&self, e: ExprId) -> bool {
        let mut moving: FastMap<ExprId, bool> = FastMap::default();
        for n in self.graph.postorder([e]) {
            let mut moves = false;
            self.graph.for_each_operand(n, |a| moves |= moving[&a]);
            let moves = match self.graph.node(n) {
                Node::Clocked(..) | Node::Sample(..) => false,
                _ if self.events.moving_results.contains(&n) => true,
                Node::Var(v) => self.variable_variability(v) == Variability::Continuous,
                Node::Time | Node::Der(_) | Node::Recorded(..) => true,
                Node::Unary(op, _)
                    if op != Unary::Ordinal && op.shape().is_piecewise_constant() =>
                {
                    false
                }
                Node::Binary(op, ..) if op.is_relation() || op.shape().is_piecewise_constant() => {
                    false
                }
                _ => moves,
            };
            moving.insert(n, moves);
        }
        moving[&e]
    }

    /// Whether a value of discrete type may change though no event shows it (section 3.8.4): as
    /// [`Evaluator::changes_between_events`], or because `noEvent`, a function or `sign` hides where it changes. What is
    /// read only where a relation with events holds may be hidden.
    pub fn changes_unseen(&mut self, e: ExprId) -> bool {
        self.note_behaviours();
        self.changes_between_events(e) || self.is_hidden(e)
    }

    fn is_hidden(&self, e: ExprId) -> bool {
        match self.graph.node(e) {
            Node::Unary(Unary::Not, a) => self.is_hidden(a),
            Node::Binary(Binary::And | Binary::Or, a, b) => self.is_hidden(a) && self.is_hidden(b),
            Node::If(c, a, b) => self.is_hidden(c) || self.is_hidden(a) && self.is_hidden(b),
            _ => self.moves(e),
        }
    }

    /// Reports a value that changes unseen for a variable of this type, unless it is one that may change at any time.
    pub(crate) fn check_seen(&mut self, ty: Type, value: ExprId, span: Span) -> Option<()> {
        let is_discrete = !matches!(ty, Type::Real | Type::String | Type::Clock);
        if is_discrete && self.changes_unseen(value) {
            self.report_continuous(ty, span);
            return None;
        }
        Some(())
    }

    /// Reports a value that changes between events for a variable that does not.
    pub(crate) fn report_continuous(&mut self, ty: Type, span: Span) {
        let of = crate::symbolic::print::type_name(&self.graph, ty);
        self.report(TypeCause::ContinuousValue { of }, span);
    }

    pub(super) fn variable_variability(&self, v: VarId) -> Variability {
        let Some((id, _)) = self.instance_of.get(v.0 as usize) else {
            return self.synthetic_variability(v);
        };
        let instance = &self.instances[*id];
        let discrete_type =
            matches!(&instance.kind, InstanceKind::Variable { ty, .. } if *ty != Type::Real);
        match instance.prefix.variability {
            Some(v) => v,
            None if discrete_type => Variability::Discrete,
            None => Variability::Continuous,
        }
    }

    /// The value of an expression that reads parameters of discrete type only (Booleans, Integers,
    /// enumerations): such parameters fix the structure, as conditions of components do.
    pub(crate) fn structural_value(&mut self, e: ExprId) -> Option<Const> {
        self.parameter_expression(e, false)
    }

    /// The value of an expression that reads parameters only; `reals` says whether Real ones count.
    pub(crate) fn parameter_expression(&mut self, e: ExprId, reals: bool) -> Option<Const> {
        if let Some(c) = self.graph.as_const(e) {
            return Some(c);
        }
        // Most unknown expressions show it at their first leaf.
        if !self.may_be_known(self.first_leaf(e), reals) {
            return None;
        }
        let order = self.graph.postorder([e]);
        if !order.iter().all(|n| self.may_be_known(*n, reals)) {
            return None;
        }
        let mut values: FastMap<VarId, ExprId> = FastMap::default();
        for &n in &order {
            if let Node::Var(v) = self.graph.node(n) {
                let (id, k) = self.instance_of[v.0 as usize];
                if !self.bound(id) {
                    return None;
                }
                let span = self.declared_at(id);
                let value = self.parameter_value(id, span)?;
                values.insert(v, value.elements().get(k)?.scalar()?);
            }
        }
        let mut rewriter = crate::symbolic::rewrite::Rewriter::new();
        let folded = rewriter.apply(&mut self.graph, e, &mut |g, n| match g.node(n) {
            Node::Var(v) => values.get(&v).copied(),
            _ => None,
        });
        self.graph.as_const(folded)
    }

    /// The leaf of an expression that first operands lead to, literals excluded.
    pub(super) fn first_leaf(&self, mut e: ExprId) -> ExprId {
        loop {
            let mut next = None;
            self.graph.for_each_operand(e, |a| {
                if next.is_none() && self.graph.as_const(a).is_none() {
                    next = Some(a);
                }
            });
            match next {
                Some(operand) => e = operand,
                None => return e,
            }
        }
    }

    /// False for a node known only at run time; `reals` says whether Real parameters are known.
    pub(super) fn may_be_known(&self, n: ExprId, reals: bool) -> bool {
        match self.graph.node(n) {
            Node::Var(v) => {
                let Some(&(id, _)) = self.instance_of.get(v.0 as usize) else {
                    return false;
                };
                let kind = &self.instances[id].kind;
                let real = matches!(kind, InstanceKind::Variable { ty: Type::Real, .. });
                (reals || !real) && self.variable_variability(v) <= Variability::Parameter
            }
            Node::Time
            | Node::Der(_)
            | Node::Pre(_)
            | Node::Initial
            | Node::Terminal
            | Node::Sample(..)
            | Node::Clocked(..)
            | Node::Call { .. }
            | Node::Recorded(..)
            | Node::Relation(_) => false,
            _ => true,
        }
    }
}
