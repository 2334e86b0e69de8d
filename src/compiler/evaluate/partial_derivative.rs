//! Functions that are partial derivatives of others, `function f_x = der(f, x)` (section 12.7.2 of the
//! specification): the function is run on symbols, and its outputs are differentiated by them.

use std::rc::Rc;

use super::Evaluator;
use super::cause::call::CallCause;
use super::value::Value;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::cause::Alternatives;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{Causality, Ident};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::instance::{ClassId, Declaration, Entry};
use crate::symbolic::gradient::{Leaf, forward_derivative};
use crate::symbolic::rewrite::Rewriter;

/// An input by which is differentiated.
struct Symbol {
    variable: VarId,
    /// The argument that it represents.
    argument: ExprId,
}

impl Evaluator<'_> {
    /// Executes a function and differentiates its outputs by some of its inputs, one after the
    /// other.
    pub(crate) fn run_differentiated(
        &mut self,
        class: ClassId,
        components: &[(Entry, Declaration)],
        given: &mut [Option<Value>],
        by: &Rc<[Ident]>,
        span: Span,
    ) -> Option<Value> {
        let mut inputs = Vec::new();
        for (entry, declaration) in components {
            if self.causality(entry, declaration) == Some(Causality::Input) {
                inputs.push(entry.name.name);
            }
        }
        let mut symbols: Vec<(Name, Symbol)> = Vec::new();
        for variable in by.iter() {
            if symbols.iter().all(|(name, _)| *name != variable.name) {
                let symbol = self.symbol_of_input(class, &inputs, given, variable, span)?;
                symbols.push((variable.name, symbol));
            }
        }
        let value = self.run(class, components, given, span)?;
        let mut failed = None;
        let mut rewriter = Rewriter::new();
        let derivative = value.each_scalar(&mut |e| {
            if self.graph.ty(e) != Type::Real {
                failed.get_or_insert(Construct::DerivativeOfOtherType);
                return e;
            }
            let mut derivative = e;
            for variable in by.iter() {
                let Some((_, symbol)) = symbols.iter().find(|s| s.0 == variable.name) else {
                    continue;
                };
                if self.calls_on(derivative, symbol.variable) {
                    failed.get_or_insert(Construct::DerivativeOfLoop);
                }
                let one = self.graph.real(1.0);
                derivative = forward_derivative(&mut self.graph, derivative, |_, leaf| {
                    (leaf == Leaf::Var(symbol.variable)).then_some(one)
                });
            }
            rewriter.apply(&mut self.graph, derivative, &mut |graph, e| match graph.node(e) {
                Node::Var(v) => {
                    symbols.iter().find(|(_, s)| s.variable == v).map(|(_, s)| s.argument)
                }
                _ => None,
            })
        });
        if let Some(construct) = failed {
            self.unsupported(span, construct);
            return None;
        }
        Some(derivative)
    }

    /// Puts a symbol in the place of the argument for an input.
    fn symbol_of_input(
        &mut self,
        class: ClassId,
        inputs: &[Name],
        given: &mut [Option<Value>],
        variable: &Ident,
        span: Span,
    ) -> Option<Symbol> {
        let full_name = self.classes[class].full_name;
        let name = variable.name;
        let Some(at) = inputs.iter().position(|input| *input == name) else {
            let listed: Vec<&str> = inputs.iter().map(|n| n.as_str()).collect();
            let others = Alternatives::all(&listed);
            let cause = CallCause::UnknownDerivativeInput { function: full_name, name, others };
            self.report(cause, variable.span);
            return None;
        };
        let Some(value) = &given[at] else {
            self.report(CallCause::MissingArgument { function: full_name, name }, span);
            return None;
        };
        let Some(argument) = value.scalar() else {
            self.unsupported(span, Construct::DerivativeByArray);
            return None;
        };
        if !matches!(self.graph.ty(argument), Type::Real | Type::Integer) {
            let cause = CallCause::DerivativeByOther { function: full_name, name };
            self.report(cause, variable.span);
            return None;
        }
        self.loops.symbols += 1;
        let variable = super::runtime_loop::symbol(self.loops.symbols);
        given[at] = Some(Value::Scalar(self.graph.var(variable, Type::Real)));
        Some(Symbol { variable, argument })
    }

    /// True if a call that is left in an expression depends on a variable.
    fn calls_on(&self, e: ExprId, variable: VarId) -> bool {
        let mut roots = Vec::new();
        for node in self.graph.postorder([e]) {
            if let Node::Call { args, .. } = self.graph.node(node) {
                roots.extend(self.graph.list(args));
            }
        }
        let below = self.graph.postorder(roots);
        below.into_iter().any(|node| self.graph.node(node) == Node::Var(variable))
    }
}
