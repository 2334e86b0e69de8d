//! Inputs that pass through a component: `annotation(__mocc(through = "u = actuator.y"))`.
//!
//! What a recording says about an input need not be what reaches the system: an actuator has an offset, a lag, a dead
//! zone. A model that extends another one cannot redirect the equations that read its input, so that the vendor-specific
//! annotation (Modelica 3.6, section 18.1) says it: every equation reads the output of the component in place of the
//! input, except those of the component itself. Several components of one input follow one another.

use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::ast::{Causality, Variability};
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::FlatModel;
use crate::symbolic::rewrite::Rewriter;

use super::annotation::Pair;
use super::cause::{FlattenCause, WrongPassage};

/// An input and the output of a component that is read in its place.
struct Passage {
    input: VarId,
    output: VarId,
    /// The component, with a dot.
    component: String,
}

/// Reads outputs in place of inputs, each pair an input and an output. Returns what cannot be done.
pub(super) fn apply(flat: &mut FlatModel, pairs: &[Pair]) -> Vec<Diagnostic> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let by_name: FastMap<&str, VarId> =
        flat.variables.enumerate().map(|(v, x)| (x.name.as_str(), v)).collect();
    let (mut passages, mut problems) = (Vec::new(), Vec::new());
    for pair in pairs {
        match passage(flat, &by_name, pair) {
            Ok(passage) => passages.push(passage),
            Err(why) => {
                let (input, output) = (pair.left.clone(), pair.right.clone());
                let cause = FlattenCause::UnusablePassage { input, output, why };
                problems.push(Diagnostic::new(cause, pair.span));
            }
        }
    }
    if problems.is_empty() {
        redirect(flat, &passages);
    }
    problems
}

fn passage(
    flat: &FlatModel,
    by_name: &FastMap<&str, VarId>,
    pair: &Pair,
) -> Result<Passage, WrongPassage> {
    let input = *by_name.get(pair.left.as_str()).ok_or(WrongPassage::Input)?;
    let u = &flat.variables[input];
    let is_free = u.causality == Some(Causality::Input) && u.binding.is_none();
    if u.ty != Type::Real || !is_free {
        return Err(WrongPassage::Input);
    }
    let output = *by_name.get(pair.right.as_str()).ok_or(WrongPassage::Output)?;
    let (component, _) = pair.right.rsplit_once('.').ok_or(WrongPassage::Output)?;
    match flat.variables[output].ty {
        Type::Real => Ok(Passage { input, output, component: format!("{component}.") }),
        _ => Err(WrongPassage::Output),
    }
}

/// Replaces the inputs wherever they are read.
fn redirect(flat: &mut FlatModel, passages: &[Passage]) {
    let mut graph = std::mem::take(&mut flat.graph);
    // Outside of the components, the last output of an input is read.
    let last: FastMap<VarId, VarId> = passages.iter().map(|p| (p.input, p.output)).collect();
    let mut everywhere = Rewriter::new();
    let mut outside = |graph: &mut Graph, e: ExprId| replaced(&mut everywhere, graph, e, &last);
    for e in flat.equations.iter_mut().chain(&mut flat.initial_equations) {
        e.map_expressions(&mut |e| outside(&mut graph, e));
    }
    for delay in &mut flat.delays {
        delay.time = outside(&mut graph, delay.time);
    }
    for x in flat.variables.iter_mut().filter(|x| x.variability > Variability::Parameter) {
        let Some(bound) = x.binding else { continue };
        let own = passages.iter().position(|p| x.name.starts_with(&p.component));
        x.binding = Some(match own {
            None => outside(&mut graph, bound),
            Some(k) => {
                let before = passages[..k].iter().map(|p| (p.input, p.output)).collect();
                replaced(&mut Rewriter::new(), &mut graph, bound, &before)
            }
        });
    }
    flat.graph = graph;
}

fn replaced(
    rewriter: &mut Rewriter,
    graph: &mut Graph,
    e: ExprId,
    by: &FastMap<VarId, VarId>,
) -> ExprId {
    rewriter.apply(graph, e, &mut |graph, e| match graph.node(e) {
        Node::Var(v) => by.get(&v).map(|new| graph.var(*new, Type::Real)),
        _ => None,
    })
}
