//! Iterators without a range: they run over the dimension that they are a subscript of (section
//! 11.2.2.1 of the specification).
//!
//! Such an iterator is given the range `1:size(x, k)` as if it had been written. An array over `Boolean`
//! or an enumeration is given the type itself, so that the iterator has its values.

use super::Evaluator;
use super::cause::array::ArrayCause;
use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::base::name::{Name, name};
use crate::ir::ast::{
    ComponentRef, Equation, EquationKind, Expr, ExprKind, Ident, Iterator, RefPart, Statement,
    StatementKind, Subscript,
};
use crate::ir::instance::{InstanceKind, Scope};

/// The code in the scope of the iterators.
#[derive(Clone, Copy)]
pub(crate) enum Body<'a> {
    /// A loop of equations.
    Equations(&'a [Equation]),
    /// A loop of statements.
    Statements(&'a [Statement]),
    /// A reduction or an array of expressions.
    Expression(&'a Expr),
}

impl Evaluator<'_> {
    /// The iterators with ranges; `None` after an error.
    pub(crate) fn with_ranges(
        &mut self,
        iterators: &[Iterator],
        body: Body<'_>,
        scope: Scope,
    ) -> Option<Vec<Iterator>> {
        let mut out = Vec::with_capacity(iterators.len());
        for iterator in iterators {
            let range = match &iterator.range {
                Some(range) => range.clone(),
                None => self.deduced(iterator.name, body, scope)?,
            };
            out.push(Iterator { name: iterator.name, range: Some(range) });
        }
        Some(out)
    }

    fn deduced(&mut self, iterator: Ident, body: Body<'_>, scope: Scope) -> Option<Expr> {
        let mut used: Option<(ComponentRef, usize)> = None;
        let mut see = |r: &ComponentRef| {
            for (p, part) in r.parts.iter().enumerate() {
                for (k, s) in part.subscripts.iter().enumerate() {
                    let Subscript::Expr(Expr { kind: ExprKind::Ref(i), .. }) = s else { continue };
                    if used.is_none() && i.simple().is_some_and(|n| n == iterator.name) {
                        let mut parts = r.parts[..=p].to_vec();
                        parts[p].subscripts.clear();
                        used = Some((ComponentRef { parts, ..r.clone() }, k));
                    }
                }
            }
        };
        match body {
            Body::Equations(list) => in_equations(list, &mut see),
            Body::Statements(list) => in_statements(list, &mut see),
            Body::Expression(e) => in_expression(e, &mut see),
        }
        let Some((array, k)) = used else {
            let cause = ArrayCause::NoIterationRange { name: iterator.name };
            self.problems.push(
                Diagnostic::new(cause, iterator.span)
                    .label("without a range")
                    .note("the range is that of the dimension it is a subscript of"),
            );
            return None;
        };
        let span = iterator.span;
        let plain = |kind| Expr { kind, span };
        if let Some(of_type) = self.index_type(&array, k, scope) {
            return Some(plain(ExprKind::Ref(of_type)));
        }
        let function = ComponentRef {
            global: false,
            parts: vec![RefPart { name: Ident { name: name("size"), span }, subscripts: vec![] }],
            span,
        };
        let args = vec![plain(ExprKind::Ref(array)), plain(ExprKind::Integer(k as i64 + 1))];
        let size = plain(ExprKind::Call { function, args, named: Vec::new() });
        let one = Box::new(plain(ExprKind::Integer(1)));
        Some(plain(ExprKind::Range { start: one, step: None, stop: Box::new(size) }))
    }

    /// The enumeration or `Boolean` that dimension `k` of a component of the instance is declared over.
    fn index_type(&mut self, array: &ComponentRef, k: usize, scope: Scope) -> Option<ComponentRef> {
        let [part] = array.parts.as_slice() else { return None };
        if self.frames.in_function() {
            return None;
        }
        let id = self.child(scope.instance, part.name.name)?;
        if !matches!(self.instances[id].kind, InstanceKind::Variable { .. }) {
            return None;
        }
        let declaration = self.instances[id].declaration.clone()?;
        let clause = declaration.clause();
        let mut dims = declaration.component().dims.iter().chain(&clause.type_dims);
        let Some(Subscript::Expr(Expr { kind: ExprKind::Ref(named), .. })) = dims.nth(k) else {
            return None;
        };
        let holder = self.instances[id].scope;
        self.type_size(named, holder)?;
        // Where the loop is evaluated, the name must denote the same type.
        (self.type_size(named, scope) == self.type_size(named, holder)).then(|| named.clone())
    }
}

type See<'s> = dyn FnMut(&ComponentRef) + 's;

fn in_equations(list: &[Equation], see: &mut See<'_>) {
    for e in list {
        match &e.kind {
            EquationKind::Equal(a, b) => {
                in_expression(a, see);
                in_expression(b, see);
            }
            EquationKind::If { branches, otherwise } => {
                for (c, body) in branches {
                    in_expression(c, see);
                    in_equations(body, see);
                }
                in_equations(otherwise, see);
            }
            EquationKind::For { body, .. } => in_equations(body, see),
            EquationKind::When { branches } => {
                for (c, body) in branches {
                    in_expression(c, see);
                    in_equations(body, see);
                }
            }
            EquationKind::Connect(a, b) => {
                in_reference(a, see);
                in_reference(b, see);
            }
            EquationKind::Call(e) => in_expression(e, see),
            EquationKind::Broken => {}
        }
    }
}

fn in_statements(list: &[Statement], see: &mut See<'_>) {
    for s in list {
        match &s.kind {
            StatementKind::Assign(r, e) => {
                in_reference(r, see);
                in_expression(e, see);
            }
            StatementKind::AssignTuple(all, e) => {
                all.iter().flatten().for_each(|r| in_reference(r, see));
                in_expression(e, see);
            }
            StatementKind::Call(e) => in_expression(e, see),
            StatementKind::If { branches, otherwise } => {
                for (c, body) in branches {
                    in_expression(c, see);
                    in_statements(body, see);
                }
                in_statements(otherwise, see);
            }
            StatementKind::For { body, .. } => in_statements(body, see),
            StatementKind::While { condition, body } => {
                in_expression(condition, see);
                in_statements(body, see);
            }
            StatementKind::When { branches } => {
                for (c, body) in branches {
                    in_expression(c, see);
                    in_statements(body, see);
                }
            }
            StatementKind::Break | StatementKind::Return | StatementKind::Broken => {}
        }
    }
}

fn in_reference(r: &ComponentRef, see: &mut See<'_>) {
    walk_reference(r, true, see);
}

/// The names of the variables that statements assign.
pub(crate) fn assigned(list: &[Statement], names: &mut FastSet<Name>) {
    for s in list {
        match &s.kind {
            StatementKind::Assign(to, _) => {
                names.insert(to.parts[0].name.name);
            }
            StatementKind::AssignTuple(all, _) => {
                names.extend(all.iter().flatten().map(|to| to.parts[0].name.name));
            }
            StatementKind::If { branches, otherwise } => {
                branches.iter().for_each(|(_, body)| assigned(body, names));
                assigned(otherwise, names);
            }
            StatementKind::For { body, .. } | StatementKind::While { body, .. } => {
                assigned(body, names);
            }
            _ => {}
        }
    }
}

/// Calls `see` with every reference in an expression.
pub(crate) fn in_expression(e: &Expr, see: &mut See<'_>) {
    walk(e, true, see);
}

/// Calls `see` with every reference in an expression whose value matters, and not only its size.
pub(crate) fn in_values(e: &Expr, see: &mut See<'_>) {
    walk(e, false, see);
}

fn is_size(function: &ComponentRef) -> bool {
    function.simple().is_some_and(|name| matches!(name.as_str(), "size" | "ndims"))
}

fn walk(e: &Expr, of_sizes: bool, see: &mut See<'_>) {
    match &e.kind {
        ExprKind::Ref(r) => walk_reference(r, of_sizes, see),
        ExprKind::Unary(_, a) | ExprKind::Parenthesised(a) => walk(a, of_sizes, see),
        ExprKind::Binary(_, a, b) => {
            walk(a, of_sizes, see);
            walk(b, of_sizes, see);
        }
        ExprKind::If { branches, otherwise } => {
            for (c, v) in branches {
                walk(c, of_sizes, see);
                walk(v, of_sizes, see);
            }
            walk(otherwise, of_sizes, see);
        }
        ExprKind::Call { function, .. } if !of_sizes && is_size(function) => {}
        ExprKind::Call { args, named, .. } => {
            args.iter().for_each(|a| walk(a, of_sizes, see));
            named.iter().for_each(|(_, a)| walk(a, of_sizes, see));
        }
        ExprKind::Reduction { body, .. } | ExprKind::Comprehension { body, .. } => {
            walk(body, of_sizes, see);
        }
        ExprKind::Array(list) => list.iter().for_each(|a| walk(a, of_sizes, see)),
        ExprKind::Matrix(rows) => rows.iter().flatten().for_each(|a| walk(a, of_sizes, see)),
        ExprKind::Range { start, step, stop } => {
            walk(start, of_sizes, see);
            step.iter().for_each(|s| walk(s, of_sizes, see));
            walk(stop, of_sizes, see);
        }
        ExprKind::Tuple(list) => list.iter().flatten().for_each(|a| walk(a, of_sizes, see)),
        ExprKind::Indexed(a, subscripts) => {
            walk(a, of_sizes, see);
            for s in subscripts {
                if let Subscript::Expr(e) = s {
                    walk(e, of_sizes, see);
                }
            }
        }
        ExprKind::PartialFunction { named, .. } => {
            named.iter().for_each(|(_, a)| walk(a, of_sizes, see));
        }
        _ => {}
    }
}

fn walk_reference(r: &ComponentRef, of_sizes: bool, see: &mut See<'_>) {
    see(r);
    for s in r.parts.iter().flat_map(|p| &p.subscripts) {
        if let Subscript::Expr(e) = s {
            walk(e, of_sizes, see);
        }
    }
}
