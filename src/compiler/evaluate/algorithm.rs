//! Executes statements on values. If a condition is known, its branch is taken; if it is known only
//! at run time, both branches are executed and each variable they change becomes an `if`
//! expression. Loops iterate as often as is known here. (Chapter 11 of the specification.)

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::call::CallCause;
use super::cause::name::NameCause;
use super::implicit_ranges::Body;
use super::pattern::Pattern;
use super::random_draw::Place;
use super::reference::Selection;
use super::subscript::{Selector, element_position, one_by_one, positions};
use super::value::{Array, Record, Value};
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::cause::{Alternatives, ClassCause, Holder};
use crate::ir::ast::{ComponentRef, Expr, ExprKind, RefPart, Statement, StatementKind};
use crate::ir::expr::{Const, ExprId, Type, VarId};
use crate::ir::instance::{InstanceKind, Scope};

/// No loop in a function that is evaluated here runs longer.
const MAX_ITERATIONS: usize = 1_000_000;

/// How a list of statements ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Flow {
    Next,
    Break,
    Return,
}

/// Where an assignment is: its left side, and the statement.
#[derive(Clone, Copy, Debug)]
struct Places {
    target: Span,
    statement: Span,
}

/// Conditions under which the code being executed was left already; `None` if it was not.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Exits {
    /// The innermost loop, by `break`.
    pub(crate) broken: Option<ExprId>,
    /// A loop around it, by `break`.
    pub(crate) around: Option<ExprId>,
    /// The function, by `return`.
    pub(crate) returned: Option<ExprId>,
}

impl Exits {
    /// All conditions, as far as there are any.
    pub(crate) fn all(self) -> impl Iterator<Item = ExprId> {
        self.loops().chain(self.returned)
    }

    /// The conditions under which a loop was left by `break`.
    fn loops(self) -> impl Iterator<Item = ExprId> {
        self.broken.into_iter().chain(self.around)
    }
}

impl Evaluator<'_> {
    /// Runs statements; `None` after an error.
    pub(crate) fn run_statements(&mut self, list: &[Statement], scope: Scope) -> Option<Flow> {
        for s in list {
            let flow = self.run_statement(s, scope)?;
            if flow != Flow::Next {
                return Some(flow);
            }
        }
        Some(Flow::Next)
    }

    fn run_statement(&mut self, s: &Statement, scope: Scope) -> Option<Flow> {
        match &s.kind {
            StatementKind::Assign(target, value) => {
                let value = match self.evaluate(value, scope)? {
                    Value::Tuple(all) if !all.is_empty() => all[0].clone(),
                    value => value,
                };
                self.assign(target, value, scope, s.span)?;
            }
            StatementKind::AssignTuple(targets, call) => {
                let value = self.evaluate_outputs(call, scope)?;
                let values: Vec<Value> = match &value {
                    Value::Tuple(t) => t.to_vec(),
                    other => vec![other.clone()],
                };
                if targets.len() > values.len() {
                    let (wanted, given) = (targets.len(), values.len());
                    self.report(CallCause::TooFewOutputs { wanted, given }, s.span);
                    return None;
                }
                for (target, value) in targets.iter().zip(values) {
                    if let Some(target) = target {
                        self.assign(target, value, scope, s.span)?;
                    }
                }
            }
            StatementKind::Call(call) => self.run_call(call, scope)?,
            StatementKind::If { branches, otherwise } => {
                return self.run_if(branches, otherwise, scope, s.span);
            }
            StatementKind::For { iterators, body } => {
                let iterators = self.with_ranges(iterators, Body::Statements(body), scope)?;
                return self.run_for(&iterators, body, scope);
            }
            StatementKind::While { condition, body } => {
                return self.run_while(condition, body, scope);
            }
            // A `when` in the wrong place was reported when the class was read.
            StatementKind::When { .. } => return None,
            StatementKind::Break => return Some(Flow::Break),
            StatementKind::Return => return Some(self.run_return()),
            StatementKind::Broken => return None,
        }
        Some(Flow::Next)
    }

    /// `return`: if a loop was perhaps left before, the function is left where it was not.
    fn run_return(&mut self) -> Flow {
        if self.exits.loops().next().is_none() {
            return Flow::Return;
        }
        let reached = self.none_of(self.exits.loops());
        self.exits.returned = Some(match self.exits.returned {
            Some(before) => self.graph.or(before, reached),
            None => reached,
        });
        // In either case the rest of the innermost loop is skipped; what follows it checks `exits`.
        Flow::Break
    }

    fn run_call(&mut self, call: &Expr, scope: Scope) -> Option<()> {
        if let ExprKind::Call { function, args, named } = &call.kind
            && function.simple().is_some_and(|n| n == "assert")
        {
            return self.run_assert(args, named, call.span, scope);
        }
        if let ExprKind::Call { function, args, named } = &call.kind
            && function.simple().is_some_and(|n| n == "terminate")
            && self.random_draws.place == Place::When
            && !self.frames.in_function()
        {
            let message = self.message_of_terminate(args, named, call.span, scope)?;
            let active = self.active_condition();
            self.assertions.terminations.push((active, message));
            return Some(());
        }
        self.call_alone(call, scope)
    }

    fn run_if(
        &mut self,
        branches: &[(Expr, Vec<Statement>)],
        otherwise: &[Statement],
        scope: Scope,
        span: Span,
    ) -> Option<Flow> {
        let Some(((condition, body), rest)) = branches.split_first() else {
            return self.run_statements(otherwise, scope);
        };
        let c = self.evaluate(condition, scope)?;
        let c = self.boolean_of(&c, condition.span)?;
        match self.decided(c) {
            Some(Const::Boolean(true)) => return self.run_statements(body, scope),
            Some(Const::Boolean(false)) => return self.run_if(rest, otherwise, scope, span),
            _ => {}
        }
        let before = self.snapshot();
        let left = self.exits;
        let first = self.under(c, |cx| cx.run_statements(body, scope))?;
        let after_first = self.snapshot();
        self.restore(&before);
        let left_first = self.exits;
        self.exits = left;
        let not_c = self.graph.not(c);
        let second = self.under(not_c, |cx| cx.run_if(rest, otherwise, scope, span))?;
        self.merge(c, &after_first, span)?;
        // A branch may leave the loop or function: later statements count only where it did not.
        let left_second = self.exits;
        let all = self.graph.boolean(true);
        let leaves = |flow: Flow, kind: Flow, part: Option<ExprId>| {
            if flow == kind { Some(all) } else { part }
        };
        self.exits.broken = self.either(
            c,
            leaves(first, Flow::Break, left_first.broken),
            leaves(second, Flow::Break, left_second.broken),
        );
        self.exits.returned = self.either(
            c,
            leaves(first, Flow::Return, left_first.returned),
            leaves(second, Flow::Return, left_second.returned),
        );
        if first == second {
            return Some(first);
        }
        Some(Flow::Next)
    }

    /// `if c then a else b` of conditions that are false where there is none.
    fn either(&mut self, c: ExprId, a: Option<ExprId>, b: Option<ExprId>) -> Option<ExprId> {
        if a == b {
            return a;
        }
        let not_c = self.graph.not(c);
        let a = a.map(|a| self.graph.and(c, a));
        let b = b.map(|b| self.graph.and(not_c, b));
        match (a, b) {
            (Some(a), Some(b)) => Some(self.graph.or(a, b)),
            (a, b) => a.or(b),
        }
    }

    fn snapshot(&self) -> (Vec<(Name, Value)>, FastMap<VarId, ExprId>) {
        (self.frames.visible().to_vec(), self.assigned.clone())
    }

    fn restore(&mut self, saved: &(Vec<(Name, Value)>, FastMap<VarId, ExprId>)) {
        self.frames.restore(&saved.0);
        self.assigned.clone_from(&saved.1);
    }

    /// Every variable becomes `if c then (its value in first) else (its value now)`.
    fn merge(
        &mut self,
        c: ExprId,
        first: &(Vec<(Name, Value)>, FastMap<VarId, ExprId>),
        span: Span,
    ) -> Option<()> {
        for (k, (_, value)) in first.0.iter().enumerate() {
            let now = self.frames.visible()[k].1.clone();
            if *value != now {
                let merged = self.if_values(c, value.clone(), now, span)?;
                self.frames.visible_mut()[k].1 = merged;
            }
        }
        let mut keys: Vec<VarId> = first.1.keys().copied().collect();
        keys.extend(self.assigned.keys().copied());
        keys.sort();
        keys.dedup();
        for v in keys {
            let itself = self.variable_itself(v)?;
            let a = first.1.get(&v).copied().unwrap_or(itself);
            let b = self.assigned.get(&v).copied().unwrap_or(itself);
            let merged = self.graph.if_then_else(c, a, b);
            self.assigned.insert(v, merged);
        }
        Some(())
    }

    pub(super) fn run_for(
        &mut self,
        iterators: &[crate::ir::ast::Iterator],
        body: &[Statement],
        scope: Scope,
    ) -> Option<Flow> {
        let Some((first, rest)) = iterators.split_first() else {
            return self.run_statements(body, scope);
        };
        self.in_loop(|cx| {
            if !cx.mode.fold && cx.for_as_function(iterators, body, scope)? {
                return Some(Flow::Next);
            }
            for value in cx.values_of(first, scope)? {
                match cx.with_local(first.name.name, value, |cx| cx.run_for(rest, body, scope))? {
                    Flow::Next => {}
                    Flow::Break => break,
                    Flow::Return => return Some(Flow::Return),
                }
            }
            Some(Flow::Next)
        })
    }

    /// Runs a loop: `break` in it does not leave the loop around it, but it is not reached where
    /// that was left before.
    fn in_loop<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let Exits { broken, around, .. } = self.exits;
        self.exits.around = match (broken, around) {
            (Some(broken), Some(around)) => Some(self.graph.or(around, broken)),
            (broken, around) => broken.or(around),
        };
        self.exits.broken = None;
        let result = act(self);
        (self.exits.broken, self.exits.around) = (broken, around);
        result
    }

    /// Runs something with no open exits; exits inside it do not affect the code after it.
    pub(super) fn with_exits_closed<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::take(&mut self.exits);
        let result = act(self);
        self.exits = outer;
        result
    }

    /// The values of an iterator of an algorithm, a comprehension or a reduction: their number is
    /// known here, the values need not be.
    pub(crate) fn values_of(
        &mut self,
        iterator: &crate::ir::ast::Iterator,
        scope: Scope,
    ) -> Option<Vec<Value>> {
        if let Some(range) = &iterator.range
            && !matches!(&range.kind, ExprKind::Range { .. })
            && !self.mode.fold
            && !matches!(&range.kind, ExprKind::Ref(r) if self.type_size(r, scope).is_some())
            && let Value::Array(a) = self.evaluate(range, scope)?
            && a.dims.len() == 1
            && !self.may_be_subscripts(&a.elements)
        {
            return Some(a.elements.clone());
        }
        self.fold_range(iterator, scope)
    }

    /// Whether all of these are Integers, Booleans or enumeration values that may be known.
    fn may_be_subscripts(&self, values: &[Value]) -> bool {
        values.iter().all(|value| {
            value.scalar().is_some_and(|e| {
                self.graph.ty(e) != Type::Real
                    && self.graph.postorder([e]).into_iter().all(|n| self.may_be_known(n, true))
            })
        })
    }

    fn run_while(&mut self, condition: &Expr, body: &[Statement], scope: Scope) -> Option<Flow> {
        let before = self.exits.returned;
        self.in_loop(|cx| cx.iterate(condition, body, scope, before))
    }

    /// Iterates a `while` loop for as long as it is known here whether there is another iteration.
    fn iterate(
        &mut self,
        condition: &Expr,
        body: &[Statement],
        scope: Scope,
        before: Option<ExprId>,
    ) -> Option<Flow> {
        for _ in 0..MAX_ITERATIONS {
            let c = self.evaluate(condition, scope)?;
            let c = self.boolean_of(&c, condition.span)?;
            let left = self.exits.broken.is_some() || self.exits.returned != before;
            match self.decided(c) {
                Some(Const::Boolean(false)) => return Some(Flow::Next),
                Some(Const::Boolean(true)) if !left => {}
                _ => {
                    self.while_as_function(condition, body, scope)?;
                    return Some(Flow::Next);
                }
            }
            match self.run_statements(body, scope)? {
                Flow::Next => {}
                Flow::Break => return Some(Flow::Next),
                Flow::Return => return Some(Flow::Return),
            }
        }
        self.report(CallCause::EndlessLoop { most: MAX_ITERATIONS }, condition.span);
        None
    }

    /// `target := value`, for a local of a function or a variable of the model, in the statement at
    /// `span`.
    fn assign(
        &mut self,
        target: &ComponentRef,
        value: Value,
        scope: Scope,
        span: Span,
    ) -> Option<()> {
        let first = target.parts[0].name.name;
        if let Some(at) = self.frames.position(first) {
            let old = self.frames.visible()[at].1.clone();
            let pattern = self.pattern_of_local(first);
            let places = Places { target: target.span, statement: span };
            let mut new = match (target.parts.as_slice(), &old) {
                ([part], Value::Array(array)) if !part.subscripts.is_empty() => {
                    let selectors =
                        self.selectors(&array.dims, &part.subscripts, scope, target.span)?;
                    let only = element_position(&array.dims, &selectors);
                    if let (Some(k), None) = (only, self.exits.all().next()) {
                        let value = self.fitted(&pattern.element(), &[], value, span)?;
                        // No other copy is left: assigning elements one by one does not copy the array each time.
                        drop(old);
                        self.frames.visible_mut()[at].1.set_element(k, value);
                        return Some(());
                    }
                    self.replaced(
                        (array, selectors),
                        &pattern,
                        &target.parts,
                        value,
                        scope,
                        places,
                    )?
                }
                (parts, _) => self.updated(&old, &pattern, parts, value, scope, places)?,
            };
            for left in self.exits.all() {
                new = self.if_values(left, old.clone(), new, target.span)?;
            }
            self.frames.visible_mut()[at].1 = new;
            return Some(());
        }
        if self.frames.in_function() {
            self.report_unknown_name(first, target.span, scope);
            return None;
        }
        let mode = self.mode.reading();
        let selection = self.with_mode(mode, |cx| cx.select_target(target, scope))?;
        let pattern = self.pattern_of_selection(&selection);
        let value = self.fitted(&pattern, &[], value, span)?;
        // Records are taken apart in the order of their fields, as the variables are.
        let mut scalars = Vec::new();
        value.for_each_scalar(&mut |e| scalars.push(e));
        self.assign_selected(&selection, &scalars, target.span)
    }

    /// The scalar variables of a selection, row-major.
    pub(crate) fn selected_variables(
        &mut self,
        selection: &Selection,
        span: Span,
    ) -> Option<Vec<VarId>> {
        let mut out = Vec::new();
        match selection {
            Selection::Whole(id) => match self.instances[*id].kind.clone() {
                InstanceKind::Variable { dims, first: Some(first), .. } => {
                    let n: usize = dims.iter().product();
                    out.extend((0..n as u32).map(|k| VarId(first.0 + k)));
                }
                InstanceKind::Object(children) => {
                    for &child in children.iter() {
                        out.extend(self.selected_variables(&Selection::Whole(child), span)?);
                    }
                }
                InstanceKind::Array { elements, .. } => {
                    for &element in elements.iter() {
                        out.extend(self.selected_variables(&Selection::Whole(element), span)?);
                    }
                }
                _ => {
                    let found = "a component without a value";
                    self.report(NameCause::NotAVariable { found }, span);
                    return None;
                }
            },
            Selection::Element(id, k) => match self.instances[*id].kind {
                InstanceKind::Variable { first: Some(first), .. } => {
                    out.push(VarId(first.0 + *k as u32));
                }
                _ => return None,
            },
            Selection::Many(_, all) | Selection::Dynamic(_, all) => {
                for s in all {
                    out.extend(self.selected_variables(s, span)?);
                }
            }
            Selection::Absent => {
                self.report_absent(span);
                return None;
            }
        }
        Some(out)
    }

    /// `old` with the part that `parts` name replaced; the first part names `old` itself, which has
    /// the `pattern`.
    fn updated(
        &mut self,
        old: &Value,
        pattern: &Pattern,
        parts: &[RefPart],
        value: Value,
        scope: Scope,
        at: Places,
    ) -> Option<Value> {
        let span = at.target;
        let (part, rest) = parts.split_first()?;
        // A field of an array of records is that of each of them.
        let is_of_each = matches!(old, Value::Array(_)) && !rest.is_empty();
        if part.subscripts.is_empty() && !is_of_each {
            let Some(next) = rest.first() else {
                return self.fitted(pattern, old.dims(), value, at.statement);
            };
            let Value::Record(record) = old else {
                self.report(NameCause::NotARecord { name: part.name.name }, span);
                return None;
            };
            let mut fields = record.fields.clone();
            let Some(k) = fields.iter().position(|(n, _)| *n == next.name.name) else {
                let name = next.name.name;
                let names: Vec<&str> = fields.iter().map(|(n, _)| n.as_str()).collect();
                let others = Alternatives::of(name, &names);
                let holder = Holder::Named(part.name.name.to_string());
                self.report(ClassCause::UnknownElement { holder, name, others }, next.name.span);
                return None;
            };
            let pattern = pattern.field(next.name.name);
            fields[k].1 = self.updated(&fields[k].1, &pattern, rest, value, scope, at)?;
            return Some(Value::Record(std::rc::Rc::new(Record { class: record.class, fields })));
        }
        let Value::Array(array) = old else {
            self.report(ArrayCause::NotAnArray { name: part.name.name }, span);
            return None;
        };
        let selectors = self.selectors(&array.dims, &part.subscripts, scope, span)?;
        self.replaced((array, selectors), pattern, parts, value, scope, at)
    }

    /// An array with the elements that selectors select replaced, or what the parts behind the first one name in them.
    fn replaced(
        &mut self,
        (array, selectors): (&Array, Vec<Selector>),
        pattern: &Pattern,
        parts: &[RefPart],
        value: Value,
        scope: Scope,
        at: Places,
    ) -> Option<Value> {
        let span = at.target;
        let (part, rest) = parts.split_first()?;
        let mut elements = array.elements.clone();
        let element = pattern.element();
        let assigned = match one_by_one(&array.dims, &selectors) {
            None => vec![(selectors, value)],
            Some((_, all)) => {
                if value.elements().len() != all.len() {
                    self.report_count(value.elements().len(), all.len(), span);
                    return None;
                }
                let values = value.elements().to_vec();
                all.into_iter().zip(values).collect()
            }
        };
        for (selectors, value) in assigned {
            for (condition, selectors) in self.fixed(&array.dims, &selectors) {
                let (sizes, positions) = positions(&array.dims, &selectors);
                let single = sizes.is_empty() && selectors.len() == array.dims.len();
                let value = match rest.is_empty() {
                    true => {
                        let part = Pattern::array(&sizes, element.clone());
                        self.fitted(&part, &sizes, value.clone(), at.statement)?
                    }
                    false => value.clone(),
                };
                let parts = match single {
                    true => vec![value],
                    false => value.parts(sizes.len()),
                };
                if parts.len() != positions.len() {
                    self.report_count(parts.len(), positions.len(), span);
                    return None;
                }
                for (new, p) in parts.into_iter().zip(&positions) {
                    let new = if rest.is_empty() {
                        new
                    } else {
                        let bare = RefPart { name: part.name, subscripts: Vec::new() };
                        let parts: Vec<RefPart> =
                            std::iter::once(bare).chain(rest.iter().cloned()).collect();
                        self.updated(&elements[*p], &element, &parts, new, scope, at)?
                    };
                    elements[*p] = match condition {
                        Some(c) => self.if_values(c, new, elements[*p].clone(), span)?,
                        None => new,
                    };
                }
            }
        }
        Some(Value::array(array.dims.clone(), elements))
    }
}
