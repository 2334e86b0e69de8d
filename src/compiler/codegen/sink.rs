//! Sinking of expensive calls: a call whose results are used only in branches of `if` expressions
//! or when-clauses is made only if such a branch is taken.

use crate::base::index::{FastMap, FastSet, Id};
use crate::graph::scc::nodes_on_cycles;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, FunctionId, ListId, Node};
use crate::ir::flat::{Function, Statement};
use crate::symbolic::uses::{Root, Uses};

use super::derivative_function::Derivatives;
use super::function::reached;

/// Number of statements from which on a function counts as large.
const LARGE_BODY: usize = 100;

/// Number of operations from which on a function counts as large, though its statements are few.
const MANY_OPERATIONS: usize = 1_000;

/// Identity of a call: function and arguments.
pub type CallKey = (FunctionId, ListId);

/// The conditions of expensive calls in equations and assertions. Calls that also occur elsewhere
/// (in relations, clocks, ...) are unconditional.
pub fn sink_conditions(dae: &mut Dae, expensive: &FastSet<FunctionId>) -> FastMap<CallKey, ExprId> {
    if expensive.is_empty() {
        return FastMap::default();
    }
    let mut all = Vec::new();
    dae.for_each_equation_expression(&mut |e| all.push(e));
    let roots: Vec<Root> = all.iter().map(|e| (*e, None)).collect();
    let expensive: FastSet<CallKey> =
        calls(dae, all).filter(|(f, _)| expensive.contains(f)).collect();
    if expensive.is_empty() {
        return FastMap::default();
    }
    let mut others = Vec::new();
    dae.for_each_side_expression(&mut |e| others.push(e));
    let elsewhere: FastSet<CallKey> = calls(dae, others).collect();
    let uses = Uses::of(&mut dae.graph, &roots, &|_, _| false);
    // One call computes all outputs of a function, and is needed if any of them is.
    let mut common: FastMap<CallKey, usize> = FastMap::default();
    for (&e, &(_, condition)) in &uses.of {
        let Node::Call { function, args, .. } = dae.graph.node(e) else { continue };
        let call = (function, args);
        if expensive.contains(&call) && !elsewhere.contains(&call) {
            let known = common.entry(call).or_insert(condition);
            *known = uses.nesting.common(*known, condition);
        }
    }
    let mut found: Vec<(CallKey, usize)> = common.into_iter().filter(|(_, g)| *g != 0).collect();
    found.sort_unstable_by_key(|((function, args), _)| (function.idx(), args.0));
    let found: Vec<(CallKey, ExprId)> =
        found.into_iter().map(|(c, g)| (c, uses.all(&mut dae.graph, g, 0))).collect();
    without_cycles(dae, found)
}

crate::define_id! {
    /// A call that has a condition.
    struct SunkCall
}

/// Makes calls unconditional whose condition depends on their own result.
fn without_cycles(dae: &Dae, found: Vec<(CallKey, ExprId)>) -> FastMap<CallKey, ExprId> {
    let number: FastMap<CallKey, SunkCall> =
        found.iter().enumerate().map(|(k, (call, _))| (*call, SunkCall::from_usize(k))).collect();
    let mut needs = Vec::new();
    for (k, (_, condition)) in found.iter().enumerate() {
        let read = calls(dae, vec![*condition]).filter_map(|call| number.get(&call).copied());
        needs.extend(read.map(|other| (SunkCall::from_usize(k), other)));
    }
    let mut sink_conditions: FastMap<CallKey, ExprId> = found.iter().copied().collect();
    for k in nodes_on_cycles(found.len(), needs) {
        sink_conditions.remove(&found[k.idx()].0);
    }
    sink_conditions
}

/// The functions whose calls may be expensive: recursive ones, those that execute a loop, and those
/// that are large including everything they call.
pub fn expensive_functions(dae: &Dae, derivatives: &Derivatives) -> FastSet<FunctionId> {
    let is_expensive = |f: &FunctionId| {
        let called = reached(dae, derivatives, *f);
        if called.contains(f) {
            return true;
        }
        let all: Vec<&Function> =
            called.into_iter().chain([*f]).map(|g| &dae.functions[g]).collect();
        let operations = |g: &&Function| dae.graph.postorder(g.values()).len();
        all.iter().any(|g| g.has_loop())
            || all.iter().map(|g| count(&g.body)).sum::<usize>() > LARGE_BODY
            || all.iter().map(operations).sum::<usize>() > MANY_OPERATIONS
    };
    dae.functions.ids().filter(is_expensive).collect()
}

fn count(body: &[Statement]) -> usize {
    let of = |statement: &Statement| match statement {
        Statement::If(_, a, b) => 1 + count(a) + count(b),
        _ => 1,
    };
    body.iter().map(of).sum()
}

fn calls(dae: &Dae, roots: Vec<ExprId>) -> impl Iterator<Item = CallKey> {
    dae.graph.postorder(roots).into_iter().filter_map(|e| match dae.graph.node(e) {
        Node::Call { function, args, .. } => Some((function, args)),
        _ => None,
    })
}
