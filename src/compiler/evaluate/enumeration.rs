//! Enumeration values by number: `E(i)` (section 3.7.1 of the specification).

use super::Evaluator;
use super::cause::call::{CallCause, Takes};
use super::cause::types::Expected;
use super::value::Value;
use crate::base::source::Span;
use crate::ir::ast::Ident;
use crate::ir::expr::{Binary, Const, EnumId, ExprId, Type};
use crate::ir::flat::AssertionLevel;

impl Evaluator<'_> {
    /// The values of an enumeration with these numbers, which begin with 1. A number that none has is an
    /// error, here or when the model runs.
    pub(super) fn literal_of_ordinal(
        &mut self,
        id: EnumId,
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Value> {
        let ([numbers], []) = (args.as_slice(), named.as_slice()) else {
            let function = self.graph.enumerations[id].name.to_string();
            let takes = Takes::These("the number of a value");
            self.report(CallCause::WrongArguments { function, takes }, span);
            return None;
        };
        numbers.map(|number| match number.scalar() {
            Some(e) if self.graph.ty(e) == Type::Integer => {
                self.literal_of(id, e, span).map(Value::Scalar)
            }
            _ => {
                self.report_type(Expected::Integer, number, span);
                None
            }
        })
    }

    fn literal_of(&mut self, id: EnumId, number: ExprId, span: Span) -> Option<ExprId> {
        let name = self.graph.enumerations[id].name.to_string();
        let count = self.graph.enumerations[id].literals.len();
        let literal = |k: usize| Const::Enumeration(id, k as u32);
        if let Some(Const::Integer(k)) = self.graph.as_const(number)
            && let Some(k) = usize::try_from(k).ok().filter(|k| (1..=count).contains(k))
        {
            return Some(self.graph.constant(literal(k)));
        }
        let [first, last] = [1, count].map(|k| self.graph.integer(k as i64));
        let not_below = self.graph.binary(Binary::GreaterEqual, number, first);
        let not_above = self.graph.binary(Binary::LessEqual, number, last);
        let exists = self.graph.and(not_below, not_above);
        let message = format!("`{name}` has values number 1 to {count}, and no other");
        let message = self.graph.string(&message);
        self.assert_now_or_later(exists, message, AssertionLevel::Error, span)?;
        let mut value = self.graph.constant(literal(count));
        for k in (1..count).rev() {
            let (this, k) = (self.graph.constant(literal(k)), self.graph.integer(k as i64));
            let is_it = self.graph.binary(Binary::Equal, number, k);
            value = self.graph.if_then_else(is_it, this, value);
        }
        Some(value)
    }
}
