//! `String(...)`: conversion of values (section 3.7.2 of the specification).

use super::Evaluator;
use super::cause::builtin::BuiltinCause;
use super::value::Value;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{Expr, Ident};
use crate::ir::expr::{Binary, Const, ExprId, Form, Type, Unary};
use crate::ir::instance::Scope;

impl Evaluator<'_> {
    /// `String(record, ...)` of an operator record.
    fn overloaded_string(
        &mut self,
        value: Value,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let mut operands = vec![value];
        operands.extend(self.evaluate_all(&args[1..], scope)?);
        if let Some((name, _)) = named.first() {
            self.unsupported(name.span, Construct::NamedStringArguments);
            return None;
        }
        self.overloaded("'String'", &operands, span)
    }

    /// The strings of values, which may be known only at run time.
    pub(super) fn string_call(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let Some(first) = args.first() else {
            self.wrong_arguments(span, "one argument");
            return None;
        };
        let value = self.evaluate(first, scope)?;
        if self.is_overloaded(&value) {
            return self.overloaded_string(value, args, named, span, scope);
        }
        let mut given: FastMap<&str, Const> = FastMap::default();
        for (name, e) in named {
            let value = self.fold(e, scope)?.scalar().and_then(|e| self.graph.as_const(e));
            given.insert(name.name.as_str(), value?);
        }
        let number = |name: &str, otherwise: usize| match given.get(name) {
            Some(Const::Integer(n)) => usize::try_from(*n).map_or(0, |n| n.min(1000)),
            _ => otherwise,
        };
        let left = given.get("leftJustified") != Some(&Const::Boolean(false));
        let e = self.scalar_of(value, first.span)?;
        let format = match given.get("format") {
            Some(Const::String(format)) => {
                if crate::external::printf::formatted(0.0, format).is_none() {
                    let format = format.to_string();
                    self.report(BuiltinCause::NumberFormat { format }, span);
                    return None;
                }
                Some(format.as_str())
            }
            _ => None,
        };
        let form = Form {
            digits: number("significantDigits", usize::from(Form::default().digits)) as u16,
            width: number("minimumLength", 0) as u16,
            left,
            format,
        };
        if let Some(chosen) = self.text_of_choice(e, form) {
            return Some(Value::Scalar(chosen));
        }
        // A Real is written as such, also if its value is an Integer.
        let real = self.graph.ty(e) == Type::Real;
        let e = match self.graph.as_const(e) {
            Some(Const::Integer(i)) if real => self.graph.real(i as f64),
            _ => e,
        };
        let form = self.graph.add_form(form);
        Some(Value::Scalar(self.graph.unary(Unary::Text(form), e)))
    }

    /// The string of a Boolean or of an enumeration value known only at run time.
    fn text_of_choice(&mut self, e: ExprId, form: Form) -> Option<ExprId> {
        if self.graph.as_const(e).is_some() {
            return None;
        }
        match self.graph.ty(e) {
            Type::Boolean => {
                let [yes, no] =
                    ["true", "false"].map(|t| self.graph.string(&form.padded(t.to_string())));
                Some(self.graph.if_then_else(e, yes, no))
            }
            Type::Enumeration(t) => {
                let literals = self.graph.enumerations[t].literals.clone();
                let (last, firsts) = literals.split_last()?;
                let mut text = self.graph.string(&form.padded(last.to_string()));
                for (k, literal) in firsts.iter().enumerate().rev() {
                    let value = self.graph.constant(Const::Enumeration(t, k as u32 + 1));
                    let is_it = self.graph.binary(Binary::Equal, e, value);
                    let this = self.graph.string(&form.padded(literal.to_string()));
                    text = self.graph.if_then_else(is_it, this, text);
                }
                Some(text)
            }
            _ => None,
        }
    }
}
