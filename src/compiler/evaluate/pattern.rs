//! What may be assigned to a variable, or passed for it: a value of its type and sizes. Integers
//! become Real, and nothing else is converted (sections 6.7, 10.6.1 and 10.6.13 of the
//! specification).

use std::rc::Rc;

use super::Evaluator;
use super::cause::array::{ArrayCause, Pair};
use super::cause::call::CallCause;
use super::cause::types::{Expected, TypeCause};
use super::definite_assignment::{Missing, Parts, elements, missing};
use super::function::Components;
use super::reference::Selection;
use super::value::{Record, Value};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{Causality, ClassKind, ExprKind, Subscript};
use crate::ir::expr::{ExprId, Type};
use crate::ir::instance::{ClassId, Declaration, Entry, InstanceKind, SectionKind};

/// Records within records that are looked into.
const MOST_NESTED: usize = 8;

/// The type of a variable, and its sizes as far as the declaration itself says them.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Pattern {
    /// A scalar of a type.
    Scalar(Type),
    /// An array.
    Array(Vec<Size>, Rc<Pattern>),
    /// A record.
    Record(Option<ClassId>, Rc<[(Name, Pattern)]>),
    /// Something that is not looked into: a function, an external object, a clock.
    Any,
}

/// A size as it is declared.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Size {
    /// `:`
    Open,
    /// A number.
    Known(usize),
    /// Any other expression.
    Computed,
}

/// The patterns of classes and of the variables of functions.
#[derive(Default)]
pub struct Patterns {
    of_classes: FastMap<ClassId, Pattern>,
    of_functions: FastMap<ClassId, Rc<FastMap<Name, Pattern>>>,
    /// Functions whose outputs were checked.
    pub(super) checked: FastSet<ClassId>,
}

impl Pattern {
    /// The pattern of a field; `Any` of anything but a record.
    pub(super) fn field(&self, name: Name) -> Pattern {
        match self {
            Pattern::Record(_, fields) => {
                fields.iter().find(|(n, _)| *n == name).map_or(Pattern::Any, |(_, p)| p.clone())
            }
            _ => Pattern::Any,
        }
    }

    /// The pattern of an element of an array.
    pub(super) fn element(&self) -> Pattern {
        match self {
            Pattern::Array(_, inner) => (**inner).clone(),
            _ => Pattern::Any,
        }
    }

    /// An array of these sizes, or the element itself if there are none.
    pub(super) fn array(sizes: &[usize], element: Pattern) -> Pattern {
        if sizes.is_empty() || element == Pattern::Any {
            return element;
        }
        Pattern::Array(sizes.iter().map(|n| Size::Known(*n)).collect(), Rc::new(element))
    }

    /// Whether it is one of a predefined type that has elements. The fields of a record may have
    /// defaults.
    fn surely_has_scalars(&self) -> bool {
        match self {
            Pattern::Scalar(_) => true,
            Pattern::Array(sizes, element) => {
                element.surely_has_scalars()
                    && sizes.iter().all(|size| matches!(size, Size::Known(1..)))
            }
            Pattern::Record(..) | Pattern::Any => false,
        }
    }

    fn sizes(&self) -> &[Size] {
        match self {
            Pattern::Array(sizes, _) => sizes,
            _ => &[],
        }
    }
}

impl Evaluator<'_> {
    /// The patterns of the variables of a function, by name.
    fn patterns_of_function(
        &mut self,
        class: ClassId,
        components: &Components,
    ) -> Rc<FastMap<Name, Pattern>> {
        if let Some(known) = self.patterns.of_functions.get(&class) {
            return known.clone();
        }
        let all: FastMap<Name, Pattern> = components
            .iter()
            .map(|(entry, d)| (entry.name.name, self.declared_pattern(entry, d, 0)))
            .collect();
        let all = Rc::new(all);
        self.patterns.of_functions.insert(class, all.clone());
        all
    }

    /// The pattern of a variable of the function that is being run.
    pub(super) fn pattern_of_local(&self, name: Name) -> Pattern {
        let running = self.recursions.calls.last().filter(|_| self.frames.in_function());
        let known = running.and_then(|call| self.patterns.of_functions.get(&call.class));
        known.and_then(|all| all.get(&name)).cloned().unwrap_or(Pattern::Any)
    }

    fn declared_pattern(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
        depth: usize,
    ) -> Pattern {
        let clause = declaration.clause();
        let scope = self.declaration_scope(entry);
        let Some(class) = self.find_class(&clause.type_name, scope) else { return Pattern::Any };
        let written = declaration.component().dims.iter().chain(&clause.type_dims);
        let sizes: Vec<Size> = written.map(size_of).collect();
        extended(sizes, self.pattern_of_class(class, depth))
    }

    fn pattern_of_class(&mut self, class: ClassId, depth: usize) -> Pattern {
        if let Some(known) = self.patterns.of_classes.get(&class) {
            return known.clone();
        }
        if depth > MOST_NESTED || self.is_external_object(class) {
            return Pattern::Any;
        }
        let table = self.table(class);
        let sizes = table.dims.iter().flat_map(|(list, _)| list.iter().map(size_of)).collect();
        let inner = match (table.scalar, self.kind(class)) {
            (Some(Type::Clock), _) => Pattern::Any,
            (Some(ty), _) => Pattern::Scalar(ty),
            (None, ClassKind::Record | ClassKind::OperatorRecord) => {
                let components = self.components(class);
                let fields = components
                    .iter()
                    .map(|(entry, d)| (entry.name.name, self.declared_pattern(entry, d, depth + 1)))
                    .collect();
                Pattern::Record(Some(class), fields)
            }
            _ => Pattern::Any,
        };
        let made = extended(sizes, inner);
        if depth == 0 {
            self.patterns.of_classes.insert(class, made.clone());
        }
        made
    }

    /// The pattern of components of the model.
    pub(super) fn pattern_of_selection(&mut self, selection: &Selection) -> Pattern {
        match selection {
            Selection::Whole(id) => match self.instances[*id].kind.clone() {
                InstanceKind::Variable { ty, dims, .. } => {
                    Pattern::array(&dims, Pattern::Scalar(ty))
                }
                InstanceKind::Object(children) => {
                    let class = self.instances[*id].class;
                    let fields = children
                        .iter()
                        .map(|child| {
                            let name = self.instances[*child].name;
                            (name, self.pattern_of_selection(&Selection::Whole(*child)))
                        })
                        .collect();
                    Pattern::Record(class, fields)
                }
                InstanceKind::Array { dims, elements, .. } => {
                    let Some(first) = elements.first() else { return Pattern::Any };
                    let element = self.pattern_of_selection(&Selection::Whole(*first));
                    extended(dims.iter().map(|n| Size::Known(*n)).collect(), element)
                }
                _ => Pattern::Any,
            },
            Selection::Element(id, _) => match self.instances[*id].kind {
                InstanceKind::Variable { ty, .. } => Pattern::Scalar(ty),
                _ => Pattern::Any,
            },
            Selection::Many(dims, all) => {
                let Some(first) = all.first() else { return Pattern::Any };
                let element = self.pattern_of_selection(first);
                extended(dims.iter().map(|n| Size::Known(*n)).collect(), element)
            }
            Selection::Dynamic(_, all) => {
                all.first().map_or(Pattern::Any, |first| self.pattern_of_selection(first))
            }
            Selection::Absent => Pattern::Any,
        }
    }

    /// The pattern that a value has.
    pub(crate) fn pattern_of_value(&self, value: &Value) -> Pattern {
        match value {
            Value::Scalar(e) => Pattern::Scalar(self.graph.ty(*e)),
            Value::Array(a) => match a.elements.first() {
                Some(first) => Pattern::array(&a.dims, self.pattern_of_value(first)),
                None => Pattern::Any,
            },
            Value::Record(r) => {
                let fields = r.fields.iter().map(|(n, v)| (*n, self.pattern_of_value(v)));
                Pattern::Record(r.class, fields.collect())
            }
            Value::Tuple(_) | Value::Function(_) => Pattern::Any,
        }
    }

    /// The value as one of this pattern; a value that is none is reported. `sizes` are those of an
    /// array whose declaration computes them, as far as they are known.
    pub(crate) fn fitted(
        &mut self,
        pattern: &Pattern,
        sizes: &[usize],
        value: Value,
        span: Span,
    ) -> Option<Value> {
        match (pattern, &value) {
            (Pattern::Any, _) | (_, Value::Function(_) | Value::Tuple(_)) => Some(value),
            (Pattern::Scalar(ty), Value::Scalar(e)) => {
                self.check_assigned_type(*ty, *e, span)?;
                Some(value)
            }
            (Pattern::Array(wanted, element), Value::Array(_)) => {
                if value.dims().len() != wanted.len() && !value.elements().is_empty() {
                    return self.unfit(pattern, &value, span);
                }
                if !self.has_sizes(wanted, sizes, &value) {
                    self.report_unfit_sizes(wanted, sizes, &value, span);
                    return None;
                }
                if let Pattern::Scalar(ty) = **element {
                    for e in value.elements() {
                        match e.scalar() {
                            Some(e) => self.check_assigned_type(ty, e, span)?,
                            None => return self.unfit(element, e, span),
                        }
                    }
                    return Some(value);
                }
                let dims = value.dims().to_vec();
                let elements = value
                    .elements()
                    .iter()
                    .map(|e| self.fitted(element, &[], e.clone(), span))
                    .collect::<Option<Vec<Value>>>()?;
                Some(Value::array(dims, elements))
            }
            (Pattern::Record(class, fields), Value::Record(given)) => {
                let mut made = Vec::with_capacity(fields.len());
                for (name, pattern) in fields.iter() {
                    let Some((_, field)) = given.fields.iter().find(|(n, _)| n == name) else {
                        self.report(TypeCause::MissingField { name: *name }, span);
                        return None;
                    };
                    made.push((*name, self.fitted(pattern, &[], field.clone(), span)?));
                }
                let same = given.fields.iter().map(|f| f.0).eq(made.iter().map(|f| f.0));
                let class = if same { given.class } else { *class };
                Some(Value::Record(Rc::new(Record { class, fields: made })))
            }
            _ => self.unfit(pattern, &value, span),
        }
    }

    /// Whether an array has the sizes that are wanted, as far as they are known.
    fn has_sizes(&self, wanted: &[Size], computed: &[usize], value: &Value) -> bool {
        let given = value.dims();
        if given.len() != wanted.len() {
            // The rank of an array without elements may have been lost.
            return value.elements().is_empty();
        }
        wanted.iter().zip(given).enumerate().all(|(k, (wanted, given))| match wanted {
            Size::Open => true,
            Size::Known(n) => n == given,
            Size::Computed => computed.get(k).is_none_or(|n| n == given),
        })
    }

    fn report_unfit_sizes(
        &mut self,
        wanted: &[Size],
        computed: &[usize],
        value: &Value,
        span: Span,
    ) {
        let given = value.dims().to_vec();
        let size = |(k, size): (usize, &Size)| match size {
            Size::Known(n) => Some(*n),
            Size::Computed => computed.get(k).or(given.get(k)).copied(),
            Size::Open => given.get(k).copied(),
        };
        let left: Option<Vec<usize>> = wanted.iter().enumerate().map(size).collect();
        let left = left.unwrap_or_default();
        let (targets, values) = (left.iter().product(), given.iter().product());
        match left.len() == given.len() && targets != values {
            true => self.report_count(values, targets, span),
            false => {
                self.report(ArrayCause::SizesDiffer { of: Pair::Sides, left, right: given }, span)
            }
        }
    }

    fn unfit(&mut self, pattern: &Pattern, value: &Value, span: Span) -> Option<Value> {
        let expected = match pattern {
            Pattern::Scalar(_) => Expected::Scalar,
            Pattern::Array(sizes, _) => Expected::Array { dimensions: sizes.len() },
            Pattern::Record(..) | Pattern::Any => Expected::Record,
        };
        self.report_type(expected, value, span);
        None
    }

    /// Reports a scalar that is not of this type and does not become one of it.
    fn check_assigned_type(&mut self, wanted: Type, e: ExprId, span: Span) -> Option<()> {
        let given = self.graph.ty(e);
        if self.is_assignable(wanted, given) {
            return Some(());
        }
        let [wanted, found] =
            [wanted, given].map(|ty| crate::symbolic::print::type_name(&self.graph, ty));
        self.report(
            TypeCause::WrongType { expected: Expected::Assigned { ty: wanted }, found },
            span,
        );
        None
    }

    /// Whether a value of one type may be assigned to a variable of another one. Enumerations with
    /// the same literals are one type.
    fn is_assignable(&self, wanted: Type, given: Type) -> bool {
        match (wanted, given) {
            (Type::Real, Type::Integer) | (Type::Clock, _) | (_, Type::Clock) => true,
            (Type::Enumeration(a), Type::Enumeration(b)) => {
                a == b || self.graph.enumerations[a].literals == self.graph.enumerations[b].literals
            }
            (a, b) => a == b,
        }
    }

    /// The value of an input, an output or a local of a function: reported if it does not have the
    /// type and the sizes that are declared. `class` is the function.
    pub(super) fn fitted_local(
        &mut self,
        class: ClassId,
        components: &Components,
        k: usize,
        value: Value,
        span: Span,
    ) -> Option<Value> {
        let (entry, declaration) = &components[k];
        let patterns = self.patterns_of_function(class, components);
        let pattern = patterns.get(&entry.name.name).cloned().unwrap_or(Pattern::Any);
        // Where only sizes are wanted, numbers that they depend on may not have their values.
        let computed = match pattern.sizes().contains(&Size::Computed) && !self.mode.sizes {
            true => {
                // Sizes that are known only at run time are checked there.
                // A size may read another one of the same variable.
                let (name, itself) = (entry.name.name, value.clone());
                let (sizes, _) = self.collect_problems(|cx| {
                    cx.with_local(name, itself, |cx| cx.declared_sizes(entry, declaration))
                });
                let sizes = sizes.unwrap_or_default();
                let given = value.dims();
                let each = sizes.iter().enumerate();
                each.map(|(k, n)| n.or(given.get(k).copied()).unwrap_or_default()).collect()
            }
            false => Vec::new(),
        };
        let (made, problems) =
            self.collect_problems(|cx| cx.fitted(&pattern, &computed, value, span));
        for problem in problems.iter().cloned() {
            self.problems.push(problem.also(entry.name.span, "declared here"));
        }
        made
    }

    /// Reports outputs of a function to which nothing is ever assigned, or not in every case.
    pub(super) fn check_outputs(&mut self, class: ClassId, components: &Components) {
        if !self.patterns.checked.insert(class) || self.table(class).external.is_some() {
            return;
        }
        if !self.table(class).by.is_empty() {
            return;
        }
        let mut assigned = FastSet::default();
        for section in &self.table(class).sections {
            match &section.kind {
                SectionKind::Algorithm(statements, _) => {
                    super::implicit_ranges::assigned(statements, &mut assigned);
                }
                // That functions have no equations is reported elsewhere.
                SectionKind::Equations(_) => return,
            }
        }
        let patterns = self.patterns_of_function(class, components);
        let mut outputs = FastMap::default();
        for (entry, declaration) in components {
            let name = entry.name.name;
            let is_output = self.causality(entry, declaration) == Some(Causality::Output);
            if !is_output || self.declared_value(entry, declaration).is_some() {
                continue;
            }
            let pattern = patterns.get(&name);
            if assigned.contains(&name) {
                // A modification may give values to fields.
                let is_plain = declaration.component().modification.is_none();
                let pattern = pattern.filter(|p| is_plain || !matches!(p, Pattern::Record(..)));
                let parts = pattern.map_or_else(Parts::new, |pattern| self.parts(pattern));
                outputs.insert(name, (entry.name.span, parts));
            } else if pattern.is_some_and(Pattern::surely_has_scalars) {
                let function = self.classes[class].full_name;
                self.report(CallCause::UnassignedOutput { function, name }, entry.name.span);
            }
        }
        self.check_paths(class, &outputs);
    }

    /// The fields of a record without default, or the elements of an array of scalars with sizes that are written as
    /// numbers.
    fn parts(&mut self, pattern: &Pattern) -> Parts {
        match pattern {
            Pattern::Record(Some(class), fields) => {
                let mut parts = Parts::new();
                for (entry, declaration) in self.components(*class) {
                    let own = fields.iter().find(|(name, _)| *name == entry.name.name);
                    let has_value = |(_, pattern): &(Name, Pattern)| pattern.surely_has_scalars();
                    if own.is_some_and(has_value)
                        && self.declared_value(&entry, &declaration).is_none()
                    {
                        parts.insert(format!(".{}", entry.name.name));
                    }
                }
                parts
            }
            Pattern::Array(sizes, element) if matches!(**element, Pattern::Scalar(_)) => {
                let size = |size: &Size| match size {
                    Size::Known(n) => Some(*n),
                    _ => None,
                };
                let sizes: Option<Vec<usize>> = sizes.iter().map(size).collect();
                sizes.map_or_else(Parts::new, |sizes| elements(&sizes))
            }
            _ => Parts::new(),
        }
    }

    /// Warns of outputs that have no value, or not of all their parts, at some end of a function of the user. In libraries
    /// some functions leave to their callers which outputs have a meaning.
    fn check_paths(&mut self, class: ClassId, outputs: &FastMap<Name, (Span, Parts)>) {
        let full_name = self.classes[class].full_name;
        let root = full_name.split('.').next().unwrap_or_default();
        let is_own = |span: Span| {
            let files = self.library.file_classes();
            files.iter().any(|c| c.name.name == root || c.name.span.file == span.file)
        };
        if !outputs.values().any(|(span, _)| is_own(*span)) {
            return;
        }
        let table = self.table(class);
        let statements = table.sections.iter().filter_map(|section| match &section.kind {
            SectionKind::Algorithm(statements, _) => Some(&**statements),
            SectionKind::Equations(_) => None,
        });
        let parts = outputs.iter().map(|(name, (_, parts))| (*name, parts.clone())).collect();
        for Missing { name, part, branch } in missing(&parts, statements) {
            let cause = CallCause::OutputInPart { function: full_name, name, part };
            let mut problem = Diagnostic::new(cause, outputs[&name].0);
            if let Some(branch) = branch {
                problem =
                    problem.also(branch, "some paths through this `if` assign it, others do not");
            }
            self.problems.push(problem);
        }
    }
}

fn size_of(subscript: &Subscript) -> Size {
    match subscript {
        Subscript::Colon(_) => Size::Open,
        Subscript::Expr(e) => match e.kind {
            ExprKind::Integer(n) if n >= 0 => Size::Known(n as usize),
            _ => Size::Computed,
        },
    }
}

/// A pattern with more sizes before its own.
fn extended(mut sizes: Vec<Size>, pattern: Pattern) -> Pattern {
    if sizes.is_empty() || pattern == Pattern::Any {
        return pattern;
    }
    match pattern {
        Pattern::Array(own, element) => {
            sizes.extend(own);
            Pattern::Array(sizes, element)
        }
        other => Pattern::Array(sizes, Rc::new(other)),
    }
}
