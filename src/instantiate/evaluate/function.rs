//! Calls of functions and record constructors (chapter 12 of the specification). A function is run on
//! its arguments, symbolic or not, and so becomes part of the expression that calls it.

use std::rc::Rc;

use super::value::{Record, Value};
use super::{Context, MAX_DEPTH};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{Causality, ClassKind, Ident, Variability};
use crate::ir::expr::{Const, Type};
use crate::ir::instance::{ClassId, Declaration, Entry, EntryKind, Scope, SectionKind};

impl Context<'_> {
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
            ClassKind::Record | ClassKind::OperatorRecord => {
                self.construct(class, args, named, span)
            }
            _ => {
                let full_name = self.classes[class].full_name;
                self.error("MO0219", span, format!("`{full_name}` is no function"));
                None
            }
        }
    }

    fn components(&mut self, class: ClassId) -> Vec<(Entry, Declaration)> {
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
        self.check_function(class);
        let components = self.components(class);
        let full_name = self.classes[class].full_name;
        let mut inputs: Vec<&(Entry, Declaration)> = Vec::new();
        for c in &components {
            if self.causality(&c.0, &c.1) == Some(Causality::Input) {
                inputs.push(c);
            }
        }
        let mut given = self.matched(full_name, &inputs, args, named, span)?;
        if let Some(result) = self.vectorised(class, &inputs, &given, span) {
            return result;
        }
        if self.evaluation.depth >= MAX_DEPTH {
            let message = format!("`{full_name}` calls itself more than {MAX_DEPTH} deep");
            self.error("MO0221", span, message);
            return None;
        }
        self.evaluation.depth += 1;
        let saved = self.enter_frame(true);
        let left = (self.evaluation.broken.take(), self.evaluation.returned.take());
        let result = self.run(class, &components, &mut given, span);
        (self.evaluation.broken, self.evaluation.returned) = left;
        self.leave_frame(saved);
        self.evaluation.depth -= 1;
        result
    }

    /// Arguments in the order of the inputs; `None` for those left to their defaults.
    fn matched(
        &mut self,
        full_name: Name,
        inputs: &[&(Entry, Declaration)],
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Vec<Option<Value>>> {
        if args.len() > inputs.len() {
            let message = format!(
                "`{full_name}` takes {} arguments, and there are {}",
                inputs.len(),
                args.len()
            );
            self.error("MO0219", span, message);
            return None;
        }
        let mut given: Vec<Option<Value>> = args.into_iter().map(Some).collect();
        given.resize(inputs.len(), None);
        for (name, value) in named {
            let at = inputs.iter().position(|(e, _)| e.name.name == name.name);
            match at {
                Some(k) if given[k].is_none() => given[k] = Some(value),
                Some(_) => {
                    let message = format!("argument `{}` is given twice", name.name);
                    self.error("MO0219", name.span, message);
                    return None;
                }
                None => {
                    let names: Vec<&str> =
                        inputs.iter().map(|(e, _)| e.name.name.as_str()).collect();
                    let message = format!("`{full_name}` has no argument `{}`", name.name);
                    let mut d = Diagnostic::error("MO0219", name.span, message);
                    if !names.is_empty() {
                        d = d.help(format!(
                            "it takes {}",
                            crate::instantiate::error::listed(&names)
                        ));
                    }
                    self.problems.push(d);
                    return None;
                }
            }
        }
        Some(given)
    }

    /// A function of scalars called with arrays is called for each element (section 12.4.6).
    fn vectorised(
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
                    self.error("MO0215", span, "arrays of different sizes in one vectorised call");
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
            match self.call_function(class, Vec::new(), element, span) {
                Some(v) => results.push(v),
                None => return Some(None),
            }
            crate::instantiate::component::advance(&mut subscripts, &dims);
        }
        Some(Some(Value::array(dims, results)))
    }

    fn formal_rank(&mut self, entry: &Entry, declaration: &Declaration) -> usize {
        let clause = declaration.clause();
        let scope = self.declaration_scope(entry);
        let inner = match self.find_class(&clause.type_name, scope) {
            Some(c) => self.table(c).dims.iter().map(|(d, _)| d.len()).sum(),
            None => 0,
        };
        declaration.component().dims.len() + clause.type_dims.len() + inner
    }

    /// `input` or `output`, as declared or by the type.
    pub(crate) fn causality(&mut self, entry: &Entry, d: &Declaration) -> Option<Causality> {
        let clause = d.clause();
        let fixed = clause.prefix.variability.is_some();
        if clause.prefix.causality.is_some() || entry.protected || fixed {
            return clause.prefix.causality;
        }
        let scope = self.declaration_scope(entry);
        let class = self.find_class(&clause.type_name, scope)?;
        if self.table_in_progress(class) {
            return None;
        }
        self.table(class).prefix.causality
    }

    fn declaration_scope(&self, entry: &Entry) -> Scope {
        Scope { instance: self.classes[entry.class].holder, class: entry.class }
    }

    fn run(
        &mut self,
        class: ClassId,
        components: &[(Entry, Declaration)],
        given: &mut [Option<Value>],
        span: Span,
    ) -> Option<Value> {
        let mut outputs = Vec::new();
        let mut next = 0;
        for (entry, declaration) in components {
            let name = entry.name.name;
            let causality = self.causality(entry, declaration);
            let argument = if causality == Some(Causality::Input) {
                next += 1;
                given[next - 1].take()
            } else {
                None
            };
            if causality == Some(Causality::Output) {
                outputs.push(name);
            }
            let value = match argument {
                Some(value) => value,
                None => match self.local_start(entry, declaration) {
                    Some(value) => value,
                    None => {
                        if causality == Some(Causality::Input) {
                            let full_name = self.classes[class].full_name;
                            let message = format!("argument `{name}` of `{full_name}` is missing");
                            self.error("MO0219", span, message);
                        }
                        return None;
                    }
                },
            };
            self.evaluation.locals.push((name, value));
        }
        let table = self.table(class);
        if let Some((external, _)) = &table.external {
            let called = external.function.map_or(self.classes[class].full_name, |f| f.name);
            self.problems.push(
                Diagnostic::error(
                    "MO0222",
                    span,
                    format!("the external function `{called}` is not known to mocc"),
                )
                .also(external.span, "declared external here")
                .help("write the function in Modelica"),
            );
            return None;
        }
        for section in &table.sections {
            if let SectionKind::Algorithm(statements, _) = &section.kind {
                let scope =
                    Scope { instance: self.classes[section.class].holder, class: section.class };
                self.run_statements(statements, scope)?;
            }
        }
        let frame = self.evaluation.frame;
        let mut results = Vec::with_capacity(outputs.len());
        for name in outputs {
            let (_, value) = self.evaluation.locals[frame..].iter().find(|(n, _)| *n == name)?;
            results.push(value.clone());
        }
        // Relations in functions make no events (section 12.2 of the specification).
        for value in &mut results {
            *value = value.each_scalar(&mut |e| self.graph.no_event(e));
        }
        match results.len() {
            1 => results.pop(),
            _ => Some(Value::Tuple(results.into())),
        }
    }

    /// What a local variable, an output or an omitted input starts with.
    fn local_start(&mut self, entry: &Entry, declaration: &Declaration) -> Option<Value> {
        let scope = self.declaration_scope(entry);
        let component = declaration.component();
        let input = self.causality(entry, declaration) == Some(Causality::Input);
        let binding = component.modification.as_ref().and_then(|m| m.binding.clone());
        if let Some(binding) = binding {
            let value = self.evaluate(&binding, scope)?;
            let mut dims = Vec::new();
            for s in &component.dims {
                match s {
                    crate::ir::ast::Subscript::Expr(e) => dims.push(self.fold_size(e, scope)?),
                    crate::ir::ast::Subscript::Colon(_) => return Some(value),
                }
            }
            return self.spread(value, &dims, &Rc::from([]), binding.span);
        }
        if input {
            return None;
        }
        let mut dims = Vec::new();
        for s in component.dims.iter().chain(&declaration.clause().type_dims) {
            match s {
                crate::ir::ast::Subscript::Expr(e) => dims.push(self.fold_size(e, scope)?),
                crate::ir::ast::Subscript::Colon(_) => dims.push(0),
            }
        }
        self.check_count(&dims, component.name.span)?;
        let class = self.class_or_report(&declaration.clause().type_name, scope)?;
        let zero = self.zero_of_class(class, component.name.span)?;
        let n: usize = dims.iter().product();
        let elements = vec![zero; n];
        Some(Value::array(dims, elements))
    }

    /// Zero, false, empty, the first literal.
    pub(super) fn zero_of_type(&mut self, ty: Type) -> Value {
        Value::Scalar(match ty {
            Type::Real => self.graph.real(0.0),
            Type::Integer => self.graph.integer(0),
            Type::Boolean => self.graph.boolean(false),
            Type::String => self.graph.string(""),
            Type::Enumeration(t) => self.graph.constant(Const::Enumeration(t, 1)),
        })
    }

    /// A value of a class before anything is assigned: zero, false, empty, first literal.
    fn zero_of_class(&mut self, class: ClassId, span: Span) -> Option<Value> {
        let table = self.table(class);
        if let Some(ty) = table.scalar {
            return Some(self.zero_of_type(ty));
        }
        let mut fields = Vec::new();
        for (entry, declaration) in self.components(class) {
            fields.push((entry.name.name, self.local_start(&entry, &declaration)?));
        }
        let _ = span;
        Some(Value::Record(Rc::new(Record { class: Some(class), fields })))
    }

    /// A record constructor (section 12.6).
    fn construct(
        &mut self,
        class: ClassId,
        args: Vec<Value>,
        named: Vec<(Ident, Value)>,
        span: Span,
    ) -> Option<Value> {
        let components = self.components(class);
        let full_name = self.classes[class].full_name;
        let fields: Vec<&(Entry, Declaration)> =
            components.iter().filter(|(_, d)| !is_settled(d)).collect();
        let mut given = self.matched(full_name, &fields, args, named, span)?.into_iter();
        let given: Vec<Option<Value>> = components
            .iter()
            .map(|(_, d)| if is_settled(d) { None } else { given.next().flatten() })
            .collect();
        let saved = self.enter_frame(true);
        let mut built: Vec<Option<(Name, Value)>> = vec![None; components.len()];
        // Values that are given first, then constants, which nothing else decides.
        let constant =
            |k: &usize| components[*k].1.clause().prefix.variability == Some(Variability::Constant);
        let mut order: Vec<usize> = (0..components.len()).collect();
        order.sort_by_key(|k| (given[*k].is_none(), !constant(k)));
        let mut given = given;
        for k in order {
            let (entry, declaration) = &components[k];
            let value = match given[k].take() {
                Some(v) => Some(v),
                None => self.local_start(entry, declaration),
            };
            let Some(value) = value else {
                self.leave_frame(saved);
                let message = format!("field `{}` of `{full_name}` is missing", entry.name.name);
                self.error("MO0219", span, message);
                return None;
            };
            self.evaluation.locals.push((entry.name.name, value.clone()));
            built[k] = Some((entry.name.name, value));
        }
        self.leave_frame(saved);
        let built = built.into_iter().flatten().collect();
        Some(Value::Record(Rc::new(Record { class: Some(class), fields: built })))
    }
}

/// Constants and final fields that have a value are no inputs of the constructor (section 12.6).
fn is_settled(declaration: &Declaration) -> bool {
    let constant = declaration.clause().prefix.variability == Some(Variability::Constant);
    let bound = declaration.component().modification.as_ref().is_some_and(|m| m.binding.is_some());
    (constant || declaration.element.is_final) && bound
}
