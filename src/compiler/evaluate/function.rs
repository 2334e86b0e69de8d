//! Calls of functions and record constructors (chapter 12 of the specification). A function is run on
//! symbols (`specialization`), or on its arguments.

use std::rc::Rc;
use std::sync::Arc;

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::call::{CallCause, Takes};
use super::frame::FrameKind;
use super::record_modifier::Given;
use super::value::Value;
use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::cause::Alternatives;
use crate::ir::ast::{
    ArgumentKind, Causality, ClassBody, ClassKind, Expr, Ident, Subscript, Variability,
};
use crate::ir::expr::{Const, ExprId, Type};
use crate::ir::instance::{ClassId, Declaration, Entry, EntryKind, Scope, SectionKind};

/// The components of a function.
pub(super) type Components = [(Entry, Declaration)];

/// The size of an array whose size nobody says, where a function is only read.
const OPEN_SIZE: usize = 3;

impl Evaluator<'_> {
    /// Calls a class: a function, a record constructor, or an enumeration by number.
    pub(crate) fn call_class(
        &mut self,
        class: ClassId,
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Value> {
        match self.kind(class) {
            ClassKind::Function { .. } => self.call_function(class, args, named, span),
            _ if self.is_external_object(class) => {
                let constructor = super::external::constructor();
                let holder = self.classes[class].holder;
                match self.member_class(class, constructor, holder) {
                    Some(f) => self.call_function(f, args, named, span),
                    None => {
                        let class = self.classes[class].full_name;
                        self.report(CallCause::NoConstructor { class }, span);
                        None
                    }
                }
            }
            ClassKind::OperatorRecord
                if let Some(made) = self.overloaded_constructor(class, &args, &named, span) =>
            {
                made
            }
            ClassKind::Record | ClassKind::OperatorRecord => {
                self.construct(class, args, named, span)
            }
            _ if let Some(Type::Enumeration(id)) = self.table(class).scalar => {
                self.literal_of_ordinal(id, args, named, span)
            }
            _ => {
                let class = self.classes[class].full_name;
                self.report(CallCause::NotAFunction { class }, span);
                None
            }
        }
    }

    pub(super) fn components(&mut self, class: ClassId) -> Vec<(Entry, Declaration)> {
        let table = self.table(class);
        table
            .entries
            .iter()
            .filter_map(|e| match &e.kind {
                EntryKind::Component(d) => Some((e.clone(), d.clone())),
                EntryKind::Class(_) => None,
            })
            .collect()
    }

    fn call_function(
        &mut self,
        class: ClassId,
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Value> {
        crate::rules::statements::check_function(self, class);
        let components = self.components(class);
        let full_name = self.classes[class].full_name;
        if let Some(partial) = self.partial_definition(class) {
            self.problems.push(
                Diagnostic::new(CallCause::PartialFunction { function: full_name }, span)
                    .also(partial.name.span, "declared `partial` here"),
            );
            return None;
        }
        self.check_outputs(class, &components);
        let mut inputs: Vec<&(Entry, Declaration)> = Vec::new();
        for c in &components {
            if self.causality(&c.0, &c.1) == Some(Causality::Input) {
                inputs.push(c);
            }
        }
        let given = self.matched(full_name, &inputs, args, named, span)?;
        self.note_units_of_arguments(class, &components, &given, span);
        if let Some(result) = self.vectorised(class, &inputs, &given, span) {
            return result;
        }
        if let Some(result) = self.recursive(class, &components, &given, span) {
            return result;
        }
        let result = self.call_specialized(class, &components, given.clone(), span);
        let result = self.unwound_result(class, &components, &given, span).unwrap_or(result);
        self.with_given_derivative(class, &inputs, &given, result?, span)
    }

    /// Runs a function on its arguments.
    pub(super) fn run_function(
        &mut self,
        class: ClassId,
        components: &Components,
        given: Vec<Option<Value>>,
        span: Span,
    ) -> Option<Value> {
        // Calls inside a function become part of it.
        let outermost = !self.frames.in_function();
        self.execute(class, components, given, outermost, span)
    }

    /// As [`Evaluator::run_function`]; the events of an `outermost` function are settled.
    pub(super) fn execute(
        &mut self,
        class: ClassId,
        components: &Components,
        mut given: Vec<Option<Value>>,
        outermost: bool,
        span: Span,
    ) -> Option<Value> {
        let left = self.exits;
        // Where its caller was left before, it is not called.
        let reached = self.none_of(left.all());
        self.with_exits_closed(|cx| {
            cx.under(reached, |cx| {
                cx.open_call(class, left);
                let result = cx.with_frame(FrameKind::Function, |cx| {
                    cx.check_executed(span)?;
                    cx.run_in_frame(class, components, &mut given, outermost, span)
                });
                cx.close_call();
                result
            })
        })
    }

    /// Runs a function whose frame is open. Its value has no events, except those of the arguments;
    /// that is settled once, for the `outermost` function.
    fn run_in_frame(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &mut [Option<Value>],
        outermost: bool,
        span: Span,
    ) -> Option<Value> {
        let events = if outermost { self.events_of_arguments(given) } else { FastSet::default() };
        let by = self.table(class).by.clone();
        let result = match by.is_empty() {
            true => self.run(class, components, given, span),
            false => self.run_differentiated(class, components, given, &by, span),
        };
        match outermost {
            true => result.map(|made| self.closed(&made, &events)),
            false => result,
        }
    }

    /// The value of an outermost function, without events except these of its arguments.
    pub(super) fn closed(&mut self, made: &Value, events: &FastSet<ExprId>) -> Value {
        let made = match events.is_empty() {
            true => made.each_scalar(&mut |e| self.graph.no_event(e)),
            false => self.without_events(made, events),
        };
        self.note_moving_results(&made);
        made
    }

    /// The value of a condition where one branch only is followed. A function that has called itself must
    /// know whether it will do so again, even if that fixes parameters that are real numbers.
    pub(super) fn decided(&mut self, condition: ExprId) -> Option<Const> {
        let recurs = match self.recursions.calls.split_last() {
            Some((last, before)) => before.iter().any(|c| c.class == last.class),
            None => false,
        };
        self.parameter_expression(condition, recurs)
    }

    /// Arguments in the order of the inputs; `None` for those left to their defaults.
    pub(super) fn matched(
        &mut self,
        full_name: Name,
        inputs: &[&(Entry, Declaration)],
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Vec<Option<Value>>> {
        if args.len() > inputs.len() {
            let takes = Takes::Count { inputs: inputs.len(), given: args.len() };
            let function = full_name.to_string();
            self.report(CallCause::WrongArguments { function, takes }, span);
            return None;
        }
        let mut given: Vec<Option<Value>> = args.into_iter().map(Some).collect();
        given.resize(inputs.len(), None);
        for (name, value) in named {
            let at = inputs.iter().position(|(e, _)| e.name.name == name.name);
            match at {
                Some(k) if given[k].is_none() => given[k] = Some(value),
                Some(_) => {
                    self.report(CallCause::ArgumentTwice { name: name.name }, name.span);
                    return None;
                }
                None => {
                    let names: Vec<&str> =
                        inputs.iter().map(|(e, _)| e.name.name.as_str()).collect();
                    let others = Alternatives::all(&names);
                    let (function, name, span) = (full_name, name.name, name.span);
                    self.report(CallCause::UnknownArgument { function, name, others }, span);
                    return None;
                }
            }
        }
        Some(given)
    }

    /// A function or record constructor of scalars called with arrays is called for each element (section 12.4.6).
    pub(super) fn vectorised(
        &mut self,
        class: ClassId,
        inputs: &[&(Entry, Declaration)],
        given: &[Option<Value>],
        span: Span,
    ) -> Option<Option<Value>> {
        let mut extra: Option<Vec<usize>> = None;
        let mut spread = vec![false; given.len()];
        for (k, value) in given.iter().enumerate() {
            let Some(value) = value else { continue };
            let (entry, declaration) = inputs[k];
            let formal = self.formal_rank(entry, declaration);
            if value.dims().len() > formal {
                let dims = value.dims()[..value.dims().len() - formal].to_vec();
                if extra.as_ref().is_some_and(|e| *e != dims) {
                    self.report(ArrayCause::VectorizedSizes, span);
                    return Some(None);
                }
                extra = Some(dims);
                spread[k] = true;
            }
        }
        let dims = extra?;
        let count: usize = dims.iter().product();
        let mut subscripts = vec![1; dims.len()];
        let mut results = Vec::with_capacity(count);
        for _ in 0..count {
            let element: Vec<(Ident, Value)> = given
                .iter()
                .enumerate()
                .filter_map(|(k, v)| {
                    let v = v.as_ref()?;
                    let part = if spread[k] { v.select(&subscripts)? } else { v.clone() };
                    Some((inputs[k].0.name, part))
                })
                .collect();
            match self.call_class(class, Vec::new(), element, span) {
                Some(v) => results.push(v),
                None => return Some(None),
            }
            super::value::advance(&mut subscripts, &dims);
        }
        Some(Some(Value::array(dims, results)))
    }

    pub(super) fn formal_rank(&mut self, entry: &Entry, declaration: &Declaration) -> usize {
        let clause = declaration.clause();
        let scope = self.declaration_scope(entry);
        let inner = match self.find_class(&clause.type_name, scope) {
            Some(c) => self.table(c).dims.iter().map(|(d, _)| d.len()).sum(),
            None => 0,
        };
        declaration.component().dims.len() + clause.type_dims.len() + inner
    }

    /// The types of the scalars that a component is declared with, of one element if it is an array; none
    /// if it is a function.
    pub(super) fn scalar_types(&mut self, entry: &Entry, declaration: &Declaration) -> Vec<Type> {
        let scope = self.declaration_scope(entry);
        let mut types = Vec::new();
        if let Some(of) = self.find_class(&declaration.clause().type_name, scope)
            && !matches!(self.kind(of), ClassKind::Function { .. })
            && !self.is_external_object(of)
            && let Some(zero) = self.zero_of_class(of, &Given::default(), entry.name.span)
        {
            zero.for_each_scalar(&mut |e| types.push(self.graph.ty(e)));
        }
        types
    }

    /// Whether a value is a number other than 0.
    fn is_number(&self, value: &Value) -> bool {
        let number = value.scalar().and_then(|e| self.graph.as_const(e)).and_then(Const::number);
        number.is_some_and(|x| x != 0.0)
    }

    /// Checks the body of a function that may never be called, with unknown arguments. Open sizes
    /// are taken to be [`OPEN_SIZE`], so diagnostics about sizes need not hold for others.
    pub fn read_function(&mut self, class: ClassId) {
        let components = self.components(class);
        let mut arguments = Vec::new();
        for (entry, declaration) in &components {
            if self.causality(entry, declaration) != Some(Causality::Input) {
                continue;
            }
            let scope = self.declaration_scope(entry);
            let Some(of) = self.class_or_report(&declaration.clause().type_name, scope) else {
                return;
            };
            if matches!(self.kind(of), ClassKind::Function { .. }) || self.is_external_object(of) {
                return;
            }
            let count = declaration.component().dims.len() + declaration.clause().type_dims.len();
            let Some(zero) = self.zero_of_class(of, &Given::default(), entry.name.span) else {
                return;
            };
            let Some(inner) = self.sizes_of_type(of) else { return };
            let mut dims = vec![OPEN_SIZE; count];
            dims.extend(inner.into_iter().map(|size| size.unwrap_or(OPEN_SIZE)));
            let zeros = vec![zero; dims.iter().product()];
            let zero = Value::array(dims, zeros);
            let graph = &mut self.class_graph.graph;
            let symbols = &mut self.loops.symbols;
            let unknown = zero.each_scalar(&mut |e| {
                *symbols += 1;
                let ty = graph.ty(e);
                graph.var(super::runtime_loop::symbol(*symbols), ty)
            });
            arguments.push(unknown);
        }
        let span = self.definition(class).map_or(Span::NONE, |t| t.name.span);
        // A function that is never called may lack statements.
        let is_new = self.patterns.checked.insert(class);
        self.call_function(class, arguments, Vec::new(), span);
        if is_new {
            self.patterns.checked.remove(&class);
        }
    }

    pub(super) fn run(
        &mut self,
        class: ClassId,
        components: &[(Entry, Declaration)],
        given: &mut [Option<Value>],
        span: Span,
    ) -> Option<Value> {
        self.budget.calls += 1;
        self.spend(1, span)?;
        let mut outputs = Vec::new();
        let mut arguments = Vec::with_capacity(components.len());
        let mut given = given.iter_mut();
        for (entry, declaration) in components {
            let causality = self.causality(entry, declaration);
            let input = causality == Some(Causality::Input);
            arguments.push(if input { given.next().and_then(Option::take) } else { None });
            if causality == Some(Causality::Output) {
                outputs.push(entry.name.name);
            }
        }
        for k in self.initial_order(class, components).iter() {
            let (entry, declaration) = &components[*k];
            let name = entry.name.name;
            let value = match arguments[*k].take() {
                Some(value) => self.fitted_local(class, components, *k, value, span)?,
                None => match self.local_start(entry, declaration) {
                    Some(value) => {
                        let bound = self.declared_value(entry, declaration);
                        let at = bound.map_or(entry.name.span, |(binding, _)| binding.span);
                        self.fitted_local(class, components, *k, value, at)?
                    }
                    None => {
                        if self.causality(entry, declaration) == Some(Causality::Input) {
                            let function = self.classes[class].full_name;
                            self.report(CallCause::MissingArgument { function, name }, span);
                        }
                        return None;
                    }
                },
            };
            // A number in place of a quantity has its unit, which is not seen any more.
            self.units.unitless_literal |= !is_plain(declaration) && self.is_number(&value);
            self.frames.declare(name, value);
        }
        let table = self.table(class);
        if let Some((external, at)) = &table.external {
            let inputs: Vec<Name> = components
                .iter()
                .filter(|(_, d)| d.clause().prefix.causality == Some(Causality::Input))
                .map(|(e, _)| e.name.name)
                .collect();
            let scope = Scope { instance: self.classes[*at].holder, class: *at };
            self.run_external(class, external, &inputs, &outputs, scope, span)?;
        }
        for section in &table.sections {
            if let SectionKind::Algorithm(statements, _) = &section.kind {
                let scope =
                    Scope { instance: self.classes[section.class].holder, class: section.class };
                self.run_statements(statements, scope)?;
            }
        }
        let mut results = Vec::with_capacity(outputs.len());
        for name in outputs {
            let locals = self.frames.visible();
            let (_, value) = locals.iter().find(|(n, _)| *n == name)?;
            results.push(value.clone());
        }
        match results.len() {
            1 => results.pop(),
            _ => Some(Value::Tuple(results.into())),
        }
    }

    /// The first names of all references in the binding, the values of fields and the sizes of a
    /// declaration.
    pub(super) fn read_by(&self, entry: &Entry, declaration: &Declaration) -> Vec<Name> {
        let mut read: Vec<Name> = Vec::new();
        let mut see = |r: &crate::ir::ast::ComponentRef| read.push(r.parts[0].name.name);
        if let Some((binding, _)) = self.declared_value(entry, declaration) {
            super::implicit_ranges::in_expression(&binding, &mut see);
        }
        read.extend(read_before_values(declaration));
        read
    }

    /// The order in which the variables of a function get their first values: those that others read come
    /// before these, wherever they are declared (section 12.4.4).
    pub(super) fn initial_order(&mut self, class: ClassId, components: &Components) -> Rc<[usize]> {
        if let Some(known) = self.initial_orders.get(&class) {
            return known.clone();
        }
        let position = |name: Name| components.iter().position(|(e, _)| e.name.name == name);
        let read: Vec<Vec<usize>> = components
            .iter()
            .map(|(e, d)| self.read_by(e, d).into_iter().filter_map(position).collect())
            .collect();
        let mut order = Vec::with_capacity(components.len());
        let mut met = vec![false; components.len()];
        for k in 0..components.len() {
            put_after_what_it_reads(k, &read, &mut met, &mut order);
        }
        let order: Rc<[usize]> = order.into();
        self.initial_orders.insert(class, order.clone());
        order
    }

    /// The binding of a local or a field, from its declaration or from a class that extends it.
    pub(super) fn declared_value(
        &self,
        entry: &Entry,
        declaration: &Declaration,
    ) -> Option<(Arc<Expr>, Scope)> {
        let name = entry.name.name;
        for (modification, class) in entry.layers.iter() {
            for argument in &modification.args {
                if let ArgumentKind::Element { path, modification: Some(inner), .. } =
                    &argument.kind
                    && let [one] = path.parts.as_slice()
                    && one.name == name
                    && let Some(binding) = &inner.binding
                {
                    // The modification refers to other fields and to the scope of its class.
                    let scope = Scope { instance: self.classes[*class].holder, class: *class };
                    return Some((binding.clone(), scope));
                }
            }
        }
        let binding = declaration.component().modification.as_ref()?.binding.clone()?;
        Some((binding, self.declaration_scope(entry)))
    }

    /// Evaluates a binding of a declaration or a modification. A short class opens no scope for its
    /// modifications: they see the enclosing scope, and not the variables of the function (section
    /// 4.5.1).
    pub(super) fn evaluate_declared(&mut self, binding: &Expr, written_in: Scope) -> Option<Value> {
        let text = self.definition(written_in.class);
        if !text.is_some_and(|t| matches!(t.body, ClassBody::Short(_))) {
            return self.evaluate(binding, written_in);
        }
        let around = self.outside(written_in.class);
        self.with_frame(FrameKind::Class, |cx| cx.evaluate(binding, around))
    }

    /// The sizes of a local or a field, those of its type last; `None` for one that is left open.
    pub(super) fn declared_sizes(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
    ) -> Option<Vec<Option<usize>>> {
        let scope = self.declaration_scope(entry);
        let clause = declaration.clause();
        let written = declaration.component().dims.iter().chain(&clause.type_dims);
        let mut sizes = self.written_sizes(written, scope)?;
        if let Some(class) = self.find_class(&clause.type_name, scope) {
            sizes.extend(self.sizes_of_type(class)?);
        }
        Some(sizes)
    }

    /// The sizes of a type itself. They see the enclosing scope, and not the variables of a
    /// function.
    fn sizes_of_type(&mut self, class: ClassId) -> Option<Vec<Option<usize>>> {
        let mut sizes = Vec::new();
        for (list, holder) in self.table(class).dims.clone() {
            let around = self.outside(holder);
            let found = self.with_frame(FrameKind::Class, |cx| cx.written_sizes(&list, around));
            sizes.extend(found?);
        }
        Some(sizes)
    }

    fn written_sizes<'s>(
        &mut self,
        list: impl IntoIterator<Item = &'s Subscript>,
        scope: Scope,
    ) -> Option<Vec<Option<usize>>> {
        let size = |s: &Subscript| match s {
            Subscript::Expr(e) => Some(Some(self.fold_size(e, scope)?)),
            Subscript::Colon(_) => Some(None),
        };
        list.into_iter().map(size).collect()
    }

    /// The initial value of a local variable, an output or an omitted input.
    pub(super) fn local_start(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
    ) -> Option<Value> {
        let input = self.causality(entry, declaration) == Some(Causality::Input);
        if let Some((binding, written_in)) = self.declared_value(entry, declaration) {
            let value = self.evaluate_declared(&binding, written_in)?;
            let sizes = self.declared_sizes(entry, declaration)?;
            let Some(dims) = sizes.into_iter().collect::<Option<Vec<usize>>>() else {
                return Some(value);
            };
            return self.spread(value, &dims, &Rc::from([]), binding.span);
        }
        if input {
            return None;
        }
        self.declared_zero(entry, declaration)
    }

    /// A zero of the sizes and the type that a local or a field is declared with; open sizes are 0.
    pub(super) fn declared_zero(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
    ) -> Option<Value> {
        self.declared_zero_with(entry, declaration, &Given::default())
    }

    /// The same with what modifications from outside give to its fields.
    pub(super) fn declared_zero_with(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
        outside: &Given,
    ) -> Option<Value> {
        let scope = self.declaration_scope(entry);
        let component = declaration.component();
        let sizes = self.declared_sizes(entry, declaration)?;
        let dims: Vec<usize> = sizes.into_iter().map(Option::unwrap_or_default).collect();
        self.check_count(&dims, component.name.span)?;
        let class = self.class_or_report(&declaration.clause().type_name, scope)?;
        // Fields may be given values one by one: `output Complex result(re=re, im=im)`.
        let given = match self.has_fields(class) {
            true => self.given_to(entry, declaration, outside)?,
            false => Given::default(),
        };
        let (n, span) = (dims.iter().product(), component.name.span);
        let elements = match dims.is_empty() || given.is_nothing() {
            true => vec![self.zero_of_class(class, &given, span)?; n],
            false => (0..n)
                .map(|k| {
                    let own = self.given_to_element(&given, &dims, k)?;
                    self.zero_of_class(class, &own, span)
                })
                .collect::<Option<_>>()?,
        };
        Some(Value::array(dims, elements))
    }
}

/// The first names of all references in the sizes of a declaration, and in the values that it gives to fields.
pub(super) fn read_before_values(declaration: &Declaration) -> Vec<Name> {
    let mut read = Vec::new();
    if let Some(modification) = &declaration.component().modification {
        for binding in super::record_modifier::bindings(modification) {
            super::implicit_ranges::in_expression(binding, &mut |r| {
                read.push(r.parts[0].name.name)
            });
        }
    }
    for s in declaration.component().dims.iter().chain(&declaration.clause().type_dims) {
        if let Subscript::Expr(e) = s {
            super::implicit_ranges::in_expression(e, &mut |r| read.push(r.parts[0].name.name));
        }
    }
    read
}

/// Whether the type of a component is predefined, and says nothing of a unit.
fn is_plain(declaration: &Declaration) -> bool {
    let parts = &declaration.clause().type_name.parts;
    let first = parts.last().map_or("", |p| p.name.as_str());
    parts.len() == 1 && matches!(first, "Real" | "Integer" | "Boolean" | "String")
}

/// Constants and final fields with a value are not inputs of the constructor (section 12.6).
pub(super) fn has_fixed_value(declaration: &Declaration) -> bool {
    is_constant(declaration) || declaration.element.is_final && has_value(declaration)
}

/// A constant with a value.
pub(super) fn is_constant(declaration: &Declaration) -> bool {
    declaration.clause().prefix.variability == Some(Variability::Constant) && has_value(declaration)
}

fn has_value(declaration: &Declaration) -> bool {
    declaration.component().modification.as_ref().is_some_and(|m| m.binding.is_some())
}

fn put_after_what_it_reads(
    k: usize,
    read: &[Vec<usize>],
    met: &mut [bool],
    order: &mut Vec<usize>,
) {
    if std::mem::replace(&mut met[k], true) {
        return;
    }
    for other in &read[k] {
        put_after_what_it_reads(*other, read, met, order);
    }
    order.push(k);
}
