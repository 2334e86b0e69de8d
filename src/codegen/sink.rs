//! Conditions under which long calls are needed: what stands in a branch of an `if`, or of a when-clause, is not
//! computed where the branch is not taken.

use crate::base::index::{FastMap, FastSet, Id};
use crate::graph::scc::nodes_on_cycles;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, FunctionId, ListId, Node};
use crate::ir::flat::Statement;
use crate::symbolic::uses::{Root, Uses};

use super::function::reached;

/// A function with so many statements is large.
const MANY: usize = 100;

/// A call.
pub type Called = (FunctionId, ListId);

/// The conditions of calls that stand in equations and assertions. What stands in relations or clocks too is
/// computed always.
pub fn guards(dae: &mut Dae, long: &FastSet<FunctionId>) -> FastMap<Called, ExprId> {
    if long.is_empty() {
        return FastMap::default();
    }
    let mut all: Vec<ExprId> = dae.discrete.iter().map(|d| d.value).collect();
    for e in dae.equations.iter().chain(&dae.initial) {
        all.extend([e.lhs, e.rhs, e.residual]);
    }
    all.extend(dae.eliminated.iter().map(|(_, e)| *e));
    all.extend(dae.asserts.iter().map(|a| a.assert.condition));
    let roots: Vec<Root> = all.iter().map(|e| (*e, None)).collect();
    let long: FastSet<Called> = calls(dae, all).filter(|(f, _)| long.contains(f)).collect();
    if long.is_empty() {
        return FastMap::default();
    }
    let elsewhere: FastSet<Called> = calls(dae, others(dae)).collect();
    let uses = Uses::of(&mut dae.graph, &roots, &|_, _| false);
    // One call gives all outputs of a function, and is needed where any of them is.
    let mut common: FastMap<Called, usize> = FastMap::default();
    for (&e, &(_, guard)) in &uses.of {
        let Node::Call { function, args, .. } = dae.graph.node(e) else { continue };
        let call = (function, args);
        if long.contains(&call) && !elsewhere.contains(&call) {
            let known = common.entry(call).or_insert(guard);
            *known = uses.nesting.common(*known, guard);
        }
    }
    let mut found: Vec<(Called, usize)> = common.into_iter().filter(|(_, g)| *g != 0).collect();
    found.sort_unstable_by_key(|((function, args), _)| (function.idx(), args.0));
    let found: Vec<(Called, ExprId)> =
        found.into_iter().map(|(c, g)| (c, uses.all(&mut dae.graph, g, 0))).collect();
    without_circles(dae, found)
}

crate::define_id! {
    /// A call that has a guard.
    struct Guarded
}

/// Calls that would be made only if they themselves said so are made always.
fn without_circles(dae: &Dae, found: Vec<(Called, ExprId)>) -> FastMap<Called, ExprId> {
    let number: FastMap<Called, Guarded> =
        found.iter().enumerate().map(|(k, (call, _))| (*call, Guarded::from_usize(k))).collect();
    let mut needs = Vec::new();
    for (k, (_, guard)) in found.iter().enumerate() {
        let read = calls(dae, vec![*guard]).filter_map(|call| number.get(&call).copied());
        needs.extend(read.map(|other| (Guarded::from_usize(k), other)));
    }
    let mut guards: FastMap<Called, ExprId> = found.iter().copied().collect();
    for k in nodes_on_cycles(found.len(), needs) {
        guards.remove(&found[k.idx()].0);
    }
    guards
}

/// The functions of which a call may take long: one calls itself, a body that is run has a loop, or all are
/// large.
pub fn long_functions(dae: &Dae) -> FastSet<FunctionId> {
    let takes_long = |f: &FunctionId| {
        let called = reached(dae, *f);
        if called.contains(f) {
            return true;
        }
        let all = called.into_iter().chain([*f]);
        let bodies: Vec<&[Statement]> = all.map(|g| &dae.functions[g].body[..]).collect();
        bodies.iter().any(|b| has_loop(b)) || bodies.iter().map(|b| count(b)).sum::<usize>() > MANY
    };
    dae.functions.ids().filter(takes_long).collect()
}

fn has_loop(body: &[Statement]) -> bool {
    body.iter().any(|statement| match statement {
        Statement::While(..) => true,
        Statement::If(_, a, b) => has_loop(a) || has_loop(b),
        _ => false,
    })
}

fn count(body: &[Statement]) -> usize {
    let of = |statement: &Statement| match statement {
        Statement::If(_, a, b) => 1 + count(a) + count(b),
        _ => 1,
    };
    body.iter().map(of).sum()
}

fn calls(dae: &Dae, roots: Vec<ExprId>) -> impl Iterator<Item = Called> {
    dae.graph.postorder(roots).into_iter().filter_map(|e| match dae.graph.node(e) {
        Node::Call { function, args, .. } => Some((function, args)),
        _ => None,
    })
}

/// All expressions of the system but those of its equations and assertions.
fn others(dae: &Dae) -> Vec<ExprId> {
    let mut all: Vec<ExprId> = dae.parameters.iter().map(|(_, e)| *e).collect();
    all.extend(dae.relations.iter().flat_map(|r| [r.lhs, r.rhs]));
    all.extend(dae.samples.iter().flat_map(|s| [s.start, s.interval]));
    all.extend(dae.reinits.iter().flat_map(|r| [r.active, r.value]));
    all.extend(dae.asserts.iter().filter_map(|a| a.active));
    all.extend(dae.terminates.iter().flat_map(|t| [t.active, t.message]));
    all.extend(dae.delays.iter().map(|(_, e)| *e));
    all.extend(dae.transports.iter().flat_map(|t| &t.initial).flat_map(|(p, v)| [*p, *v]));
    for v in dae.variables.iter() {
        all.extend([v.start, v.min, v.max, v.nominal].into_iter().flatten());
    }
    all
}
