//! Introduces variables for common subexpressions if the printed model would otherwise be much
//! larger than the expression graph: the graph shares subexpressions, and printing repeats them.
//!
//! A subexpression that occurs only in branches of an `if` is computed only there: a root or a
//! quotient may be undefined if the branch is not taken. If the condition of such a branch needs
//! the subexpression itself, in a branch of its own, it is printed in full at each occurrence.

use crate::base::index::{FastMap, FastSet, Id};
use crate::graph::scc::nodes_on_cycles;
use crate::ir::ast::Variability;
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{Action, Equation, EquationKind, FlatModel, Origin, Variable, WhenBranch};
use crate::symbolic::rewrite::Rewriter;
use crate::symbolic::uses::{Guard, Root, Uses};

/// Models with at most this many printed nodes are printed as they are.
const ACCEPTABLE_SIZE: u64 = 100_000;
/// Maximum ratio of printed nodes to nodes of the graph.
const MAX_EXPANSION: u64 = 8;
/// Maximum number of printed nodes; such a model has gigabytes.
const MAX_SIZE: u64 = 100_000_000;
/// Number of nodes of the smallest subexpression that gets a variable.
pub(crate) const MIN_PART_SIZE: u64 = 16;

/// The printed model would have more than [`MAX_SIZE`] operators and names.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the flat text of this model would have more than {MAX_SIZE} operators and names")]
pub struct TooLong;

/// The context of a subexpression, which determines the kind of its variable.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PartContext {
    /// In equations, where its relations generate events.
    Equations,
    /// Below `noEvent` or `smooth` in equations, where they do not.
    Literal,
    /// In a when-clause, which assigns the variable.
    When,
    /// In the values of parameters, the attributes of variables and initial equations, which read a further parameter.
    Parameters,
}

/// The model with variables for common subexpressions; `None` if it can be printed as it is.
pub(crate) fn extract(flat: &FlatModel) -> Result<Option<FlatModel>, TooLong> {
    let sizes = sizes(&flat.graph);
    if length(flat, &sizes) <= ACCEPTABLE_SIZE.max(MAX_EXPANSION * flat.graph.len() as u64) {
        return Ok(None);
    }
    let mut excluded = FastSet::default();
    loop {
        let mut shared = flat.clone();
        let cyclic = share(&mut shared, &sizes, &excluded);
        if cyclic.is_empty() {
            let sizes = self::sizes(&shared.graph);
            return if length(&shared, &sizes) > MAX_SIZE {
                Err(TooLong)
            } else {
                Ok(Some(shared))
            };
        }
        excluded.extend(cyclic);
    }
}

/// Introduces variables for all common subexpressions except those `excluded`. Returns the
/// subexpressions whose variables would depend on themselves.
fn share(flat: &mut FlatModel, sizes: &[u64], excluded: &FastSet<ExprId>) -> Vec<ExprId> {
    let mut cyclic = Vec::new();
    let mut equations = std::mem::take(&mut flat.equations);
    for e in &mut equations {
        if let EquationKind::When(branches) = &mut e.kind {
            branches.iter_mut().for_each(|b| cyclic.extend(in_branch(flat, b, sizes, excluded)));
        }
    }
    cyclic.extend(in_equations(flat, &mut equations, sizes, excluded));
    flat.equations = equations;
    cyclic.extend(in_parameters(flat, sizes, excluded));
    for function in flat.functions.iter_mut() {
        super::function_locals::in_function(&mut flat.graph, function, sizes);
    }
    cyclic
}

/// Number of nodes of the printed model.
fn length(flat: &FlatModel, sizes: &[u64]) -> u64 {
    let mut total = 0_u64;
    let mut add = |e: ExprId| total = total.saturating_add(sizes[e.0 as usize]);
    flat.variables.iter().filter_map(|v| v.binding).for_each(&mut add);
    flat.variables.iter().flat_map(attributes).for_each(&mut add);
    let equations = flat.equations.iter().chain(&flat.initial_equations);
    equations.for_each(|equation| equation.for_each_expression(&mut add));
    flat.functions.iter().for_each(|function| function.for_each_expression(&mut add));
    total
}

/// Number of nodes of each expression when printed; operands precede their users in the graph.
fn sizes(graph: &Graph) -> Vec<u64> {
    let mut sizes: Vec<u64> = Vec::with_capacity(graph.len());
    for e in graph.ids() {
        let mut size = 1_u64;
        graph.for_each_operand(e, |a| size = size.saturating_add(sizes[a.0 as usize]));
        sizes.push(size);
    }
    sizes
}

/// The expression that an action evaluates, and the condition under which it does.
fn value(action: &Action) -> Option<Root> {
    match action {
        Action::Assign(_, e) => Some((*e, None)),
        Action::Reinit { value, guard, .. } => Some((*value, *guard)),
        Action::Assert(_) | Action::Terminate { .. } => None,
    }
}

fn in_branch(
    flat: &mut FlatModel,
    branch: &mut WhenBranch,
    sizes: &[u64],
    excluded: &FastSet<ExprId>,
) -> Vec<ExprId> {
    let roots: Vec<Root> = branch.actions.iter().filter_map(value).collect();
    let mut bindings = LetBindings::of(flat, &roots, PartContext::When, sizes, excluded);
    let parts = bindings.definitions(flat);
    let cyclic = cyclic(&flat.graph, &parts, &bindings.parts);
    for action in &mut branch.actions {
        if let Action::Assign(_, e) | Action::Reinit { value: e, .. } = action {
            *e = bindings.substitute(&mut flat.graph, *e);
        }
    }
    let parts = parts.into_iter().map(|(v, e)| Action::Assign(v, e));
    branch.actions.splice(0..0, parts);
    cyclic
}

/// Subexpressions whose variables depend on themselves.
fn cyclic(
    graph: &Graph,
    definitions: &[(VarId, ExprId)],
    parts: &[(VarId, ExprId)],
) -> Vec<ExprId> {
    let mut numbers: FastMap<VarId, usize> = FastMap::default();
    numbers.extend(definitions.iter().enumerate().map(|(k, (v, _))| (*v, k)));
    let mut needs = Vec::new();
    for (k, (_, e)) in definitions.iter().enumerate() {
        for n in graph.postorder([*e]) {
            if let Node::Var(v) = graph.node(n)
                && let Some(needed) = numbers.get(&v)
            {
                needs.push((VarId::from_usize(k), VarId::from_usize(*needed)));
            }
        }
    }
    let found = nodes_on_cycles(definitions.len(), needs);
    let found: FastSet<VarId> = found.into_iter().map(|k| definitions[k.idx()].0).collect();
    parts.iter().filter(|(v, _)| found.contains(v)).map(|(_, part)| *part).collect()
}

fn in_equations(
    flat: &mut FlatModel,
    equations: &mut Vec<Equation>,
    sizes: &[u64],
    excluded: &FastSet<ExprId>,
) -> Vec<ExprId> {
    let mut roots = Vec::new();
    for e in equations.iter() {
        match &e.kind {
            EquationKind::Equal(a, b) => roots.extend([(*a, None), (*b, None)]),
            EquationKind::Algorithm { values, .. } => {
                roots.extend(values.iter().map(|e| (*e, None)))
            }
            EquationKind::Assert(a) => roots.extend([(a.condition, None), (a.message, None)]),
            EquationKind::When(_) => {}
        }
    }
    let moving = |v: &Variable| v.variability > Variability::Parameter;
    let bindings = flat.variables.iter().filter(|v| moving(v)).filter_map(|v| v.binding);
    roots.extend(bindings.map(|e| (e, None)));
    let bound: Vec<VarId> = flat.variables.ids().filter(|v| moving(&flat.variables[*v])).collect();
    let mut bindings = LetBindings::of(flat, &roots, PartContext::Equations, sizes, excluded);
    let mut literal = bindings.bind_literal_parts(flat, sizes, excluded);
    let parts = [bindings.definitions(flat), literal.definitions(flat)].concat();
    let cyclic = cyclic(&flat.graph, &parts, &[&bindings.parts[..], &literal.parts].concat());
    equations.iter_mut().for_each(|e| bindings.substitute_in(&mut flat.graph, e));
    for v in bound {
        if let Some(e) = flat.variables[v].binding {
            flat.variables[v].binding = Some(bindings.substitute(&mut flat.graph, e));
        }
    }
    for (v, e) in parts {
        let origin = Origin { span: flat.span, component: "".into() };
        let lhs = flat.graph.var(v, flat.variables[v].ty);
        equations.push(Equation { kind: EquationKind::Equal(lhs, e), origin });
    }
    cyclic
}

/// The attributes of a variable that are parameter expressions.
fn attributes(v: &Variable) -> impl Iterator<Item = ExprId> + use<> {
    [v.start, v.min, v.max, v.nominal].into_iter().flatten()
}

fn in_parameters(flat: &mut FlatModel, sizes: &[u64], excluded: &FastSet<ExprId>) -> Vec<ExprId> {
    let is_parameter = |v: &Variable| v.variability == Variability::Parameter;
    let values = flat.variables.iter().filter(|v| is_parameter(v)).filter_map(|v| v.binding);
    let all = values.chain(flat.variables.iter().flat_map(attributes));
    let mut all: Vec<ExprId> = all.collect();
    let are_parametric = are_parametric(flat);
    for equation in &flat.initial_equations {
        equation.for_each_expression(&mut |e| {
            parametric_parts(&flat.graph, e, &are_parametric, &mut all);
        });
    }
    let roots: Vec<Root> = all.into_iter().map(|e| (e, None)).collect();
    let old: Vec<VarId> = flat.variables.ids().collect();
    let mut bindings = LetBindings::of(flat, &roots, PartContext::Parameters, sizes, excluded);
    let parts = bindings.definitions(flat);
    let cyclic = cyclic(&flat.graph, &parts, &bindings.parts);
    for v in old {
        let own = &flat.variables[v];
        let binding = own.binding.filter(|_| is_parameter(own));
        let all = [binding, own.start, own.min, own.max, own.nominal];
        let [binding, start, min, max, nominal] =
            all.map(|e| e.map(|e| bindings.substitute(&mut flat.graph, e)));
        let own = &mut flat.variables[v];
        own.binding = binding.or(own.binding);
        (own.start, own.min, own.max, own.nominal) = (start, min, max, nominal);
    }
    let mut equations = std::mem::take(&mut flat.initial_equations);
    equations.iter_mut().for_each(|e| bindings.substitute_in(&mut flat.graph, e));
    flat.initial_equations = equations;
    for (v, e) in parts {
        flat.variables[v].binding = Some(e);
    }
    cyclic
}

/// For each expression, whether it depends on parameters and constants alone.
fn are_parametric(flat: &FlatModel) -> Vec<bool> {
    let graph = &flat.graph;
    let mut are: Vec<bool> = Vec::with_capacity(graph.len());
    for e in graph.ids() {
        let mut is = match graph.node(e) {
            Node::Var(v) => {
                flat.variables.get(v).is_some_and(|v| v.variability <= Variability::Parameter)
            }
            Node::Time
            | Node::Der(_)
            | Node::Pre(_)
            | Node::Initial
            | Node::Terminal
            | Node::Sample(..)
            | Node::Clocked(..)
            | Node::Relation(_)
            | Node::Recorded(..)
            | Node::Homotopy(..) => false,
            _ => true,
        };
        graph.for_each_operand(e, |a| is &= are[a.0 as usize]);
        are.push(is);
    }
    are
}

/// Adds the largest parts of an expression that depend on parameters alone, but for those that a condition may leave out.
fn parametric_parts(graph: &Graph, e: ExprId, are_parametric: &[bool], out: &mut Vec<ExprId>) {
    let (mut open, mut seen) = (vec![e], FastSet::default());
    while let Some(e) = open.pop() {
        match graph.node(e) {
            _ if are_parametric[e.0 as usize] => out.push(e),
            _ if !seen.insert(e) => {}
            Node::If(condition, ..) => open.push(condition),
            _ => graph.for_each_operand(e, |a| open.push(a)),
        }
    }
}

/// Let-bindings: subexpressions and the variables that replace them.
struct LetBindings {
    place: PartContext,
    uses: Uses,
    parts: Vec<(VarId, ExprId)>,
    /// The replacement of each subexpression.
    names: FastMap<ExprId, ExprId>,
    rewriter: Rewriter,
}

impl LetBindings {
    fn of(
        flat: &mut FlatModel,
        roots: &[Root],
        place: PartContext,
        sizes: &[u64],
        excluded: &FastSet<ExprId>,
    ) -> LetBindings {
        let uses = Uses::of(&mut flat.graph, roots, &|graph, e| is_closed(graph, e, place));
        let mut parts = Vec::new();
        let mut names = FastMap::default();
        let repeated = repeated(&uses, &flat.graph, place, sizes).into_iter();
        for part in repeated.filter(|part| !excluded.contains(part)) {
            let variable = variable(flat, part, place);
            let v = flat.variables.push(variable);
            names.insert(part, flat.graph.var(v, flat.graph.ty(part)));
            parts.push((v, part));
        }
        LetBindings { place, uses, parts, names, rewriter: Rewriter::new() }
    }

    /// Introduces variables below `noEvent` and `smooth`.
    fn bind_literal_parts(
        &mut self,
        flat: &mut FlatModel,
        sizes: &[u64],
        excluded: &FastSet<ExprId>,
    ) -> LetBindings {
        let closed =
            |e: &ExprId| matches!(flat.graph.node(*e), Node::NoEvent(_) | Node::Smooth(..));
        let mut closed: Vec<ExprId> = self.uses.of.keys().copied().filter(closed).collect();
        closed.sort_unstable();
        let mut roots = Vec::with_capacity(closed.len());
        for &e in &closed {
            let (_, guard) = self.uses.of[&e];
            let condition = self.uses.all(&mut flat.graph, guard, 0);
            flat.graph.for_each_operand(e, |a| roots.push((a, Some(condition))));
        }
        let mut literal = LetBindings::of(flat, &roots, PartContext::Literal, sizes, excluded);
        for (&e, (root, _)) in closed.iter().zip(roots) {
            let inside = literal.substitute(&mut flat.graph, root);
            let new = flat.graph.rebuild(e, &[inside]);
            self.names.insert(e, new);
        }
        literal
    }

    /// The definitions of the variables.
    fn definitions(&mut self, flat: &mut FlatModel) -> Vec<(VarId, ExprId)> {
        let graph = &mut flat.graph;
        let mut definitions = Vec::with_capacity(self.parts.len());
        for (v, part) in self.parts.clone() {
            let mut operands = Vec::new();
            graph.for_each_operand(part, |a| operands.push(a));
            for a in &mut operands {
                *a = self.substitute(graph, *a);
            }
            let mut value = graph.rebuild(part, &operands);
            let default_value = default_value(graph, part);
            for Guard { condition, holds, depth, .. } in self.uses.guards_of(part) {
                // The `noEvent` belongs inside the outermost condition.
                if self.place == PartContext::Literal && depth == 1 {
                    value = graph.no_event(value);
                }
                let c = self.substitute(graph, condition);
                let (yes, no) = if holds { (value, default_value) } else { (default_value, value) };
                value = graph.if_then_else(c, yes, no);
            }
            definitions.push((v, value));
        }
        definitions
    }

    /// Replaces subexpressions of an equation by their variables.
    fn substitute_in(&mut self, graph: &mut Graph, equation: &mut Equation) {
        match &mut equation.kind {
            EquationKind::Equal(a, b) => {
                [a, b].into_iter().for_each(|e| *e = self.substitute(graph, *e));
            }
            EquationKind::Algorithm { values, .. } => {
                values.iter_mut().for_each(|e| *e = self.substitute(graph, *e));
            }
            EquationKind::Assert(a) => {
                let all = [&mut a.condition, &mut a.message].into_iter();
                all.for_each(|e| *e = self.substitute(graph, *e));
            }
            EquationKind::When(_) => {}
        }
    }

    /// Replaces subexpressions by their variables.
    fn substitute(&mut self, graph: &mut Graph, e: ExprId) -> ExprId {
        let (names, place) = (&self.names, self.place);
        self.rewriter.apply(graph, e, &mut |graph, n| {
            names.get(&n).copied().or_else(|| is_closed(graph, n, place).then_some(n))
        })
    }
}

/// The variable of a subexpression.
fn variable(flat: &mut FlatModel, part: ExprId, place: PartContext) -> Variable {
    let name = format!("$shared{}", flat.variables.len() + 1);
    let ty = flat.graph.ty(part);
    let variability = match (ty, place) {
        (_, PartContext::Parameters) => Variability::Parameter,
        (Type::Real, PartContext::Equations | PartContext::Literal) => Variability::Continuous,
        _ => Variability::Discrete,
    };
    let bare = Variable::bare(name, ty, variability, flat.span);
    if place != PartContext::When {
        return bare;
    }
    Variable { start: Some(default_value(&mut flat.graph, part)), fixed: Some(true), ..bare }
}

/// The value of a variable if its subexpression is not computed.
fn default_value(graph: &mut Graph, part: ExprId) -> ExprId {
    match graph.ty(part) {
        Type::Boolean => graph.boolean(false),
        Type::Integer => graph.integer(0),
        _ => graph.real(0.0),
    }
}

/// True for nodes whose operands have a different meaning outside them.
fn is_closed(graph: &Graph, e: ExprId, place: PartContext) -> bool {
    place == PartContext::Equations
        && matches!(graph.node(e), Node::NoEvent(_) | Node::Smooth(..) | Node::Homotopy(..))
}

/// Large expressions that occur several times, nested ones first.
fn repeated(uses: &Uses, graph: &Graph, place: PartContext, sizes: &[u64]) -> Vec<ExprId> {
    let shared = |(e, (count, _)): (&ExprId, &(u32, usize))| {
        let fits = match graph.ty(*e) {
            Type::Real => true,
            Type::Boolean => place != PartContext::Literal,
            Type::Integer => matches!(place, PartContext::When | PartContext::Parameters),
            _ => false,
        };
        (fits && *count > 1 && sizes[e.0 as usize] >= MIN_PART_SIZE).then_some(*e)
    };
    let mut parts: Vec<ExprId> = uses.of.iter().filter_map(shared).collect();
    parts.sort_unstable();
    parts
}
