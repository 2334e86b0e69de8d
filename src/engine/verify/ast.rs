//! The contract of a syntax tree that was parsed without an error: every node lies inside the node around it,
//! names are not empty, and nothing is broken.

use crate::base::source::Span;
use crate::ir::ast::{
    Argument, ArgumentKind, Class, ClassBody, Composition, Element, ElementKind, Equation,
    EquationKind, Expr, ExprKind, File, Ident, Modification, Statement, StatementKind,
};

/// Everything in which the tree of a file breaks its contract.
pub fn check(file: &File) -> Vec<String> {
    let mut found = Vec::new();
    for class in &file.classes {
        if class.span.file != file.id {
            found.push(format!("class `{}` is in another file", class.name.name));
        }
        self::class(class, class.span, &mut found);
    }
    if file.comments.windows(2).any(|pair| pair[0].span.start > pair[1].span.start) {
        found.push("comments are not in order".to_owned());
    }
    found
}

/// Reports a node that does not lie inside the one around it.
fn inside(around: Span, span: Span, what: &str, found: &mut Vec<String>) {
    let ordered = span.start <= span.end;
    let within = around.start <= span.start && span.end <= around.end;
    if span.file != around.file || !ordered || !within {
        found.push(format!("{what} at {span:?} is not inside {around:?}"));
    }
}

fn ident(around: Span, ident: &Ident, found: &mut Vec<String>) {
    if ident.name.is_empty() {
        found.push(format!("a name at {:?} is empty", ident.span));
    }
    inside(around, ident.span, "a name", found);
}

fn class(class: &Class, around: Span, found: &mut Vec<String>) {
    inside(around, class.span, "a class", found);
    ident(class.span, &class.name, found);
    match &class.body {
        ClassBody::Long(body) => composition(body, class.span, found),
        ClassBody::Short(short) => {
            inside(class.span, short.base.span, "a base class", found);
            modification(short.modification.as_deref(), class.span, found);
        }
        ClassBody::Enumeration(literals) => {
            for literal in literals.iter().flatten() {
                ident(class.span, &literal.name, found);
            }
        }
        ClassBody::PartialDerivative { variables, .. } => {
            variables.iter().for_each(|v| ident(class.span, v, found));
        }
    }
    modification(class.annotation.as_deref(), class.span, found);
}

fn composition(body: &Composition, around: Span, found: &mut Vec<String>) {
    body.elements.iter().for_each(|e| element(e, around, found));
    for section in &body.equations {
        section.equations.iter().for_each(|e| equation(e, around, found));
    }
    for section in &body.algorithms {
        section.statements.iter().for_each(|s| statement(s, around, found));
    }
    if let Some(external) = &body.external {
        inside(around, external.span, "an external clause", found);
    }
}

fn element(element: &Element, around: Span, found: &mut Vec<String>) {
    let span = element.span;
    inside(around, span, "an element", found);
    match &element.kind {
        ElementKind::Import(import) => inside(span, import.path.span, "an import", found),
        ElementKind::Extends(extends) => {
            inside(span, extends.base.span, "a base class", found);
            modification(extends.modification.as_deref(), span, found);
        }
        ElementKind::Class(inner) => class(inner, span, found),
        ElementKind::Components(clause) => {
            inside(span, clause.type_name.span, "a type", found);
            for component in &clause.components {
                ident(span, &component.name, found);
                modification(component.modification.as_deref(), span, found);
                for condition in component.condition.iter() {
                    expression(condition, span, found);
                }
            }
        }
    }
}

fn modification(modification: Option<&Modification>, around: Span, found: &mut Vec<String>) {
    let Some(modification) = modification else { return };
    inside(around, modification.span, "a modification", found);
    for Argument { kind, span, .. } in &modification.args {
        inside(modification.span, *span, "an argument", found);
        match kind {
            ArgumentKind::Element { path, modification, .. } => {
                path.parts.iter().for_each(|part| ident(*span, part, found));
                self::modification(modification.as_deref(), *span, found);
            }
            ArgumentKind::Redeclare(redeclared) => element(redeclared, *span, found),
            ArgumentKind::Removal(_) => {}
        }
    }
    for binding in modification.binding.iter() {
        expression(binding, modification.span, found);
    }
}

fn equation(equation: &Equation, around: Span, found: &mut Vec<String>) {
    let span = equation.span;
    inside(around, span, "an equation", found);
    let block = |equations: &[Equation], found: &mut Vec<String>| {
        equations.iter().for_each(|e| self::equation(e, span, found));
    };
    match &equation.kind {
        EquationKind::Equal(a, b) => [a, b].into_iter().for_each(|e| expression(e, span, found)),
        EquationKind::If { branches, otherwise } => {
            for (condition, equations) in branches {
                expression(condition, span, found);
                block(equations, found);
            }
            block(otherwise, found);
        }
        EquationKind::For { body, .. } => block(body, found),
        EquationKind::When { branches } => {
            for (condition, equations) in branches {
                expression(condition, span, found);
                block(equations, found);
            }
        }
        EquationKind::Connect(a, b) => {
            [a, b].into_iter().for_each(|r| inside(span, r.span, "a connector", found));
        }
        EquationKind::Call(call) => expression(call, span, found),
        EquationKind::Broken => found.push(format!("a broken equation at {span:?}")),
    }
}

fn statement(statement: &Statement, around: Span, found: &mut Vec<String>) {
    let span = statement.span;
    inside(around, span, "a statement", found);
    let block = |statements: &[Statement], found: &mut Vec<String>| {
        statements.iter().for_each(|s| self::statement(s, span, found));
    };
    match &statement.kind {
        StatementKind::Assign(_, e) | StatementKind::AssignTuple(_, e) | StatementKind::Call(e) => {
            expression(e, span, found);
        }
        StatementKind::If { branches, otherwise } => {
            for (condition, statements) in branches {
                expression(condition, span, found);
                block(statements, found);
            }
            block(otherwise, found);
        }
        StatementKind::For { body, .. } => block(body, found),
        StatementKind::While { condition, body } => {
            expression(condition, span, found);
            block(body, found);
        }
        StatementKind::When { branches } => {
            for (condition, statements) in branches {
                expression(condition, span, found);
                block(statements, found);
            }
        }
        StatementKind::Break | StatementKind::Return => {}
        StatementKind::Broken => found.push(format!("a broken statement at {span:?}")),
    }
}

fn expression(e: &Expr, around: Span, found: &mut Vec<String>) {
    let span = e.span;
    inside(around, span, "an expression", found);
    let mut each = |e: &Expr| expression(e, span, found);
    match &e.kind {
        ExprKind::Unary(_, a) | ExprKind::Parenthesised(a) | ExprKind::Indexed(a, _) => each(a),
        ExprKind::Reduction { body, .. } | ExprKind::Comprehension { body, .. } => each(body),
        ExprKind::Binary(_, a, b) => [a, b].into_iter().for_each(|e| each(e)),
        ExprKind::If { branches, otherwise } => {
            for (condition, value) in branches {
                each(condition);
                each(value);
            }
            each(otherwise);
        }
        ExprKind::Call { args, named, .. } => {
            args.iter().chain(named.iter().map(|(_, e)| e)).for_each(each);
        }
        ExprKind::PartialFunction { named, .. } => named.iter().for_each(|(_, e)| each(e)),
        ExprKind::Array(all) => all.iter().for_each(each),
        ExprKind::Matrix(rows) => rows.iter().flatten().for_each(each),
        ExprKind::Tuple(all) => all.iter().flatten().for_each(each),
        ExprKind::Range { start, step, stop } => {
            each(start);
            step.iter().for_each(|e| each(e));
            each(stop);
        }
        ExprKind::Real(_)
        | ExprKind::Integer(_)
        | ExprKind::String(_)
        | ExprKind::Boolean(_)
        | ExprKind::Ref(_)
        | ExprKind::End
        | ExprKind::Break => {}
        ExprKind::Broken => found.push(format!("a broken expression at {span:?}")),
    }
}
