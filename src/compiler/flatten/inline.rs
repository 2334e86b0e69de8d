//! The second decision about calls, when all of them are known: a function of which the model needs few copies
//! is inlined; the others stay calls.

use crate::base::index::{FastMap, FastSet, Id};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::expr::{Const, ExprId, FunctionId, Graph, ListId, Node, Type};
use crate::ir::flat::{Action, Assert, Equation, EquationKind, FlatModel, Origin, StraightLine};

/// Nodes that the copies of one function may add to a model. Formulas are solved and differentiated exactly, but all
/// their branches are evaluated: a call evaluates only those that are taken, such as the region of a medium.
const MOST_INLINED: usize = 10_000;

/// A call: the function and its arguments.
type Called = (FunctionId, ListId);

/// Inlines the calls of functions of which there are few; graph and functions are still those of `cx`.
pub(super) fn calls(cx: &mut Evaluator<'_>, flat: &mut FlatModel) {
    let sizes = cx.specialized_functions();
    if sizes.is_empty() {
        return;
    }
    // A body that is inlined may call others.
    loop {
        let mut roots = Vec::new();
        flat.for_each_expression(&mut |e| roots.push(e));
        let mut copies: FastMap<FunctionId, FastSet<ListId>> = FastMap::default();
        for (function, args) in called(&cx.graph, &roots) {
            if sizes.contains_key(&function) {
                copies.entry(function).or_default().insert(args);
            }
        }
        let is_small = |(f, all): &(&FunctionId, &FastSet<ListId>)| {
            sizes[*f].saturating_mul(all.len()) <= MOST_INLINED
        };
        let chosen = copies.iter().filter(is_small);
        let chosen: FastMap<FunctionId, StraightLine> = chosen
            .filter_map(|(f, _)| Some((*f, cx.loops.functions[f.idx()].straight_line()?)))
            .collect();
        if chosen.is_empty() {
            return drop_unused(cx, &sizes, &roots);
        }
        add_assertions(cx, flat, &chosen);
        substitute(cx, flat, &chosen);
    }
}

/// Functions that nothing calls any more have no code, and neither have outputs that nothing reads.
fn drop_unused(cx: &mut Evaluator<'_>, sizes: &FastMap<FunctionId, usize>, roots: &[ExprId]) {
    let mut used: FastMap<FunctionId, FastSet<u32>> = FastMap::default();
    let mut pending = outputs_read(&cx.graph, roots);
    while let Some((function, output)) = pending.pop() {
        let is_first = !used.contains_key(&function);
        if !used.entry(function).or_default().insert(output) {
            continue;
        }
        let code = &cx.loops.functions[function.idx()];
        let values = match code.straight_line().filter(|_| sizes.contains_key(&function)) {
            Some(body) => {
                let asserts = body.asserts.iter().flat_map(|(a, _)| [a.condition, a.message]);
                asserts.chain(body.outputs.get(output as usize).copied()).collect()
            }
            None if is_first => code.values(),
            None => continue,
        };
        pending.extend(outputs_read(&cx.graph, &values));
    }
    for function in sizes.keys() {
        let Some(outputs) = used.get(function) else {
            cx.loops.functions[function.idx()].body.clear();
            continue;
        };
        let Evaluator { class_graph, loops, .. } = &mut *cx;
        loops.functions[function.idx()].map_outputs(|k, value| {
            let is_read = outputs.contains(&(k as u32));
            if is_read { value } else { nothing(&mut class_graph.graph, value) }
        });
    }
}

/// A literal of the same type, or the value itself if there is none.
fn nothing(graph: &mut Graph, value: ExprId) -> ExprId {
    match graph.ty(value) {
        Type::Real => graph.real(0.0),
        Type::Integer => graph.integer(0),
        Type::Boolean => graph.boolean(false),
        _ => value,
    }
}

/// The outputs of functions that expressions read.
fn outputs_read(graph: &Graph, roots: &[ExprId]) -> Vec<(FunctionId, u32)> {
    let below = graph.postorder(roots.iter().copied()).into_iter();
    let read = below.filter_map(|e| match graph.node(e) {
        Node::Call { function, output, .. } => Some((function, output)),
        _ => None,
    });
    read.collect()
}

/// All calls below some expressions, each once, in the order of their evaluation.
fn called(graph: &Graph, roots: &[ExprId]) -> Vec<Called> {
    let mut met = FastSet::default();
    let mut found = Vec::new();
    for e in graph.postorder(roots.iter().copied()) {
        if let Node::Call { function, args, .. } = graph.node(e)
            && met.insert((function, args))
        {
            found.push((function, args));
        }
    }
    found
}

/// The assertions of the functions that are inlined become those of the equations that call them.
fn add_assertions(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    chosen: &FastMap<FunctionId, StraightLine>,
) {
    let mut in_equations = FastSet::default();
    for initial in [false, true] {
        let list = if initial { &mut flat.initial_equations } else { &mut flat.equations };
        let mut all = Vec::with_capacity(list.len());
        for mut equation in std::mem::take(list) {
            let origin = equation.origin.clone();
            if let EquationKind::When(branches) = &mut equation.kind {
                for branch in branches {
                    let mut roots = Vec::new();
                    branch
                        .actions
                        .iter()
                        .for_each(|a| a.for_each_expression(&mut |e| roots.push(e)));
                    let made = assertions(cx, &roots, chosen, &mut in_equations);
                    branch.actions.extend(made.into_iter().map(|(a, _)| Action::Assert(a)));
                }
                all.push(equation);
                continue;
            }
            let mut roots = Vec::new();
            equation.for_each_expression(&mut |e| roots.push(e));
            all.push(equation);
            for (assert, span) in assertions(cx, &roots, chosen, &mut in_equations) {
                let origin = Origin { span, component: origin.component.clone() };
                all.push(Equation { kind: EquationKind::Assert(assert), origin });
            }
        }
        *list = all;
    }
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    let mut elsewhere: Vec<Called> = called(&cx.graph, &roots);
    elsewhere.retain(|call| !in_equations.contains(call));
    for call in elsewhere {
        for (assert, span) in assertions_of(cx, call, chosen) {
            let origin = Origin { span, component: "".into() };
            flat.equations.push(Equation { kind: EquationKind::Assert(assert), origin });
        }
    }
}

fn assertions(
    cx: &mut Evaluator<'_>,
    roots: &[ExprId],
    chosen: &FastMap<FunctionId, StraightLine>,
    met: &mut FastSet<Called>,
) -> Vec<(Assert, Span)> {
    let all = called(&cx.graph, roots);
    met.extend(all.iter().copied());
    all.into_iter().flat_map(|call| assertions_of(cx, call, chosen)).collect()
}

/// The assertions of a call that is inlined, where it is active.
fn assertions_of(
    cx: &mut Evaluator<'_>,
    (function, args): Called,
    chosen: &FastMap<FunctionId, StraightLine>,
) -> Vec<(Assert, Span)> {
    let Some(body) = chosen.get(&function) else { return Vec::new() };
    let arguments = cx.graph.list(args).to_vec();
    let mut made = Vec::new();
    for (assert, span) in &body.asserts {
        let roots = [assert.condition, assert.message];
        let [condition, message] = cx.graph.with_arguments(&roots, &arguments)[..] else {
            continue;
        };
        let inactive = cx.graph.not(arguments[0]);
        let condition = cx.graph.or(inactive, condition);
        if cx.graph.as_const(condition) != Some(Const::Boolean(true)) {
            made.push((Assert { condition, message, level: assert.level }, *span));
        }
    }
    made
}

/// Replaces calls by bodies everywhere in the model.
fn substitute(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    chosen: &FastMap<FunctionId, StraightLine>,
) {
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    let mut new: FastMap<ExprId, ExprId> = FastMap::default();
    let mut results: FastMap<Called, Vec<ExprId>> = FastMap::default();
    for e in cx.graph.postorder(roots) {
        let (mut operands, mut changed) = (Vec::new(), false);
        cx.graph.for_each_operand(e, |a| {
            operands.push(new[&a]);
            changed |= new[&a] != a;
        });
        let rebuilt = if changed { cx.graph.rebuild(e, &operands) } else { e };
        let replaced = match cx.graph.node(rebuilt) {
            Node::Call { function, output, args } if chosen.contains_key(&function) => {
                let outputs = results
                    .entry((function, args))
                    .or_insert_with(|| cx.inlined_results(&chosen[&function].outputs, args));
                outputs[output as usize]
            }
            _ => rebuilt,
        };
        new.insert(e, replaced);
    }
    flat.map_expressions(&mut |_, e| new[&e]);
}
