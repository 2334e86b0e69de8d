//! Exact derivatives of functions. One without loops and calls gets another function, whose outputs are the partial
//! derivatives of its outputs by its inputs; others get one that computes the derivatives along a direction. Those of
//! loops, and of functions that call themselves, are differences of two calls.
//!
//! Selections are differentiated branch by branch, as in [`super::jacobian`].

use std::collections::BTreeMap;

use crate::base::index::FastMap;
use crate::ir::dae::Dae;
use crate::ir::expr::{Binary, ExprId, FunctionId, Graph, ListId, Node, Type};
use crate::ir::flat::{Function, LocalId, Statement, StraightLine};
use crate::symbolic::function_derivative::{FunctionDerivatives, by_argument};
use crate::symbolic::gradient::partials;

/// The derivatives of one expression by the inputs that it depends on.
type Row = BTreeMap<u32, ExprId>;

/// The functions that compute derivatives.
pub struct Derivatives {
    /// For each function that has one: its derivatives, and the outputs of these by output and input.
    of: FastMap<FunctionId, (FunctionId, FastMap<(u32, u32), u32>)>,
    /// Those along a direction, and differences.
    along: FunctionDerivatives,
    /// The function that each one belongs to.
    primal: FastMap<FunctionId, FunctionId>,
}

impl Derivatives {
    /// The derivative of an output of a call by an argument; `None` if it is zero.
    pub fn of_call(
        &mut self,
        graph: &mut Graph,
        (f, output, argument): (FunctionId, u32, u32),
        args: ListId,
    ) -> Option<ExprId> {
        if let Some((function, outputs)) = self.of.get(&f) {
            let output = *outputs.get(&(output, argument))?;
            let call = Node::Call { function: *function, output, args };
            return Some(graph.intern(call, Type::Real));
        }
        let arguments = graph.list(args).to_vec();
        let by = argument as usize;
        if graph.ty(arguments[by]) != Type::Real {
            return None;
        }
        match self.along.find(f) {
            Some(derivative) => Some(by_argument(graph, derivative, output, &arguments, by)),
            None => self.along.by_difference(graph, (f, output, argument), args),
        }
    }

    /// The function that is called, and of a difference the output and the argument that it differentiates by.
    pub fn called(&self, f: FunctionId) -> (FunctionId, Option<(usize, usize)>) {
        match self.along.difference(f) {
            Some((primal, output, by)) => (primal, Some((output as usize, by as usize))),
            None => (f, None),
        }
    }

    /// The call that a call of a derivative belongs to; others are their own.
    pub fn primal(&self, dae: &mut Dae, f: FunctionId, args: ListId) -> (FunctionId, ListId) {
        let Some(&primal) = self.primal.get(&f) else { return (f, args) };
        let count = dae.functions[primal].inputs.len();
        let args = dae.graph.list(args)[..count].to_vec();
        (primal, dae.graph.intern_list(&args))
    }
}

/// Adds the functions of derivatives to a system.
pub fn add(dae: &mut Dae) -> Derivatives {
    let along = FunctionDerivatives::with_differences();
    let mut found = Derivatives { of: FastMap::default(), along, primal: FastMap::default() };
    for f in dae.functions.ids().collect::<Vec<_>>() {
        let body = dae.functions[f].straight_line();
        let Some(body) = body.filter(|body| is_smooth_by_parts(&dae.graph, body)) else {
            if found.along.add_function(&mut dae.graph, &mut dae.functions, f)
                && let Some(derivative) = found.along.find(f)
            {
                found.primal.insert(derivative, f);
            }
            continue;
        };
        let rows = rows(&mut dae.graph, &dae.functions[f], &body);
        let (function, outputs) = function_of(&mut dae.graph, &dae.functions[f], rows);
        let derivative = dae.functions.push(function);
        found.of.insert(f, (derivative, outputs));
        found.primal.insert(derivative, f);
    }
    found
}

/// Whether a body consists of operators only.
fn is_smooth_by_parts(graph: &Graph, body: &StraightLine) -> bool {
    graph.all(body.outputs.iter().copied(), |_, node| !matches!(node, Node::Call { .. }))
}

/// The derivatives of the outputs by the Real inputs.
fn rows(graph: &mut Graph, function: &Function, body: &StraightLine) -> Vec<Row> {
    let mut done: FastMap<ExprId, Row> = FastMap::default();
    let one = graph.real(1.0);
    for e in graph.postorder(body.outputs.iter().copied()) {
        let row = match graph.node(e) {
            Node::Var(v) => {
                let by = function.inputs.iter().position(|input| input.0 == v.0);
                let by = by.filter(|_| graph.ty(e) == Type::Real);
                by.into_iter().map(|k| (k as u32, one)).collect()
            }
            Node::If(c, a, b) => selection(graph, c, &done[&a], &done[&b]),
            Node::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
                let relation =
                    if op == Binary::Min { Binary::LessEqual } else { Binary::GreaterEqual };
                let c = graph.binary(relation, a, b);
                selection(graph, c, &done[&a], &done[&b])
            }
            _ => {
                let mut depends = false;
                graph.for_each_operand(e, |a| depends |= !done[&a].is_empty());
                let factors = if depends { partials(graph, e, one) } else { Vec::new() };
                let mut row = Row::new();
                for (operand, factor) in factors {
                    for (by, inner) in &done[&operand] {
                        let term = graph.mul(factor, *inner);
                        let sum = row.get(by).map_or(term, |so_far| graph.add(*so_far, term));
                        row.insert(*by, sum);
                    }
                }
                row
            }
        };
        done.insert(e, row);
    }
    body.outputs.iter().map(|e| done[e].clone()).collect()
}

fn selection(graph: &mut Graph, c: ExprId, when_true: &Row, when_false: &Row) -> Row {
    let zero = graph.real(0.0);
    let by: Vec<u32> = when_true.keys().chain(when_false.keys()).copied().collect();
    let side = |row: &Row, k: &u32| row.get(k).copied().unwrap_or(zero);
    by.into_iter()
        .map(|k| (k, graph.if_then_else(c, side(when_true, &k), side(when_false, &k))))
        .collect()
}

/// The function of these derivatives, and their numbers among its outputs.
fn function_of(
    graph: &mut Graph,
    primal: &Function,
    rows: Vec<Row>,
) -> (Function, FastMap<(u32, u32), u32>) {
    let mut locals = primal.locals.clone();
    let mut numbers = FastMap::default();
    let (mut outputs, mut statements) = (Vec::<LocalId>::new(), Vec::new());
    for (output, row) in (0..).zip(rows) {
        for (input, e) in row {
            if graph.as_number(e) == Some(0.0) {
                continue;
            }
            numbers.insert((output, input), outputs.len() as u32);
            let local = locals.push(format!("d{}_{input}", output + 1));
            outputs.push(local);
            statements.push(Statement::Assign(local, e));
        }
    }
    let active = match primal.body.as_slice() {
        [Statement::If(active, ..)] => *active,
        _ => graph.boolean(true),
    };
    let function = Function {
        name: primal.name.clone(),
        span: primal.span,
        inputs: primal.inputs.clone(),
        outputs,
        locals,
        body: vec![Statement::If(active, statements, Vec::new())],
    };
    (function, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::index::{Id, IndexVec};
    use crate::base::source::Span;
    use crate::ir::expr::VarId;

    #[test]
    fn derivatives_of_products_and_selections() {
        let mut g = Graph::new();
        let active = g.var(VarId(0), Type::Boolean);
        let [x, y] = [1, 2].map(|k| g.var(VarId(k), Type::Real));
        let product = g.mul(x, y);
        let larger = g.binary(Binary::Max, x, y);
        let id = LocalId::from_usize;
        let locals: IndexVec<LocalId, String> =
            ["active", "x", "y", "p", "m"].map(str::to_owned).into_iter().collect();
        let assigns = vec![Statement::Assign(id(3), product), Statement::Assign(id(4), larger)];
        let function = Function {
            name: "f".to_owned(),
            span: Span::NONE,
            inputs: [0, 1, 2].map(id).to_vec(),
            outputs: [3, 4].map(id).to_vec(),
            locals,
            body: vec![Statement::If(active, assigns, Vec::new())],
        };
        let body = function.straight_line().expect("assignments only");
        let rows = rows(&mut g, &function, &body);
        let is_x = g.binary(Binary::GreaterEqual, x, y);
        let [zero, one] = [0.0, 1.0].map(|v| g.real(v));
        let by_x = g.if_then_else(is_x, one, zero);
        let by_y = g.if_then_else(is_x, zero, one);
        assert_eq!(rows[0], Row::from([(1, y), (2, x)]));
        assert_eq!(rows[1], Row::from([(1, by_x), (2, by_y)]));
        let (made, numbers) = function_of(&mut g, &function, rows);
        assert_eq!(made.outputs.len(), 4);
        assert_eq!(numbers[&(1, 2)], 3);
    }
}
