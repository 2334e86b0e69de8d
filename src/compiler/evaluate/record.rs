//! Records as functions see them: made by constructors, and without a value yet (section 12.6 of the
//! specification).

use std::rc::Rc;

use super::cause::call::CallCause;
use super::frame::FrameKind;
use super::function::has_fixed_value;
use super::record_modifier::Given;
use super::value::{Record, Value};
use super::{Evaluator, MAX_DEPTH};
use crate::base::index::FastSet;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::Ident;
use crate::ir::expr::{Const, Type};
use crate::ir::instance::{ClassId, Declaration, Entry};
impl Evaluator<'_> {
    /// Zero, false, empty, the first literal.
    pub(super) fn zero_of_type(&mut self, ty: Type) -> Value {
        Value::Scalar(match ty {
            Type::Real => self.graph.real(0.0),
            Type::Integer => self.graph.integer(0),
            Type::Boolean | Type::Clock => self.graph.boolean(false),
            Type::String => self.graph.string(""),
            Type::Enumeration(t) => self.graph.constant(Const::Enumeration(t, 1)),
        })
    }

    /// A value of a class before anything is assigned: zero, false, empty, first literal.
    /// Modifications may give values to its fields.
    pub(super) fn zero_of_class(
        &mut self,
        class: ClassId,
        modified: &Given,
        span: Span,
    ) -> Option<Value> {
        let table = self.table(class);
        if let Some(ty) = table.scalar {
            return Some(self.zero_of_type(ty));
        }
        if self.open_records.contains(&class) || self.open_records.len() >= MAX_DEPTH {
            let class = self.classes[class].full_name;
            self.report(CallCause::RecordInItself { class }, span);
            return None;
        }
        let components = self.components(class);
        let given = vec![None; components.len()];
        self.open_records.push(class);
        let fields =
            self.with_frame(FrameKind::Function, |cx| cx.fields(&components, given, modified));
        self.open_records.pop();
        Some(Value::Record(Rc::new(Record { class: Some(class), fields: fields.ok()? })))
    }

    /// The fields of a record in order. Fields that a default refers to are computed before it; an
    /// error is the position of the field without a value.
    pub(super) fn fields(
        &mut self,
        components: &[(Entry, Declaration)],
        given: Vec<Option<Value>>,
        modified: &Given,
    ) -> Result<Vec<(Name, Value)>, usize> {
        let mut order = Vec::with_capacity(components.len());
        let mut met = vec![false; components.len()];
        for k in 0..components.len() {
            self.order_of_fields(components, &given, k, &mut met, &mut order);
        }
        let mut values: Vec<Option<Value>> = given;
        for k in order {
            let (entry, declaration) = &components[k];
            let value = match values[k].take() {
                Some(value) => value,
                None => match modified.field(entry.name.name) {
                    Some(given) => self.modified_start(entry, declaration, given).ok_or(k)?,
                    None => self.local_start(entry, declaration).ok_or(k)?,
                },
            };
            self.frames.declare(entry.name.name, value.clone());
            values[k] = Some(value);
        }
        let names = components.iter().map(|(e, _)| e.name.name);
        Ok(names.zip(values.into_iter().flatten()).collect())
    }

    pub(super) fn order_of_fields(
        &self,
        components: &[(Entry, Declaration)],
        given: &[Option<Value>],
        k: usize,
        met: &mut [bool],
        order: &mut Vec<usize>,
    ) {
        if std::mem::replace(&mut met[k], true) {
            return;
        }
        let (entry, declaration) = &components[k];
        let read = match given[k] {
            None => self.read_by(entry, declaration),
            Some(_) => Vec::new(),
        };
        for name in read {
            if let Some(other) = components.iter().position(|(e, _)| e.name.name == name) {
                self.order_of_fields(components, given, other, met, order);
            }
        }
        order.push(k);
    }

    /// True for a field of a predefined type whose declaration gives it no value.
    fn lacks_value(&mut self, entry: &Entry, declaration: &Declaration) -> bool {
        let is_array =
            !declaration.component().dims.is_empty() || !declaration.clause().type_dims.is_empty();
        if is_array || self.declared_value(entry, declaration).is_some() {
            return false;
        }
        let scope = self.declaration_scope(entry);
        let class = self.find_class(&declaration.clause().type_name, scope);
        class.is_some_and(|class| self.table(class).scalar.is_some())
    }

    /// A record constructor (section 12.6).
    pub(super) fn construct(
        &mut self,
        class: ClassId,
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Value> {
        let components = self.components(class);
        let full_name = self.classes[class].full_name;
        let fields: Vec<&(Entry, Declaration)> =
            components.iter().filter(|(_, d)| !has_fixed_value(d)).collect();
        let given = self.matched(full_name, &fields, args, named, span)?;
        if let Some(result) = self.vectorised(class, &fields, &given, span) {
            return result;
        }
        let mut given = given.into_iter();
        let given: Vec<Option<Value>> = components
            .iter()
            .map(|(_, d)| if has_fixed_value(d) { None } else { given.next().flatten() })
            .collect();
        for ((entry, declaration), value) in components.iter().zip(&given) {
            if value.is_none() && self.lacks_value(entry, declaration) {
                let field = entry.name.name;
                self.report(CallCause::FieldWithoutValue { record: full_name, field }, span);
                return None;
            }
        }
        // A default of a field constructs the record again.
        if self.open_records.contains(&class) {
            self.report(CallCause::RecordInItself { class: full_name }, span);
            return None;
        }
        let outermost = !self.frames.in_function();
        let events = if outermost { self.events_of_arguments(&given) } else { FastSet::default() };
        self.open_records.push(class);
        let built = self
            .with_frame(FrameKind::Function, |cx| cx.fields(&components, given, &Given::default()));
        self.open_records.pop();
        let built = match built {
            Ok(built) => built,
            Err(k) => {
                let name = components[k].0.name.name;
                if !self.problems.has_errors() {
                    let cause = CallCause::FieldWithoutValue { record: full_name, field: name };
                    self.report(cause, span);
                }
                return None;
            }
        };
        let made = Value::Record(Rc::new(Record { class: Some(class), fields: built }));
        if !outermost {
            return Some(made);
        }
        // The class's bindings of fields that were not given are applied by the constructor.
        let made = self.without_events(&made, &events);
        self.note_moving_results(&made);
        Some(made)
    }
}
