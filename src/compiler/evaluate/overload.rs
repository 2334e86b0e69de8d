//! Operators of operator records (chapter 14 of the specification): `a + b` calls the function in
//! `operator '+'` whose inputs match, and a number next to a record is converted by its
//! constructor.

use std::sync::Arc;

use super::Evaluator;
use super::cause::call::CallCause;
use super::cause::types::{Expected, TypeCause};
use super::value::Value;
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{Causality, ClassBody, ClassKind, Ident};
use crate::ir::expr::Type;
use crate::ir::instance::{ClassId, Declaration, Entry, EntryKind, Scope};

impl Evaluator<'_> {
    /// True if a value is an operator record or an array of such.
    pub(super) fn is_overloaded(&mut self, value: &Value) -> bool {
        self.operator_record(value).is_some()
    }

    /// The value of an operator with an operator record among its operands.
    pub(super) fn overloaded(
        &mut self,
        operator: &str,
        operands: &[Value],
        span: Span,
    ) -> Option<Value> {
        let classes: Vec<ClassId> =
            operands.iter().filter_map(|v| self.operator_record(v)).collect();
        for &class in &classes {
            if let Some(f) = self.fitting(class, operator, operands, true) {
                return self.call_class(f, operands.to_vec(), Vec::new(), span);
            }
        }
        // A default does not matter where a value is given.
        for &class in &classes {
            if operands.len() > 1
                && let Some(f) = self.fitting(class, operator, operands, false)
            {
                return self.call_class(f, operands.to_vec(), Vec::new(), span);
            }
        }
        // Another operand is converted to the record.
        for &class in &classes {
            let converted: Option<Vec<Value>> = operands
                .iter()
                .map(|v| match v {
                    Value::Scalar(_) => {
                        let alone = std::slice::from_ref(v);
                        let f = self.fitting(class, "'constructor'", alone, false)?;
                        self.call_class(f, alone.to_vec(), Vec::new(), span)
                    }
                    _ => Some(v.clone()),
                })
                .collect();
            let Some(converted) = converted else { continue };
            if let Some(f) = self.fitting(class, operator, &converted, true) {
                return self.call_class(f, converted, Vec::new(), span);
            }
        }
        match classes.first().map(|c| self.classes[*c].full_name) {
            Some(class) => {
                let operator = operator.to_string();
                self.report(TypeCause::UnknownOperator { class, operator }, span);
            }
            None => {
                let record = operands.iter().find(|v| matches!(v, Value::Record(_)));
                self.report_type(Expected::Number, record.or(operands.first())?, span);
            }
        }
        None
    }

    /// Calls the constructor of an operator record whose inputs fit; `None` if it has none.
    pub(super) fn overloaded_constructor(
        &mut self,
        class: ClassId,
        args: &[Value],
        named: &[(Ident, Value)],
        span: Span,
    ) -> Option<Option<Value>> {
        let names: Vec<Name> = named.iter().map(|(n, _)| n.name).collect();
        let functions = self.operator_functions(class, "'constructor'");
        let fits = |cx: &mut Self, f: ClassId| {
            let inputs = cx.inputs(f);
            let is_given = |e: &Entry| names.contains(&e.name.name);
            inputs.len() >= args.len()
                && inputs[args.len()..].iter().all(|(e, d)| is_given(e) || has_default(d))
                && names.iter().all(|n| inputs.iter().any(|(e, _)| e.name.name == *n))
                && args.iter().zip(&inputs).all(|(v, (e, d))| cx.accepts(v, e, d))
        };
        let fitting: Vec<ClassId> = functions.into_iter().filter(|f| fits(self, *f)).collect();
        let &first = fitting.first()?;
        if let Some(&other) = fitting[1..].iter().find(|f| self.takes_the_same(first, **f, args)) {
            let [first, second] = [first, other].map(|f| self.classes[f].full_name);
            self.report(CallCause::AmbiguousConstructor { first, second }, span);
            return Some(None);
        }
        Some(self.call_class(first, args.to_vec(), named.to_vec(), span))
    }

    /// Whether two functions have the same types where positional arguments go.
    fn takes_the_same(&mut self, a: ClassId, b: ClassId, args: &[Value]) -> bool {
        let (a, b) = (self.inputs(a), self.inputs(b));
        (0..args.len()).all(|k| {
            let [x, y] = [&a[k], &b[k]].map(|(entry, declaration)| {
                let scope =
                    Scope { instance: self.classes[entry.class].holder, class: entry.class };
                let class = self.find_class(&declaration.clause().type_name, scope);
                class.map(|c| (self.table(c).scalar, c))
            });
            match (x, y) {
                (Some((Some(s), _)), Some((Some(t), _))) => s == t,
                (Some((None, x)), Some((None, y))) => self.same_record(x, y),
                _ => false,
            }
        }) && !args.is_empty()
    }

    /// The class of the operator record that a value is, or its elements are.
    fn operator_record(&mut self, value: &Value) -> Option<ClassId> {
        let class = match value.elements().first()? {
            Value::Record(r) => r.class?,
            _ => return None,
        };
        let base = self.written(class);
        (self.definition(base)?.kind == ClassKind::OperatorRecord).then_some(class)
    }

    /// The long class definition that short classes lead to.
    fn written(&mut self, mut class: ClassId) -> ClassId {
        // A cycle of short class definitions was reported where it was read.
        for _ in 0..100 {
            let Some(text) = self.definition(class).cloned() else { break };
            let ClassBody::Short(short) = &text.body else { break };
            let scope = self.outside(class);
            match self.find_class(&short.base, scope) {
                Some(base) if base != class => class = base,
                _ => break,
            }
        }
        class
    }

    fn same_record(&mut self, a: ClassId, b: ClassId) -> bool {
        let (a, b) = (self.written(a), self.written(b));
        match (self.definition(a), self.definition(b)) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => a == b,
        }
    }

    /// Whether an operator record has an operator with so many inputs without default.
    pub(crate) fn has_operator(&mut self, class: ClassId, operator: &str, inputs: usize) -> bool {
        let class = self.written(class);
        self.operator_functions(class, operator)
            .into_iter()
            .any(|f| self.inputs(f).iter().filter(|(_, d)| !has_default(d)).count() == inputs)
    }

    /// The functions of an operator.
    fn operator_functions(&mut self, class: ClassId, operator: &str) -> Vec<ClassId> {
        let holder = self.classes[class].holder;
        let Some(found) = self.member_class(class, name(operator), holder) else {
            return Vec::new();
        };
        if matches!(self.kind(found), ClassKind::Function { .. }) {
            return vec![found];
        }
        let names: Vec<Name> = self
            .table(found)
            .entries
            .iter()
            .filter(|e| matches!(e.kind, EntryKind::Class(_)))
            .map(|e| e.name.name)
            .collect();
        let holder = self.classes[found].holder;
        names.into_iter().filter_map(|n| self.member_class(found, n, holder)).collect()
    }

    /// The function of an operator that takes these operands; if `exactly`, without its defaults.
    fn fitting(
        &mut self,
        class: ClassId,
        operator: &str,
        operands: &[Value],
        exactly: bool,
    ) -> Option<ClassId> {
        self.operator_functions(class, operator).into_iter().find(|f| {
            let inputs = self.inputs(*f);
            let required = inputs.iter().filter(|(_, d)| !has_default(d)).count();
            let count = operands.len();
            let enough = required <= count && count <= inputs.len();
            enough
                && (!exactly || required == count)
                && operands.iter().zip(&inputs).all(|(v, (e, d))| self.accepts(v, e, d))
        })
    }

    fn inputs(&mut self, function: ClassId) -> Vec<(Entry, Declaration)> {
        let all = self.components(function);
        let is_input = |d: &Declaration| d.clause().prefix.causality == Some(Causality::Input);
        all.into_iter().filter(|(_, d)| is_input(d)).collect()
    }

    /// True if a value can be given to an input as it is.
    fn accepts(&mut self, value: &Value, entry: &Entry, declaration: &Declaration) -> bool {
        if value.dims().len() != self.formal_rank(entry, declaration) {
            return false;
        }
        let scope = Scope { instance: self.classes[entry.class].holder, class: entry.class };
        let Some(formal) = self.find_class(&declaration.clause().type_name, scope) else {
            return false;
        };
        match value.elements().first() {
            None => true,
            Some(Value::Record(r)) => r.class.is_some_and(|c| self.same_record(c, formal)),
            Some(Value::Scalar(e)) => {
                let given = self.graph.ty(*e);
                match self.table(formal).scalar {
                    Some(Type::Real) => matches!(given, Type::Real | Type::Integer),
                    other => other == Some(given),
                }
            }
            Some(_) => false,
        }
    }
}

/// Whether an input has a value where a call gives none.
fn has_default(declaration: &Declaration) -> bool {
    let modification = &declaration.component().modification;
    modification.as_ref().is_some_and(|m| m.binding.is_some())
}
