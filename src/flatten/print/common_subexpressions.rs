//! Parts of expressions that become variables where the text of a model would be much longer than the
//! model: expressions share what they have in common, and a text writes it out at each place.
//!
//! What stands in branches of an `if` alone is computed there alone: a root or a quotient may have no
//! value where the branch is not taken. If the condition of such a branch needs the part itself, in a
//! branch of its own, then the part is written out at each place.

use crate::base::index::{FastMap, FastSet, Id};
use crate::graph::scc::nodes_on_cycles;
use crate::ir::ast::Variability;
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{
    Action, Equation, EquationKind, FlatModel, Function, Origin, Variable, WhenBranch,
};
use crate::symbolic::rewrite::Rewriter;
use crate::symbolic::uses::{Guard, Root, Uses};

/// Nodes of a text that is never too long.
const SHORT: u64 = 100_000;
/// How many times as long as its expressions a text may be.
const FACTOR: u64 = 8;
/// Nodes of the longest text, which has gigabytes.
const LONGEST: u64 = 100_000_000;
/// Nodes of the smallest part that is worth a variable.
pub(crate) const LARGE: u64 = 16;

/// The text of a model has more than so many operators and names.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the flat text of this model would have more than {LONGEST} operators and names")]
pub struct TooLong;

/// Where a part stands, and so what its variable is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// In equations: its relations make events.
    Equations,
    /// Below `noEvent` or `smooth` in equations: they do not.
    Literal,
    /// In a when-clause, which assigns it.
    When,
}

/// The model with variables for what its text would write again and again; `None` if the text is
/// as good as it is.
pub(crate) fn shared(flat: &FlatModel) -> Result<Option<FlatModel>, TooLong> {
    let sizes = sizes(&flat.graph);
    if length(flat, &sizes) <= SHORT.max(FACTOR * flat.graph.len() as u64) {
        return Ok(None);
    }
    let mut apart = FastSet::default();
    loop {
        let mut shared = flat.clone();
        let around = share(&mut shared, &sizes, &apart);
        if around.is_empty() {
            let sizes = self::sizes(&shared.graph);
            return if length(&shared, &sizes) > LONGEST { Err(TooLong) } else { Ok(Some(shared)) };
        }
        apart.extend(around);
    }
}

/// Gives parts variables, but not those `apart`. The result are parts that would need themselves.
fn share(flat: &mut FlatModel, sizes: &[u64], apart: &FastSet<ExprId>) -> Vec<ExprId> {
    let mut around = Vec::new();
    let mut equations = std::mem::take(&mut flat.equations);
    for e in &mut equations {
        if let EquationKind::When(branches) = &mut e.kind {
            branches.iter_mut().for_each(|b| around.extend(in_branch(flat, b, sizes, apart)));
        }
    }
    around.extend(in_equations(flat, &mut equations, sizes, apart));
    flat.equations = equations;
    for function in flat.functions.iter_mut() {
        super::function_locals::in_function(&mut flat.graph, function, sizes);
    }
    around
}

/// How many nodes the text of a model has.
fn length(flat: &FlatModel, sizes: &[u64]) -> u64 {
    let mut total = 0_u64;
    for_each_root(flat, &mut |e| total = total.saturating_add(sizes[e.0 as usize]));
    for e in flat.functions.iter().flat_map(Function::values) {
        total = total.saturating_add(sizes[e.0 as usize]);
    }
    total
}

/// How many nodes each expression has as a text; operands stand before their users.
fn sizes(graph: &Graph) -> Vec<u64> {
    let mut sizes: Vec<u64> = Vec::with_capacity(graph.len());
    for e in graph.ids() {
        let mut size = 1_u64;
        graph.for_each_operand(e, |a| size = size.saturating_add(sizes[a.0 as usize]));
        sizes.push(size);
    }
    sizes
}

/// The expressions of equations and bindings.
fn for_each_root(flat: &FlatModel, visit: &mut dyn FnMut(ExprId)) {
    flat.variables.iter().filter_map(|v| v.binding).for_each(&mut *visit);
    for e in &flat.equations {
        match &e.kind {
            EquationKind::Equal(a, b) => [*a, *b].into_iter().for_each(&mut *visit),
            EquationKind::Algorithm { values, .. } => values.iter().copied().for_each(&mut *visit),
            EquationKind::When(branches) => {
                let actions = branches.iter().flat_map(|b| &b.actions);
                actions.filter_map(value).for_each(|(e, _)| visit(e));
            }
            EquationKind::Assert(a) => [a.condition, a.message].into_iter().for_each(&mut *visit),
        }
    }
}

/// What an action computes, and the condition under which it does.
fn value(action: &Action) -> Option<Root> {
    match action {
        Action::Assign(_, e) => Some((*e, None)),
        Action::Reinit { value, guard, .. } => Some((*value, *guard)),
        Action::Assert(_) | Action::Terminate(_) => None,
    }
}

fn in_branch(
    flat: &mut FlatModel,
    branch: &mut WhenBranch,
    sizes: &[u64],
    apart: &FastSet<ExprId>,
) -> Vec<ExprId> {
    let roots: Vec<Root> = branch.actions.iter().filter_map(value).collect();
    let mut naming = Naming::of(flat, &roots, Place::When, sizes, apart);
    let parts = naming.definitions(flat);
    let around = around(&flat.graph, &parts, &naming.parts);
    for action in &mut branch.actions {
        if let Action::Assign(_, e) | Action::Reinit { value: e, .. } = action {
            *e = naming.named(&mut flat.graph, *e);
        }
    }
    let parts = parts.into_iter().map(|(v, e)| Action::Assign(v, e));
    branch.actions.splice(0..0, parts);
    around
}

/// Parts that need themselves, by what their variables are.
fn around(
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
    apart: &FastSet<ExprId>,
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
    let mut naming = Naming::of(flat, &roots, Place::Equations, sizes, apart);
    let mut literal = naming.below_closed(flat, sizes, apart);
    let parts = [naming.definitions(flat), literal.definitions(flat)].concat();
    let around = around(&flat.graph, &parts, &[&naming.parts[..], &literal.parts].concat());
    for e in equations.iter_mut() {
        match &mut e.kind {
            EquationKind::Equal(a, b) => {
                [a, b].into_iter().for_each(|e| *e = naming.named(&mut flat.graph, *e));
            }
            EquationKind::Algorithm { values, .. } => {
                values.iter_mut().for_each(|e| *e = naming.named(&mut flat.graph, *e));
            }
            EquationKind::Assert(a) => {
                [&mut a.condition, &mut a.message]
                    .into_iter()
                    .for_each(|e| *e = naming.named(&mut flat.graph, *e));
            }
            EquationKind::When(_) => {}
        }
    }
    for v in bound {
        if let Some(e) = flat.variables[v].binding {
            flat.variables[v].binding = Some(naming.named(&mut flat.graph, e));
        }
    }
    for (v, e) in parts {
        let origin = Origin { span: flat.span, component: "".into() };
        let lhs = flat.graph.var(v, flat.variables[v].ty);
        equations.push(Equation { kind: EquationKind::Equal(lhs, e), origin });
    }
    around
}

/// Parts that are variables now.
struct Naming {
    place: Place,
    uses: Uses,
    parts: Vec<(VarId, ExprId)>,
    /// What stands for each.
    names: FastMap<ExprId, ExprId>,
    rewriter: Rewriter,
}

impl Naming {
    fn of(
        flat: &mut FlatModel,
        roots: &[Root],
        place: Place,
        sizes: &[u64],
        apart: &FastSet<ExprId>,
    ) -> Naming {
        let uses = Uses::of(&mut flat.graph, roots, &|graph, e| is_closed(graph, e, place));
        let mut parts = Vec::new();
        let mut names = FastMap::default();
        let repeated = repeated(&uses, &flat.graph, place, sizes).into_iter();
        for part in repeated.filter(|part| !apart.contains(part)) {
            let variable = variable(flat, part, place);
            let v = flat.variables.push(variable);
            names.insert(part, flat.graph.var(v, flat.graph.ty(part)));
            parts.push((v, part));
        }
        Naming { place, uses, parts, names, rewriter: Rewriter::new() }
    }

    /// Names what stands below `noEvent` and `smooth`.
    fn below_closed(
        &mut self,
        flat: &mut FlatModel,
        sizes: &[u64],
        apart: &FastSet<ExprId>,
    ) -> Naming {
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
        let mut literal = Naming::of(flat, &roots, Place::Literal, sizes, apart);
        for (&e, (root, _)) in closed.iter().zip(roots) {
            let inside = literal.named(&mut flat.graph, root);
            let new = flat.graph.rebuild(e, &[inside]);
            self.names.insert(e, new);
        }
        literal
    }

    /// What the variables are.
    fn definitions(&mut self, flat: &mut FlatModel) -> Vec<(VarId, ExprId)> {
        let graph = &mut flat.graph;
        let mut definitions = Vec::with_capacity(self.parts.len());
        for (v, part) in self.parts.clone() {
            let mut operands = Vec::new();
            graph.for_each_operand(part, |a| operands.push(a));
            for a in &mut operands {
                *a = self.named(graph, *a);
            }
            let mut value = graph.rebuild(part, &operands);
            let nothing = nothing(graph, part);
            for Guard { condition, holds, depth, .. } in self.uses.guards_of(part) {
                // The outermost is the place of the `noEvent`.
                if self.place == Place::Literal && depth == 1 {
                    value = graph.no_event(value);
                }
                let c = self.named(graph, condition);
                let (yes, no) = if holds { (value, nothing) } else { (nothing, value) };
                value = graph.if_then_else(c, yes, no);
            }
            definitions.push((v, value));
        }
        definitions
    }

    /// An expression with the names of its parts.
    fn named(&mut self, graph: &mut Graph, e: ExprId) -> ExprId {
        let (names, place) = (&self.names, self.place);
        self.rewriter.apply(graph, e, &mut |graph, n| {
            names.get(&n).copied().or_else(|| is_closed(graph, n, place).then_some(n))
        })
    }
}

/// The variable of a part.
fn variable(flat: &mut FlatModel, part: ExprId, place: Place) -> Variable {
    let name = format!("$shared{}", flat.variables.len() + 1);
    let ty = flat.graph.ty(part);
    let variability = match (ty, place) {
        (Type::Real, Place::Equations | Place::Literal) => Variability::Continuous,
        _ => Variability::Discrete,
    };
    let bare = Variable::bare(name, ty, variability, flat.span);
    if place != Place::When {
        return bare;
    }
    Variable { start: Some(nothing(&mut flat.graph, part)), fixed: Some(true), ..bare }
}

/// What stands for a part where it is not computed.
fn nothing(graph: &mut Graph, part: ExprId) -> ExprId {
    match graph.ty(part) {
        Type::Boolean => graph.boolean(false),
        Type::Integer => graph.integer(0),
        _ => graph.real(0.0),
    }
}

/// Whether what stands below a node means something else outside of it.
fn is_closed(graph: &Graph, e: ExprId, place: Place) -> bool {
    place == Place::Equations
        && matches!(graph.node(e), Node::NoEvent(_) | Node::Smooth(..) | Node::Homotopy(..))
}

/// Large expressions that stand at several places; those inside of others first.
fn repeated(uses: &Uses, graph: &Graph, place: Place, sizes: &[u64]) -> Vec<ExprId> {
    let shared = |(e, (count, _)): (&ExprId, &(u32, usize))| {
        let fits = match graph.ty(*e) {
            Type::Real => true,
            Type::Boolean => place != Place::Literal,
            Type::Integer => place == Place::When,
            _ => false,
        };
        (fits && *count > 1 && sizes[e.0 as usize] >= LARGE).then_some(*e)
    };
    let mut parts: Vec<ExprId> = uses.of.iter().filter_map(shared).collect();
    parts.sort_unstable();
    parts
}
