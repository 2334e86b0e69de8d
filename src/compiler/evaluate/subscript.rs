//! Subscripts of arrays, known before simulation or at run time (section 10.5 of the
//! specification).

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::types::Expected;
use super::reference::{Selection, many};
use super::value::Value;
use crate::base::source::Span;
use crate::ir::ast::Subscript;
use crate::ir::expr::{Const, ExprId, Type};
use crate::ir::instance::Scope;

/// One subscript, evaluated.
#[derive(Clone, Debug)]
pub(super) enum Selector {
    One(usize),
    Many(Vec<usize>),
    /// Known only when the model runs.
    Dynamic(ExprId),
    /// Several, of which some are known only when the model runs.
    Each(Vec<Selector>),
}

impl Selector {
    /// True if the selected element is known only at run time.
    pub(super) fn is_dynamic(&self) -> bool {
        matches!(self, Selector::Dynamic(_) | Selector::Each(_))
    }
}

impl Evaluator<'_> {
    /// Evaluates a subscript in which `end` stands for a size.
    pub(crate) fn with_end<T>(&mut self, size: usize, act: impl FnOnce(&mut Self) -> T) -> T {
        self.ends.push(size);
        let result = act(self);
        self.ends.pop();
        result
    }

    /// Applies subscripts to a value.
    pub(crate) fn subscripted(
        &mut self,
        value: Value,
        subscripts: &[Subscript],
        scope: Scope,
        span: Span,
    ) -> Option<Value> {
        if subscripts.is_empty() {
            return Some(value);
        }
        let selectors = self.selectors(value.dims(), subscripts, scope, span)?;
        self.apply(&value, &selectors, span)
    }

    /// Applies subscripts of a field to its values in an array of records with so many dimensions, each of which is kept
    /// (section 10.6.1).
    pub(super) fn subscripted_within(
        &mut self,
        value: Value,
        outer: usize,
        subscripts: &[Subscript],
        scope: Scope,
        span: Span,
    ) -> Option<Value> {
        if subscripts.is_empty() || value.elements().is_empty() {
            return Some(value);
        }
        let (kept, own) = value.dims().split_at(outer);
        let whole = kept.iter().map(|size| Selector::Many((1..=*size).collect()));
        let mut selectors: Vec<Selector> = whole.collect();
        selectors.extend(self.selectors(own, subscripts, scope, span)?);
        self.apply(&value, &selectors, span)
    }

    /// The selection of an array of the given sizes; `element` returns the one at a position.
    pub(super) fn selected(
        &mut self,
        dims: &[usize],
        mut selectors: Vec<Selector>,
        element: &mut dyn FnMut(&mut Self, usize) -> Option<Selection>,
    ) -> Option<Selection> {
        if let Some((sizes, all)) = one_by_one(dims, &selectors) {
            let all = all.into_iter().map(|one| self.selected(dims, one, element));
            return Some(many(sizes, all.collect::<Option<_>>()?));
        }
        let dynamic = selectors.iter().enumerate().find_map(|(k, s)| match s {
            Selector::Dynamic(e) => Some((k, *e)),
            _ => None,
        });
        if let Some((k, e)) = dynamic {
            let mut all = Vec::with_capacity(dims[k]);
            for i in 1..=dims[k] {
                selectors[k] = Selector::One(i);
                all.push(self.selected(dims, selectors.clone(), element)?);
            }
            return Some(Selection::Dynamic(e, all));
        }
        let (sizes, positions) = positions(dims, &selectors);
        let all = positions.into_iter().map(|k| element(self, k)).collect::<Option<_>>()?;
        Some(many(sizes, all))
    }

    pub(super) fn selectors(
        &mut self,
        dims: &[usize],
        subscripts: &[Subscript],
        scope: Scope,
        span: Span,
    ) -> Option<Vec<Selector>> {
        if subscripts.len() > dims.len() {
            let (given, dimensions) = (subscripts.len(), dims.len());
            self.report(ArrayCause::TooManySubscripts { given, dimensions }, span);
            return None;
        }
        let mut out = Vec::with_capacity(subscripts.len());
        for (k, s) in subscripts.iter().enumerate() {
            out.push(match s {
                Subscript::Colon(_) => Selector::Many((1..=dims[k]).collect()),
                Subscript::Expr(e) => {
                    let mode = self.mode.subscript();
                    let value = self
                        .with_end(dims[k], |cx| cx.with_mode(mode, |cx| cx.evaluate(e, scope)))?;
                    self.selector(&value, dims[k], e.span, span)?
                }
            });
        }
        Some(out)
    }

    /// One subscript of a dimension of the given size; `array` is the place of the whole reference.
    pub(super) fn selector(
        &mut self,
        value: &Value,
        size: usize,
        span: Span,
        array: Span,
    ) -> Option<Selector> {
        let mut all = Vec::with_capacity(value.elements().len());
        for element in value.elements() {
            let e = match element {
                Value::Scalar(e) if !matches!(self.graph.ty(*e), Type::Real | Type::String) => *e,
                other => {
                    self.report_type(Expected::Subscript, other, span);
                    return None;
                }
            };
            all.push(match self.structural_value(e) {
                Some(c) => Selector::One(self.position(c, size, span)?),
                None => {
                    self.assert_in_bounds(e, size, span, array)?;
                    Selector::Dynamic(e)
                }
            });
        }
        if value.dims().is_empty() {
            return all.pop();
        }
        let known = |s: &Selector| match s {
            Selector::One(i) => Some(*i),
            _ => None,
        };
        let positions: Option<Vec<usize>> = all.iter().map(known).collect();
        Some(positions.map_or(Selector::Each(all), Selector::Many))
    }

    /// The position, from 1, that a subscript means in a dimension of the given size.
    pub(super) fn position(&mut self, subscript: Const, size: usize, span: Span) -> Option<usize> {
        let i = match subscript {
            Const::Integer(i) => i,
            Const::Enumeration(_, k) => i64::from(k),
            Const::Boolean(b) => i64::from(b) + 1,
            other => {
                let other = Value::Scalar(self.graph.constant(other));
                self.report_type(Expected::Subscript, &other, span);
                return None;
            }
        };
        if i < 1 || i as usize > size {
            // In inactive code, and where only sizes matter, any position serves.
            if size > 0 && (self.is_unreached() || self.mode.sizes) {
                return Some(1);
            }
            let subscript = i.to_string();
            self.report(ArrayCause::OutOfBounds { subscript, size, array: None }, span);
            return None;
        }
        Some(i as usize)
    }

    pub(super) fn apply(
        &mut self,
        value: &Value,
        selectors: &[Selector],
        span: Span,
    ) -> Option<Value> {
        let Some((first, rest)) = selectors.split_first() else { return Some(value.clone()) };
        let dims = value.dims().to_vec();
        let part = |i: usize| value.select(&[i]);
        match first {
            Selector::One(i) => self.apply(&part(*i)?, rest, span),
            Selector::Many(list) => {
                let parts = list
                    .iter()
                    .map(|i| self.apply(&part(*i)?, rest, span))
                    .collect::<Option<Vec<_>>>()?;
                if parts.is_empty() {
                    let others = dims.iter().enumerate().skip(1);
                    let sizes = others.filter_map(|(k, size)| match rest.get(k - 1) {
                        Some(Selector::One(_) | Selector::Dynamic(_)) => None,
                        Some(Selector::Many(list)) => Some(list.len()),
                        Some(Selector::Each(all)) => Some(all.len()),
                        None => Some(*size),
                    });
                    let sizes = std::iter::once(0).chain(sizes).collect();
                    return Some(Value::array(sizes, Vec::new()));
                }
                self.stack(parts, span)
            }
            Selector::Each(all) => {
                let mut parts = Vec::with_capacity(all.len());
                for one in all {
                    let selectors: Vec<Selector> =
                        std::iter::once(one).chain(rest).cloned().collect();
                    parts.push(self.apply(value, &selectors, span)?);
                }
                self.stack(parts, span)
            }
            Selector::Dynamic(e) => {
                let parts = (1..=dims[0])
                    .map(|i| self.apply(&part(i)?, rest, span))
                    .collect::<Option<Vec<_>>>()?;
                self.choose(*e, &parts, span)
            }
        }
    }
}

/// The position of the only element that selectors select, if all are known.
pub(super) fn element_position(dims: &[usize], selectors: &[Selector]) -> Option<usize> {
    if selectors.len() != dims.len() {
        return None;
    }
    selectors.iter().zip(dims).try_fold(0, |at, (selector, size)| match selector {
        Selector::One(i) => Some(at * size + (i - 1)),
        _ => None,
    })
}

/// If one of the selectors selects several elements known only at run time: the sizes of the
/// selection, and selectors for each of its scalars, row-major.
pub(super) fn one_by_one(
    dims: &[usize],
    selectors: &[Selector],
) -> Option<(Vec<usize>, Vec<Vec<Selector>>)> {
    if !selectors.iter().any(|s| matches!(s, Selector::Each(_))) {
        return None;
    }
    let mut sizes = Vec::new();
    let mut all = vec![Vec::with_capacity(dims.len())];
    for (k, &size) in dims.iter().enumerate() {
        let choices: Vec<Selector> = match selectors.get(k) {
            Some(Selector::Many(list)) => list.iter().map(|i| Selector::One(*i)).collect(),
            Some(Selector::Each(each)) => each.clone(),
            None => (1..=size).map(Selector::One).collect(),
            Some(one) => vec![one.clone()],
        };
        if !matches!(selectors.get(k), Some(Selector::One(_) | Selector::Dynamic(_))) {
            sizes.push(choices.len());
        }
        let longer = |list: &Vec<Selector>, choice: &Selector| {
            list.iter().chain(std::iter::once(choice)).cloned().collect::<Vec<_>>()
        };
        all = all
            .iter()
            .flat_map(|list| choices.iter().map(|c| longer(list, c)).collect::<Vec<_>>())
            .collect();
    }
    Some((sizes, all))
}

/// Positions that known selectors select in an array of the given sizes, with the sizes that result.
pub(super) fn positions(dims: &[usize], selectors: &[Selector]) -> (Vec<usize>, Vec<usize>) {
    let mut sizes = Vec::new();
    let mut positions = vec![0];
    for (k, &size) in dims.iter().enumerate() {
        let all: Vec<usize>;
        let list: &[usize] = match selectors.get(k) {
            Some(Selector::One(i)) => std::slice::from_ref(i),
            Some(Selector::Many(list)) => {
                sizes.push(list.len());
                list
            }
            Some(Selector::Dynamic(_) | Selector::Each(_)) | None => {
                sizes.push(size);
                all = (1..=size).collect();
                &all
            }
        };
        let wider = |at: &usize| list.iter().map(|i| at * size + (i - 1)).collect::<Vec<_>>();
        positions = positions.iter().flat_map(wider).collect();
    }
    (sizes, positions)
}
