//! Derivatives of functions along a direction: an equation that calls a function with loops can be differentiated,
//! because the function gets another one that computes its derivative.
//!
//! Forward accumulation through the statements (Griewank & Walther, *Evaluating Derivatives*, 2nd
//! ed., ch. 6.2): each Real local has a rate, which every assignment sets before the local itself,
//! and conditions stay. So the derivative is that of the path that the arguments take, as for an
//! if-expression. Functions that call themselves have no derivative, or differences of two calls.

use crate::base::index::{FastMap, FastSet, Id, IndexVec};
use crate::ir::expr::{ExprId, FunctionId, Graph, ListId, Node, Type, VarId};
use crate::ir::function::{Function, LocalId, Statement};
use crate::symbolic::gradient::{CallRate, Leaf, forward_derivative_through};

/// The functions of a model.
type Functions = IndexVec<FunctionId, Function>;

/// Ids from this one on stand for differences.
const FIRST_DIFFERENCE: usize = 1 << 30;

/// The functions of derivatives, by the functions that they belong to.
#[derive(Default)]
pub struct FunctionDerivatives {
    of: FastMap<FunctionId, FunctionId>,
    /// Derivatives that are approximated, if functions with loops and those that call themselves have such ones.
    differences: Option<Vec<Difference>>,
}

/// The derivative of an output of a function by an argument, as a difference of two calls.
pub type Difference = (FunctionId, u32, u32);

impl FunctionDerivatives {
    /// Functions with loops, and those that call themselves, have differences instead of derivatives: a loop that
    /// halves intervals has no useful derivative.
    pub fn with_differences() -> Self {
        FunctionDerivatives { of: FastMap::default(), differences: Some(Vec::new()) }
    }

    /// The difference that a called function stands for; `None` for other functions.
    pub fn difference(&self, f: FunctionId) -> Option<Difference> {
        let k = f.idx().checked_sub(FIRST_DIFFERENCE)?;
        self.differences.as_ref()?.get(k).copied()
    }

    /// The derivative of an output of a call by an argument as a difference.
    pub fn by_difference(
        &mut self,
        graph: &mut Graph,
        key: Difference,
        args: ListId,
    ) -> Option<ExprId> {
        let all = self.differences.as_mut()?;
        let known = all.iter().position(|d| *d == key);
        let k = known.unwrap_or_else(|| {
            all.push(key);
            all.len() - 1
        });
        let function = FunctionId::from_usize(FIRST_DIFFERENCE + k);
        Some(graph.intern(Node::Call { function, output: 0, args }, Type::Real))
    }

    /// Whether all functions that an expression calls have one.
    pub fn cover(&self, graph: &Graph, e: ExprId) -> bool {
        called(graph, [e]).iter().all(|f| self.of.contains_key(f))
    }

    /// Adds those of the functions that an expression calls; false if one cannot have any.
    pub fn add(&mut self, graph: &mut Graph, functions: &mut Functions, e: ExprId) -> bool {
        called(graph, [e]).into_iter().all(|f| self.add_function(graph, functions, f))
    }

    /// Adds that of a function; false if it cannot have any.
    pub fn add_function(
        &mut self,
        graph: &mut Graph,
        functions: &mut Functions,
        f: FunctionId,
    ) -> bool {
        self.add_below(graph, functions, f, &mut FastSet::default())
    }

    /// The function that computes the derivative of another one.
    pub fn find(&self, f: FunctionId) -> Option<FunctionId> {
        self.of.get(&f).copied()
    }

    fn add_below(
        &mut self,
        graph: &mut Graph,
        functions: &mut Functions,
        f: FunctionId,
        open: &mut FastSet<FunctionId>,
    ) -> bool {
        if self.of.contains_key(&f) {
            return true;
        }
        if functions.get(f).is_none() || !open.insert(f) {
            return false;
        }
        let values = functions[f].values();
        if graph.any(values.iter().copied(), |_, node| matches!(node, Node::Homotopy(..))) {
            return false;
        }
        if self.differences.is_some() && functions[f].has_loop() {
            return false;
        }
        for inner in called(graph, values) {
            if !self.add_below(graph, functions, inner, open) && self.differences.is_none() {
                return false;
            }
        }
        let function = functions[f].clone();
        let derivative = self.of_function(graph, &function);
        let derivative = functions.push(derivative);
        self.of.insert(f, derivative);
        open.remove(&f);
        true
    }

    /// The derivative of a call in an equation: the sum over the arguments that vary, so that it
    /// stays linear in their rates.
    pub fn of_call(&self, graph: &mut Graph, call: &CallRate<'_>) -> Option<ExprId> {
        let derivative = *self.of.get(&call.function)?;
        let mut terms = Vec::new();
        for (k, rate) in call.rates.iter().enumerate() {
            let Some(rate) = *rate else { continue };
            if graph.ty(call.args[k]) != Type::Real {
                continue;
            }
            let partial = by_argument(graph, derivative, call.output, call.args, k);
            terms.push(graph.mul(partial, rate));
        }
        if terms.is_empty() { None } else { Some(graph.sum(terms)) }
    }

    /// The derivative of a call in a function, along the direction of the rates.
    fn along(&mut self, graph: &mut Graph, call: &CallRate<'_>) -> Option<ExprId> {
        if call.rates.iter().all(Option::is_none) {
            return None;
        }
        let Some(&derivative) = self.of.get(&call.function) else {
            return self.along_by_differences(graph, call);
        };
        let zero = graph.real(0.0);
        let mut args = call.args.to_vec();
        args.extend(call.rates.iter().map(|rate| rate.unwrap_or(zero)));
        Some(result(graph, derivative, call.output, &args))
    }

    fn along_by_differences(&mut self, graph: &mut Graph, call: &CallRate<'_>) -> Option<ExprId> {
        let args = graph.intern_list(call.args);
        let mut terms = Vec::new();
        for (k, rate) in call.rates.iter().enumerate() {
            let Some(rate) = *rate else { continue };
            if graph.ty(call.args[k]) == Type::Real {
                let key = (call.function, call.output, k as u32);
                let partial = self.by_difference(graph, key, args)?;
                terms.push(graph.mul(partial, rate));
            }
        }
        if terms.is_empty() { None } else { Some(graph.sum(terms)) }
    }

    /// The function of the rates of the outputs: its inputs are those of `function`, then a rate of
    /// each.
    fn of_function(&mut self, graph: &mut Graph, function: &Function) -> Function {
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
        let read = graph.postorder(function.values()).into_iter();
        let read = read.filter_map(|e| match graph.node(e) {
            Node::Var(v) => Some(LocalId::from_usize(v.idx())),
            _ => None,
        });
        let read = read.collect();
        Accumulation { derivatives: self, rate_of, read }.statements(
            graph,
            &function.body,
            &mut body,
        );
        Function {
            name: format!("der({})", function.name),
            span: function.span,
            inputs,
            outputs,
            locals,
            body,
        }
    }
}

/// The statements of a derivative.
struct Accumulation<'a> {
    derivatives: &'a mut FunctionDerivatives,
    rate_of: IndexVec<LocalId, Option<LocalId>>,
    /// The locals that the function reads: others are not computed again.
    read: FastSet<LocalId>,
}

impl Accumulation<'_> {
    fn inner(&mut self, graph: &mut Graph, list: &[Statement]) -> Vec<Statement> {
        let mut out = Vec::with_capacity(2 * list.len());
        self.statements(graph, list, &mut out);
        out
    }

    fn statements(&mut self, graph: &mut Graph, list: &[Statement], out: &mut Vec<Statement>) {
        for statement in list {
            match statement {
                Statement::Assign(local, value) => {
                    if let Some(rate) = self.rate_of[*local] {
                        let of_value = self.rate_of_value(graph, *value);
                        out.push(Statement::Assign(rate, of_value));
                    }
                    if self.read.contains(local) {
                        out.push(statement.clone());
                    }
                }
                Statement::If(c, a, b) => {
                    let (a, b) = (self.inner(graph, a), self.inner(graph, b));
                    out.push(Statement::If(*c, a, b));
                }
                Statement::While(c, a) => {
                    let a = self.inner(graph, a);
                    out.push(Statement::While(*c, a));
                }
                Statement::Break | Statement::Return => out.push(statement.clone()),
                // The function itself checks them.
                Statement::Assert(..) => {}
            }
        }
    }

    fn rate_of_value(&mut self, graph: &mut Graph, value: ExprId) -> ExprId {
        let Accumulation { derivatives, rate_of, .. } = self;
        let rate = |graph: &mut Graph, leaf: Leaf| match leaf {
            Leaf::Var(v) => {
                let rate = rate_of.get(LocalId::from_usize(v.idx())).copied().flatten()?;
                Some(graph.var(VarId(rate.0), Type::Real))
            }
            _ => None,
        };
        let through = |graph: &mut Graph, call: &CallRate<'_>| derivatives.along(graph, call);
        forward_derivative_through(graph, value, rate, through)
    }
}

/// The derivative of an output by an argument: a call of the function that computes derivatives, along a unit vector.
pub fn by_argument(
    graph: &mut Graph,
    derivative: FunctionId,
    output: u32,
    arguments: &[ExprId],
    by: usize,
) -> ExprId {
    let (zero, one) = (graph.real(0.0), graph.real(1.0));
    let mut args = arguments.to_vec();
    args.extend((0..arguments.len()).map(|k| if k == by { one } else { zero }));
    result(graph, derivative, output, &args)
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
