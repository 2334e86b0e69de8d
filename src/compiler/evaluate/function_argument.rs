//! Functions as arguments of functions, some of their own arguments given (section 12.4.2 of the
//! specification).

use std::rc::Rc;

use super::Evaluator;
use super::cause::call::{CallCause, Takes};
use super::value::{Partial, Value};
use crate::base::source::Span;
use crate::ir::ast::{Causality, ClassKind, Expr, ExprKind, Ident, Path};
use crate::ir::instance::{ClassId, Scope};

impl Evaluator<'_> {
    /// Calls a function value: with the arguments that were bound to it before.
    pub(crate) fn call_value(
        &mut self,
        f: &Partial,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let mut by_name = f.bound.clone();
        for (k, a) in args.iter().enumerate() {
            let value = self.argument(a, scope)?;
            // Arguments by position are those that are still open.
            let Some(input) = self.open_inputs(f).get(k).copied() else {
                let function = self.classes[f.class].full_name.to_string();
                let takes = Takes::Count { inputs: self.open_inputs(f).len(), given: args.len() };
                self.report(CallCause::WrongArguments { function, takes }, span);
                return None;
            };
            by_name.push((input, value));
        }
        for (n, e) in named {
            by_name.push((*n, self.argument(e, scope)?));
        }
        self.call_class(f.class, Vec::new(), by_name, span)
    }

    /// The inputs of a function to which nothing is bound yet.
    fn open_inputs(&mut self, f: &Partial) -> Vec<Ident> {
        let mut open = Vec::new();
        for (entry, declaration) in self.components(f.class) {
            let input = self.causality(&entry, &declaration) == Some(Causality::Input);
            if input && !f.bound.iter().any(|(n, _)| n.name == entry.name.name) {
                open.push(entry.name);
            }
        }
        open
    }

    /// An argument of a call: a value, or a function (section 12.4.2).
    pub(crate) fn argument(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
        let path = match &e.kind {
            ExprKind::PartialFunction { function, .. } => function.clone(),
            ExprKind::Ref(r) if r.parts.iter().all(|p| p.subscripts.is_empty()) => {
                let first = r.parts.first()?.name.name;
                let component = !r.global
                    && (self.local(first).is_some()
                        || !self.frames.in_function()
                            && self.child(scope.instance, first).is_some());
                if component {
                    return self.evaluate(e, scope);
                }
                Path {
                    global: r.global,
                    parts: r.parts.iter().map(|p| p.name).collect(),
                    span: r.span,
                }
            }
            _ => return self.evaluate(e, scope),
        };
        let mut partial = Partial { class: ClassId(0), bound: Vec::new() };
        if let [one] = path.parts.as_slice()
            && let Some(Value::Function(f)) = self.local(one.name)
        {
            partial = (*f).clone();
        } else {
            match self.find_class(&path, scope) {
                Some(class) if matches!(self.kind(class), ClassKind::Function { .. }) => {
                    partial.class = class;
                }
                _ => return self.evaluate(e, scope),
            }
        }
        if let ExprKind::PartialFunction { named, .. } = &e.kind {
            for (n, value) in named {
                let value = self.argument(value, scope)?;
                partial.bound.push((*n, value));
            }
        }
        Some(Value::Function(Rc::new(partial)))
    }
}
