//! Event-triggering functions: `floor`, `ceil`, `integer`, `div`, `mod`, `rem` of continuous
//! operands (Modelica 3.6, section 3.7.2). Between events they are constant or continuous, so the
//! rounded value becomes a discrete variable, and relations detect when its argument leaves the
//! valid interval.

use super::rewriting::Rewriting;
use crate::ir::builtin::Rounding;
use crate::ir::dae::{DiscreteEquation, ROUNDED, Variable, VariableKind};
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::Origin;

impl Rewriting<'_> {
    /// A rounded quotient with events.
    pub(super) fn quotient(
        &mut self,
        a: ExprId,
        b: ExprId,
        rounding: Rounding,
        origin: &Origin,
    ) -> ExprId {
        let quotient = self.graph.div(a, b);
        self.rounded_variable(quotient, rounding, Type::Real, origin)
    }

    /// The remainder of a rounded quotient, with events.
    pub(super) fn remainder(
        &mut self,
        a: ExprId,
        b: ExprId,
        rounding: Rounding,
        origin: &Origin,
    ) -> ExprId {
        let whole = self.quotient(a, b, rounding, origin);
        // A product with a literal 0 would hide that there is no quotient.
        let part = match self.graph.as_number(b) {
            Some(0.0) => self.graph.intern(Node::Binary(Binary::Mul, whole, b), Type::Real),
            _ => self.graph.mul(whole, b),
        };
        self.graph.sub(a, part)
    }

    /// A discrete variable that holds the rounded value of `a`.
    pub(super) fn rounded_variable(
        &mut self,
        a: ExprId,
        rounding: Rounding,
        ty: Type,
        origin: &Origin,
    ) -> ExprId {
        if let Some(known) = self.jump_ids.get(&(a, rounding, ty)) {
            return self.graph.var(*known, ty);
        }
        let name = format!("{ROUNDED}{}", self.jumps.len() + 1);
        let new = Variable::new(name, ty, VariableKind::Discrete, origin.span);
        let variable = self.variables.push(Variable { hidden: true, ..new });
        self.jump_ids.insert((a, rounding, ty), variable);
        let value = match rounding {
            Rounding::Down if ty == Type::Integer => self.graph.unary(Unary::ToInteger, a),
            Rounding::Down => self.graph.unary(Unary::Floor, a),
            Rounding::Up => self.graph.unary(Unary::Ceil, a),
            Rounding::ToZero => {
                let one = self.graph.real(1.0);
                self.graph.binary(Binary::Quotient, a, one)
            }
        };
        let value = match self.instant_of_equality(a).is_some() {
            true => self.value_after_instants(a, value, variable, rounding, ty, origin),
            false => {
                let h = self.graph.var(variable, ty);
                self.bound_relations(a, h, rounding, origin);
                value
            }
        };
        self.jumps.push(DiscreteEquation { variable, value, origin: origin.clone() });
        self.graph.var(variable, ty)
    }

    /// The rounded value of an argument that runs with time. At the instant at which it arrives at a
    /// bound it is already the value behind it, as a comparison with time is (`ceil(time)` is 1 from the
    /// event at 0 on), and rounding errors at the instant do not matter: the value changes exactly if a
    /// bound was passed.
    fn value_after_instants(
        &mut self,
        a: ExprId,
        rounded: ExprId,
        h: VarId,
        rounding: Rounding,
        ty: Type,
        origin: &Origin,
    ) -> ExprId {
        let before = self.graph.pre(h, ty);
        let bounds = self.bound_relations(a, before, rounding, origin);
        let one = match ty {
            Type::Integer => self.graph.integer(1),
            _ => self.graph.real(1.0),
        };
        let (above, below) = (self.graph.add(before, one), self.graph.sub(before, one));
        let above = self.graph.binary(Binary::Max, rounded, above);
        let below = self.graph.binary(Binary::Min, rounded, below);
        let mut value = before;
        for (op, passed) in bounds {
            let rises = matches!(op, Binary::Greater | Binary::GreaterEqual);
            value = self.graph.if_then_else(passed, if rises { above } else { below }, value);
        }
        let initial = self.graph.intern(Node::Initial, Type::Boolean);
        self.graph.if_then_else(initial, rounded, value)
    }

    /// The relations that become true when the rounded value `h` must change. Rounding down is
    /// valid for `h <= a < h + 1`, up for `h - 1 < a <= h`, and towards zero like down above zero
    /// and like up below; a bound that does not apply is set to an unreachable value.
    fn bound_relations(
        &mut self,
        a: ExprId,
        h: ExprId,
        rounding: Rounding,
        origin: &Origin,
    ) -> Vec<(Binary, ExprId)> {
        let one = self.graph.real(1.0);
        let (above, below) = (self.graph.add(h, one), self.graph.sub(h, one));
        let bounds = match rounding {
            Rounding::Down => {
                vec![(Binary::GreaterEqual, above), (Binary::Less, h)]
            }
            Rounding::Up => vec![(Binary::Greater, h), (Binary::LessEqual, below)],
            Rounding::ToZero => {
                let mut bound = |op: Binary, applies: Binary, bound: ExprId, far: f64| {
                    let (zero, far) = (self.graph.real(0.0), self.graph.real(far));
                    let c = self.graph.binary(applies, h, zero);
                    (op, self.graph.if_then_else(c, bound, far))
                };
                vec![
                    bound(Binary::GreaterEqual, Binary::GreaterEqual, above, 1e300),
                    bound(Binary::Less, Binary::Greater, h, -1e300),
                    bound(Binary::LessEqual, Binary::LessEqual, below, -1e300),
                    bound(Binary::Greater, Binary::Less, h, 1e300),
                ]
            }
        };
        let relation = |(op, bound)| {
            let literal = self.graph.binary(op, a, bound);
            (op, self.relation(op, a, bound, literal, origin))
        };
        bounds.into_iter().map(relation).collect()
    }
}
