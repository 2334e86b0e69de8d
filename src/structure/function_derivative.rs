//! Derivatives of functions with loops: an equation that calls one can be differentiated, because
//! the function gets another one that computes its derivative along a direction.
//!
//! Forward accumulation through the statements (Griewank & Walther, *Evaluating Derivatives*, 2nd
//! ed., ch. 6.2): each Real local has a rate, which every assignment sets before the local itself,
//! and conditions stay. So the derivative is that of the path that the arguments take, as for an
//! if-expression. Functions that call themselves stay without derivative.

use crate::base::index::{FastMap, FastSet, Id, IndexVec};
use crate::ir::dae::{Dae, EqId};
use crate::ir::expr::{ExprId, FunctionId, Graph, Node, Type, VarId};
use crate::ir::flat::{Function, LocalId, Statement};
use crate::symbolic::gradient::{CallRate, Leaf, forward_derivative_through};

/// The functions of derivatives, by the functions that they belong to.
#[derive(Default)]
pub struct FunctionDerivatives(FastMap<FunctionId, FunctionId>);

impl FunctionDerivatives {
    /// Whether all functions that an equation calls have one.
    pub fn cover(&self, dae: &Dae, equation: EqId) -> bool {
        called(&dae.graph, [dae.equations[equation].residual])
            .iter()
            .all(|f| self.0.contains_key(f))
    }

    /// Adds those of the functions that an equation calls; false if one cannot have any.
    pub fn add(&mut self, dae: &mut Dae, equation: EqId) -> bool {
        let functions = called(&dae.graph, [dae.equations[equation].residual]);
        functions.into_iter().all(|f| self.add_function(dae, f, &mut FastSet::default()))
    }

    fn add_function(
        &mut self,
        dae: &mut Dae,
        f: FunctionId,
        open: &mut FastSet<FunctionId>,
    ) -> bool {
        if self.0.contains_key(&f) {
            return true;
        }
        if dae.functions.get(f).is_none() || !open.insert(f) {
            return false;
        }
        let values = dae.functions[f].values();
        if dae.graph.any(values.iter().copied(), |_, node| matches!(node, Node::Homotopy(..))) {
            return false;
        }
        for inner in called(&dae.graph, values) {
            if !self.add_function(dae, inner, open) {
                return false;
            }
        }
        let function = dae.functions[f].clone();
        let derivative = self.of_function(&mut dae.graph, &function);
        let derivative = dae.functions.push(derivative);
        self.0.insert(f, derivative);
        open.remove(&f);
        true
    }

    /// The derivative of a call in an equation: the sum over the arguments that vary, so that it
    /// stays linear in their rates.
    pub fn of_call(&self, graph: &mut Graph, call: &CallRate<'_>) -> Option<ExprId> {
        let derivative = *self.0.get(&call.function)?;
        let (zero, one) = (graph.real(0.0), graph.real(1.0));
        let mut terms = Vec::new();
        for (k, rate) in call.rates.iter().enumerate() {
            let Some(rate) = *rate else { continue };
            if graph.ty(call.args[k]) != Type::Real {
                continue;
            }
            let mut args = call.args.to_vec();
            args.extend((0..call.args.len()).map(|j| if j == k { one } else { zero }));
            let partial = result(graph, derivative, call.output, &args);
            terms.push(graph.mul(partial, rate));
        }
        if terms.is_empty() { None } else { Some(graph.sum(terms)) }
    }

    /// The derivative of a call in a function, along the direction of the rates.
    fn along(&self, graph: &mut Graph, call: &CallRate<'_>) -> Option<ExprId> {
        let derivative = *self.0.get(&call.function)?;
        if call.rates.iter().all(Option::is_none) {
            return None;
        }
        let zero = graph.real(0.0);
        let mut args = call.args.to_vec();
        args.extend(call.rates.iter().map(|rate| rate.unwrap_or(zero)));
        Some(result(graph, derivative, call.output, &args))
    }

    /// The function of the rates of the outputs: its inputs are those of `function`, then a rate of
    /// each.
    fn of_function(&self, graph: &mut Graph, function: &Function) -> Function {
        let mut locals = function.locals.clone();
        let is_real = real_locals(graph, function);
        let mut rate_of: IndexVec<LocalId, Option<LocalId>> =
            IndexVec::filled(None, function.locals.len());
        let mut inputs = function.inputs.clone();
        for &input in &function.inputs {
            let rate = locals.push(format!("der({})", function.locals[input]));
            rate_of[input] = is_real[input].then_some(rate);
            inputs.push(rate);
        }
        let mut body = Vec::new();
        let zero = graph.real(0.0);
        for local in function.locals.ids() {
            if is_real[local] && rate_of[local].is_none() {
                let rate = locals.push(format!("der({})", function.locals[local]));
                rate_of[local] = Some(rate);
                body.push(Statement::Assign(rate, zero));
            }
        }
        let outputs = function
            .outputs
            .iter()
            .map(|output| {
                rate_of[*output].unwrap_or_else(|| {
                    let rate = locals.push(format!("der({})", function.locals[*output]));
                    body.push(Statement::Assign(rate, zero));
                    rate
                })
            })
            .collect();
        self.statements(graph, &function.body, &rate_of, &mut body);
        Function {
            name: format!("der({})", function.name),
            span: function.span,
            inputs,
            outputs,
            locals,
            body,
        }
    }

    fn statements(
        &self,
        graph: &mut Graph,
        list: &[Statement],
        rate_of: &IndexVec<LocalId, Option<LocalId>>,
        out: &mut Vec<Statement>,
    ) {
        let inner = |graph: &mut Graph, list: &[Statement]| {
            let mut out = Vec::with_capacity(2 * list.len());
            self.statements(graph, list, rate_of, &mut out);
            out
        };
        for statement in list {
            match statement {
                Statement::Assign(local, value) => {
                    if let Some(rate) = rate_of[*local] {
                        let of_value = self.rate_of_value(graph, *value, rate_of);
                        out.push(Statement::Assign(rate, of_value));
                    }
                    out.push(statement.clone());
                }
                Statement::If(c, a, b) => {
                    let (a, b) = (inner(graph, a), inner(graph, b));
                    out.push(Statement::If(*c, a, b));
                }
                Statement::While(c, a) => {
                    let a = inner(graph, a);
                    out.push(Statement::While(*c, a));
                }
                Statement::Break | Statement::Return => out.push(statement.clone()),
                // The function itself checks them.
                Statement::Assert(..) => {}
            }
        }
    }

    fn rate_of_value(
        &self,
        graph: &mut Graph,
        value: ExprId,
        rate_of: &IndexVec<LocalId, Option<LocalId>>,
    ) -> ExprId {
        let rate = |graph: &mut Graph, leaf: Leaf| match leaf {
            Leaf::Var(v) => {
                let rate = rate_of.get(LocalId::from_usize(v.idx())).copied().flatten()?;
                Some(graph.var(VarId(rate.0), Type::Real))
            }
            _ => None,
        };
        forward_derivative_through(graph, value, rate, |graph, call| self.along(graph, call))
    }
}

fn result(graph: &mut Graph, function: FunctionId, output: u32, args: &[ExprId]) -> ExprId {
    let args = graph.intern_list(args);
    graph.intern(Node::Call { function, output, args }, Type::Real)
}

fn called(graph: &Graph, roots: impl IntoIterator<Item = ExprId>) -> Vec<FunctionId> {
    let mut found = Vec::new();
    for n in graph.postorder(roots) {
        if let Node::Call { function, .. } = graph.node(n)
            && !found.contains(&function)
        {
            found.push(function);
        }
    }
    found
}

/// The locals that hold Real values.
fn real_locals(graph: &Graph, function: &Function) -> IndexVec<LocalId, bool> {
    let mut is_real = IndexVec::filled(false, function.locals.len());
    for n in graph.postorder(function.values()) {
        if let Node::Var(v) = graph.node(n)
            && graph.ty(n) == Type::Real
        {
            is_real[LocalId::from_usize(v.idx())] = true;
        }
    }
    assigned(&function.body, &mut |local, value| {
        if graph.ty(value) == Type::Real {
            is_real[local] = true;
        }
    });
    is_real
}

fn assigned(list: &[Statement], act: &mut impl FnMut(LocalId, ExprId)) {
    for statement in list {
        match statement {
            Statement::Assign(local, value) => act(*local, *value),
            Statement::If(_, a, b) => {
                assigned(a, act);
                assigned(b, act);
            }
            Statement::While(_, a) => assigned(a, act),
            Statement::Break | Statement::Return | Statement::Assert(..) => {}
        }
    }
}
