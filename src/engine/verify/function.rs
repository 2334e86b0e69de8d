//! The contract of [`Function`].

use crate::base::index::Id;
use crate::ir::expr::{Graph, Node, Type};
use crate::ir::flat::{Function, Statement};

/// Adds everything in which a function breaks its contract: its variables are its locals.
pub fn check(graph: &Graph, function: &Function, found: &mut Vec<String>) {
    let name = &function.name;
    let locals = function.locals.len();
    if function.inputs.iter().chain(&function.outputs).any(|l| l.idx() >= locals) {
        found.push(format!("`{name}` has an input or output that does not exist"));
    }
    let mut roots = Vec::new();
    function.for_each_expression(&mut |e| roots.push(e));
    if roots.iter().any(|e| e.idx() >= graph.len()) {
        found.push(format!("`{name}` reads an expression that does not exist"));
        return;
    }
    let foreign = graph.any(roots, |_, node| match node {
        Node::Var(v) => v.idx() >= locals,
        Node::Der(_) | Node::Pre(_) | Node::Relation(_) => true,
        _ => false,
    });
    if foreign {
        found.push(format!("`{name}` reads a variable of the model"));
    }
    if assigns_beyond(&function.body, locals) {
        found.push(format!("`{name}` assigns a local that does not exist"));
    }
    if !has_boolean_conditions(graph, &function.body) {
        found.push(format!("`{name}` has a condition that is not Boolean"));
    }
}

fn assigns_beyond(body: &[Statement], locals: usize) -> bool {
    body.iter().any(|statement| match statement {
        Statement::Assign(local, _) => local.idx() >= locals,
        Statement::If(_, a, b) => assigns_beyond(a, locals) || assigns_beyond(b, locals),
        Statement::While(_, a) => assigns_beyond(a, locals),
        Statement::Break | Statement::Return | Statement::Assert(..) => false,
    })
}

fn has_boolean_conditions(graph: &Graph, body: &[Statement]) -> bool {
    body.iter().all(|statement| match statement {
        Statement::If(c, a, b) => {
            graph.ty(*c) == Type::Boolean
                && has_boolean_conditions(graph, a)
                && has_boolean_conditions(graph, b)
        }
        Statement::While(c, a) => graph.ty(*c) == Type::Boolean && has_boolean_conditions(graph, a),
        Statement::Assert(a, _) => {
            graph.ty(a.condition) == Type::Boolean && graph.ty(a.message) == Type::String
        }
        Statement::Assign(..) | Statement::Break | Statement::Return => true,
    })
}
