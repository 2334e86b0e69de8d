//! The iterators in a class definition.

use crate::ir::ast::{
    ArgumentKind, Composition, ElementKind, Equation, EquationKind, Expr, ExprKind, Ident,
    Iterator, Modification, Statement, StatementKind, Subscript,
};

/// All iterators of a class by itself, each with the one of the same name around it.
pub(crate) fn all(composition: &Composition) -> Vec<(Ident, Option<Ident>)> {
    let mut walk = Walk::default();
    for element in &composition.elements {
        match &element.kind {
            ElementKind::Components(clause) => {
                for component in &clause.components {
                    component.modification.iter().for_each(|m| walk.modification(m));
                    component.condition.iter().for_each(|c| walk.expression(c));
                }
            }
            ElementKind::Extends(extends) => {
                extends.modification.iter().for_each(|m| walk.modification(m));
            }
            ElementKind::Import(_) | ElementKind::Class(_) => {}
        }
    }
    for section in &composition.equations {
        walk.equations(&section.equations);
    }
    for section in &composition.algorithms {
        walk.statements(&section.statements);
    }
    walk.found
}

#[derive(Default)]
struct Walk {
    found: Vec<(Ident, Option<Ident>)>,
    /// Those of the loops around, outermost first.
    open: Vec<Ident>,
}

impl Walk {
    fn under(&mut self, iterators: &[Iterator], act: impl FnOnce(&mut Self)) {
        let before = self.open.len();
        for iterator in iterators {
            iterator.range.iter().for_each(|r| self.expression(r));
            let around = self.open.iter().rfind(|i| i.name == iterator.name.name).copied();
            self.found.push((iterator.name, around));
            self.open.push(iterator.name);
        }
        act(self);
        self.open.truncate(before);
    }

    fn modification(&mut self, m: &Modification) {
        m.binding.iter().for_each(|e| self.expression(e));
        for arg in &m.args {
            if let ArgumentKind::Element { modification: Some(inner), .. } = &arg.kind {
                self.modification(inner);
            }
        }
    }

    fn equations(&mut self, list: &[Equation]) {
        for e in list {
            match &e.kind {
                EquationKind::Equal(a, b) => {
                    self.expression(a);
                    self.expression(b);
                }
                EquationKind::If { branches, otherwise } => {
                    for (c, body) in branches {
                        self.expression(c);
                        self.equations(body);
                    }
                    self.equations(otherwise);
                }
                EquationKind::When { branches } => {
                    for (c, body) in branches {
                        self.expression(c);
                        self.equations(body);
                    }
                }
                EquationKind::For { iterators, body } => {
                    self.under(iterators, |walk| walk.equations(body));
                }
                EquationKind::Call(e) => self.expression(e),
                EquationKind::Connect(..) | EquationKind::Broken => {}
            }
        }
    }

    fn statements(&mut self, list: &[Statement]) {
        for s in list {
            match &s.kind {
                StatementKind::Assign(_, e)
                | StatementKind::AssignTuple(_, e)
                | StatementKind::Call(e) => self.expression(e),
                StatementKind::If { branches, otherwise } => {
                    for (c, body) in branches {
                        self.expression(c);
                        self.statements(body);
                    }
                    self.statements(otherwise);
                }
                StatementKind::When { branches } => {
                    for (c, body) in branches {
                        self.expression(c);
                        self.statements(body);
                    }
                }
                StatementKind::For { iterators, body } => {
                    self.under(iterators, |walk| walk.statements(body));
                }
                StatementKind::While { condition, body } => {
                    self.expression(condition);
                    self.statements(body);
                }
                StatementKind::Break | StatementKind::Return | StatementKind::Broken => {}
            }
        }
    }

    fn all(&mut self, list: &[Expr]) {
        list.iter().for_each(|e| self.expression(e));
    }

    fn expression(&mut self, e: &Expr) {
        match &e.kind {
            ExprKind::Reduction { body, iterators, .. }
            | ExprKind::Comprehension { body, iterators } => {
                self.under(iterators, |walk| walk.expression(body));
            }
            ExprKind::Unary(_, a) | ExprKind::Parenthesised(a) => self.expression(a),
            ExprKind::Binary(_, a, b) => {
                self.expression(a);
                self.expression(b);
            }
            ExprKind::If { branches, otherwise } => {
                for (c, v) in branches {
                    self.expression(c);
                    self.expression(v);
                }
                self.expression(otherwise);
            }
            ExprKind::Call { args, named, .. } => {
                self.all(args);
                named.iter().for_each(|(_, a)| self.expression(a));
            }
            ExprKind::Array(list) => self.all(list),
            ExprKind::Matrix(rows) => rows.iter().for_each(|row| self.all(row)),
            ExprKind::Range { start, step, stop } => {
                self.expression(start);
                step.iter().for_each(|s| self.expression(s));
                self.expression(stop);
            }
            ExprKind::Tuple(list) => list.iter().flatten().for_each(|a| self.expression(a)),
            ExprKind::Indexed(a, subscripts) => {
                self.expression(a);
                self.subscripts(subscripts);
            }
            ExprKind::PartialFunction { named, .. } => {
                named.iter().for_each(|(_, a)| self.expression(a));
            }
            ExprKind::Ref(r) => r.parts.iter().for_each(|p| self.subscripts(&p.subscripts)),
            _ => {}
        }
    }

    fn subscripts(&mut self, list: &[Subscript]) {
        for s in list {
            if let Subscript::Expr(e) = s {
                self.expression(e);
            }
        }
    }
}
