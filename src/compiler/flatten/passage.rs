//! Signals that pass through a component: `annotation(__mocc(through = "u = actuator.y"))`.
//!
//! What a recording says about an input, or what a controller asks for, need not be what reaches the system: an actuator
//! has an offset, a lag, a dead zone. A model that extends another one cannot redirect the equations that read a signal, so
//! that the vendor-specific annotation (Modelica 3.6, section 18.1) says it: every equation reads the output of the
//! component in place of the signal, except those of the component itself. A signal is an input of the model, a variable
//! that one equation is solved for, or an output of a component; that equation, and all those of the component whose
//! output it is, keep reading the signal. Several components of one signal follow one another.

use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::ast::{Causality, Variability};
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::FlatModel;
use crate::symbolic::rewrite::Rewriter;

use super::annotation::Pair;
use super::cause::{FlattenCause, WrongPassage};
use super::open_equation::{Slot, explicit_equation};

/// A signal and the output of a component that is read in its place.
struct Passage {
    signal: VarId,
    output: VarId,
    /// The component, with a dot.
    component: String,
    /// What determines the signal.
    source: Source,
}

/// What determines a signal, and goes on reading it.
#[derive(Default)]
struct Source {
    /// The equation that is solved for it.
    equation: Option<Slot>,
    /// The component whose output it is, with a dot.
    component: Option<String>,
}

impl Source {
    /// True for an equation, by its position and the component that it comes from.
    fn has_equation(&self, k: usize, component: &str) -> bool {
        let own = self.component.as_deref().and_then(|c| c.strip_suffix('.'));
        let is_inside = |own| {
            component
                .strip_prefix(own)
                .is_some_and(|rest: &str| rest.is_empty() || rest.starts_with('.'))
        };
        self.equation == Some(Slot::Equation(k)) || own.is_some_and(is_inside)
    }

    /// True for the binding of a variable, by its name.
    fn has_binding(&self, v: VarId, name: &str) -> bool {
        self.equation == Some(Slot::Binding(v))
            || self.component.as_deref().is_some_and(|own| name.starts_with(own))
    }
}

/// Reads outputs in place of signals, each pair a signal and an output. Returns what cannot be done.
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
                let (signal, output) = (pair.left.clone(), pair.right.clone());
                let cause = FlattenCause::UnusablePassage { signal, output, why };
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
    let signal = *by_name.get(pair.left.as_str()).ok_or(WrongPassage::Signal)?;
    let source = source(flat, signal).ok_or(WrongPassage::Signal)?;
    let output = *by_name.get(pair.right.as_str()).ok_or(WrongPassage::Output)?;
    let (component, _) = pair.right.rsplit_once('.').ok_or(WrongPassage::Output)?;
    match flat.variables[output].ty {
        Type::Real => Ok(Passage { signal, output, component: format!("{component}."), source }),
        _ => Err(WrongPassage::Output),
    }
}

/// What determines a variable; `None` if it is not a signal.
fn source(flat: &FlatModel, v: VarId) -> Option<Source> {
    let x = &flat.variables[v];
    if x.ty != Type::Real || x.variability != Variability::Continuous {
        return None;
    }
    if x.causality == Some(Causality::Input) && x.binding.is_none() {
        return Some(Source::default());
    }
    let equation = explicit_equation(flat, v).map(|e| e.slot());
    match flat.ownership.is_output_of_component(v) {
        true => {
            let component = x.name.rsplit_once('.').map(|(owner, _)| format!("{owner}."));
            Some(Source { equation, component })
        }
        false => equation.map(|slot| Source { equation: Some(slot), component: None }),
    }
}

/// Replaces the signals wherever they are read.
fn redirect(flat: &mut FlatModel, passages: &[Passage]) {
    let mut graph = std::mem::take(&mut flat.graph);
    let mut readers = Readers::new(passages);
    for (k, e) in flat.equations.iter_mut().enumerate() {
        let own: Vec<bool> =
            passages.iter().map(|p| p.source.has_equation(k, &e.origin.component)).collect();
        e.map_expressions(&mut |e| readers.read(&mut graph, e, &own));
    }
    let own: Vec<bool> = vec![false; passages.len()];
    for e in &mut flat.initial_equations {
        e.map_expressions(&mut |e| readers.read(&mut graph, e, &own));
    }
    for delay in &mut flat.delays {
        delay.time = readers.read(&mut graph, delay.time, &own);
    }
    for (k, x) in flat.variables.iter_mut().enumerate() {
        let varies = x.variability > Variability::Parameter;
        let (v, Some(bound)) = (VarId(k as u32), x.binding.filter(|_| varies)) else { continue };
        let inside = passages.iter().position(|p| x.name.starts_with(&p.component));
        x.binding = Some(match inside {
            None => {
                let own: Vec<bool> =
                    passages.iter().map(|p| p.source.has_binding(v, &x.name)).collect();
                readers.read(&mut graph, bound, &own)
            }
            Some(k) => {
                let before = passages[..k].iter().map(|p| (p.signal, p.output)).collect();
                replaced(&mut Rewriter::new(), &mut graph, bound, &before)
            }
        });
    }
    flat.graph = graph;
}

/// What reads signals outside of the components that they pass through.
struct Readers<'a> {
    passages: &'a [Passage],
    /// For each choice of signals that are kept: what is read in place of the others, and the expressions so far.
    known: FastMap<Vec<bool>, (FastMap<VarId, VarId>, Rewriter)>,
}

impl<'a> Readers<'a> {
    fn new(passages: &'a [Passage]) -> Readers<'a> {
        Readers { passages, known: FastMap::default() }
    }

    /// An expression that reads the last output of each signal, except of those that `own` says are kept.
    fn read(&mut self, graph: &mut Graph, e: ExprId, own: &[bool]) -> ExprId {
        if !self.known.contains_key(own) {
            let read = self.passages.iter().zip(own).filter(|(_, own)| !**own);
            let by = read.map(|(p, _)| (p.signal, p.output)).collect();
            self.known.insert(own.to_vec(), (by, Rewriter::new()));
        }
        match self.known.get_mut(own) {
            Some((by, rewriter)) => replaced(rewriter, graph, e, by),
            None => e,
        }
    }
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
