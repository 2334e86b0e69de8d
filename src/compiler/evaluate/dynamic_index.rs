//! Elements whose subscripts are known only at run time (section 10.5 of the specification). A read
//! selects among all candidates; an assignment goes to each candidate under its condition and
//! leaves the others as they were.

use std::sync::Arc;

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::reference::Selection;
use super::subscript::Selector;
use super::value::Value;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::external::array_access::ArrayAccess;
use crate::ir::ast::ComponentRef;
use crate::ir::expr::{Binary, Const, ExprId, Type, Unary, VarId};
use crate::ir::flat::AssertionLevel;
use crate::ir::instance::{InstanceKind, Scope};

/// So many numbers are looked up in a table.
const MANY: usize = 8;

/// Elements that are chosen one after the other.
const DEEP: usize = 64;

/// A scalar that may be meant, and where it is; `None` for one that always is.
type Alternative = (Option<ExprId>, VarId);

impl Evaluator<'_> {
    /// The components that a reference names, for `connect`, `der`, and left sides of equations.
    pub(crate) fn select(&mut self, r: &ComponentRef, scope: Scope) -> Option<Selection> {
        let selection = self.select_target(r, scope)?;
        if selection.is_dynamic() {
            self.unsupported(r.span, Construct::DynamicComponents);
            return None;
        }
        Some(selection)
    }

    /// Whether `e` is the `k`-th subscript, from 1: an Integer, a literal, or `false` before `true`.
    fn is_subscript(&mut self, e: ExprId, k: usize) -> ExprId {
        let subscript = match self.graph.ty(e) {
            Type::Boolean if k == 1 => return self.graph.not(e),
            Type::Boolean => return e,
            Type::Enumeration(id) => self.graph.constant(Const::Enumeration(id, k as u32)),
            _ => self.graph.integer(k as i64),
        };
        self.graph.binary(Binary::Equal, e, subscript)
    }

    /// Asserts that a subscript known only at run time is one of `1:size`. All values of an index
    /// type are.
    pub(crate) fn assert_in_bounds(
        &mut self,
        e: ExprId,
        size: usize,
        span: Span,
        array: Span,
    ) -> Option<()> {
        if self.graph.ty(e) != Type::Integer {
            return Some(());
        }
        let text = |at: Span| self.sources.text(at).unwrap_or("?");
        let (subscript, array) = (text(span), text(array));
        if size == 0 && !self.is_unreached() {
            let (subscript, array) = (subscript.to_string(), Some(array.to_string()));
            self.report(ArrayCause::OutOfBounds { subscript, size, array }, span);
            return None;
        }
        let message = format!("subscript `{subscript}` of `{array}` is outside 1 to {size}");
        let message = self.graph.string(&message);
        let (first, last) = (self.graph.integer(1), self.graph.integer(size as i64));
        let above = self.graph.binary(Binary::GreaterEqual, e, first);
        let below = self.graph.binary(Binary::LessEqual, e, last);
        let inside = self.graph.and(above, below);
        self.assert_now_or_later(inside, message, AssertionLevel::Error, span)
    }

    /// `if e == 1 then parts[0] elseif ... else the last`.
    pub(crate) fn choose(&mut self, e: ExprId, parts: &[Value], span: Span) -> Option<Value> {
        match self.chosen_number(e, parts) {
            Some(value) => Some(value),
            None => self.choose_from(e, 1, parts, span),
        }
    }

    /// As `choose`, with subscripts that begin at `first`: many are bisected, so that neither the
    /// printed expression nor the search is deep.
    fn choose_from(
        &mut self,
        e: ExprId,
        first: usize,
        parts: &[Value],
        span: Span,
    ) -> Option<Value> {
        if parts.len() > DEEP && self.graph.ty(e) == Type::Integer {
            let (low, high) = parts.split_at(parts.len() / 2);
            let last = self.graph.integer((first + low.len()) as i64 - 1);
            let is_low = self.graph.binary(Binary::LessEqual, e, last);
            let low_value = self.choose_from(e, first, low, span)?;
            let high_value = self.choose_from(e, first + low.len(), high, span)?;
            return self.if_values(is_low, low_value, high_value, span);
        }
        let (last, firsts) = parts.split_last()?;
        let mut result = last.clone();
        for (k, part) in firsts.iter().enumerate().rev() {
            let condition = self.is_subscript(e, first + k);
            result = self.if_values(condition, part.clone(), result, span)?;
        }
        Some(result)
    }

    /// As `choose`, of many that are known numbers: a table of them.
    fn chosen_number(&mut self, e: ExprId, parts: &[Value]) -> Option<Value> {
        if parts.len() < MANY || self.graph.ty(e) != Type::Integer {
            return None;
        }
        let first = &parts[0];
        let width = first.elements().len();
        let mut columns = vec![Vec::with_capacity(parts.len()); width];
        let mut whole = vec![true; width];
        for part in parts {
            if part.dims() != first.dims() || part.elements().len() != width {
                return None;
            }
            for (k, element) in part.elements().iter().enumerate() {
                let number = self.graph.as_const(element.scalar()?)?;
                whole[k] &= matches!(number, Const::Integer(_));
                columns[k].push(number.number()?);
            }
        }
        let mut chosen = columns.into_iter().zip(whole).map(|(column, whole)| {
            let access = ArrayAccess { elements: column, is_integer: whole };
            let access = self.graph.add_external(Arc::new(access));
            self.graph.unary(Unary::External(access), e)
        });
        Some(first.each_scalar(&mut |e| chosen.next().unwrap_or(e)))
    }

    /// The candidates of selectors: the condition for each, and selectors that are all known.
    pub(super) fn fixed(
        &mut self,
        dims: &[usize],
        selectors: &[Selector],
    ) -> Vec<(Option<ExprId>, Vec<Selector>)> {
        let mut all = vec![(None, Vec::with_capacity(selectors.len()))];
        for (k, selector) in selectors.iter().enumerate() {
            let Selector::Dynamic(e) = *selector else {
                all.iter_mut().for_each(|(_, list)| list.push(selector.clone()));
                continue;
            };
            let mut wider = Vec::with_capacity(all.len() * dims[k]);
            for (condition, list) in all {
                for i in 1..=dims[k] {
                    let here = self.is_subscript(e, i);
                    let here = condition.map_or(here, |c| self.graph.and(c, here));
                    let mut longer = list.clone();
                    longer.push(Selector::One(i));
                    wider.push((Some(here), longer));
                }
            }
            all = wider;
        }
        all
    }

    /// Assigns scalars to the variables of a selection, row-major.
    pub(crate) fn assign_selected(
        &mut self,
        selection: &Selection,
        scalars: &[ExprId],
        span: Span,
    ) -> Option<()> {
        let targets = self.alternatives(selection, span)?;
        if scalars.len() != targets.len() {
            self.report_count(scalars.len(), targets.len(), span);
            return None;
        }
        for (target, &e) in targets.iter().zip(scalars) {
            for &(condition, v) in target {
                self.assign_variable(condition, v, e)?;
            }
        }
        Some(())
    }

    pub(crate) fn report_count(&mut self, values: usize, targets: usize, span: Span) {
        self.report(ArrayCause::AssignedCount { values, targets }, span);
    }

    fn assign_variable(
        &mut self,
        condition: Option<ExprId>,
        v: VarId,
        mut e: ExprId,
    ) -> Option<()> {
        let before = self.assigned.get(&v).copied();
        // Statements after `break` leave a variable as it was.
        if let Some(before) = before {
            for left in self.exits.all() {
                e = self.graph.if_then_else(left, before, e);
            }
        }
        if let Some(condition) = condition {
            let before = match before {
                Some(before) => before,
                None => self.variable_itself(v)?,
            };
            e = self.graph.if_then_else(condition, e, before);
        }
        self.assigned.insert(v, e);
        Some(())
    }

    /// A variable as an expression: the value before it is assigned.
    pub(crate) fn variable_itself(&mut self, v: VarId) -> Option<ExprId> {
        let (id, _) = *self.instance_of.get(v.0 as usize)?;
        match self.instances[id].kind {
            InstanceKind::Variable { ty, .. } => Some(self.graph.var(v, ty)),
            _ => None,
        }
    }

    /// Each scalar of a selection: the variables that it may be.
    fn alternatives(&mut self, selection: &Selection, span: Span) -> Option<Vec<Vec<Alternative>>> {
        match selection {
            Selection::Dynamic(e, all) => {
                let mut merged: Vec<Vec<Alternative>> = Vec::new();
                for (k, part) in all.iter().enumerate() {
                    let here = self.is_subscript(*e, k + 1);
                    let inner = self.alternatives(part, span)?;
                    merged.resize(inner.len(), Vec::new());
                    for (into, from) in merged.iter_mut().zip(inner) {
                        into.extend(
                            from.into_iter().map(|(c, v)| {
                                (Some(c.map_or(here, |c| self.graph.and(here, c))), v)
                            }),
                        );
                    }
                }
                Some(merged)
            }
            Selection::Many(_, all) if selection.is_dynamic() => {
                let mut out = Vec::new();
                for part in all {
                    out.extend(self.alternatives(part, span)?);
                }
                Some(out)
            }
            _ => {
                let variables = self.selected_variables(selection, span)?;
                Some(variables.into_iter().map(|v| vec![(None, v)]).collect())
            }
        }
    }
}

impl Selection {
    /// True if the selection is known only at run time.
    fn is_dynamic(&self) -> bool {
        match self {
            Selection::Dynamic(..) => true,
            Selection::Many(_, all) => all.iter().any(Selection::is_dynamic),
            Selection::Whole(_) | Selection::Element(..) | Selection::Absent => false,
        }
    }
}
