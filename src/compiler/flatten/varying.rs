//! Parameters that vary: `annotation(__mocc(varies = "p = factor"))`.
//!
//! Modelica has no parameter that changes while a model runs, and a component cannot be given a variable
//! where its class declares a parameter. A model that mocc has amended can need both: a friction that grows
//! with position, a conductance that depends on temperature. The vendor-specific annotation (Modelica 3.6,
//! section 18.1) names the parameter and a variable of the model: every equation then reads their product
//! in place of the parameter, directly or by way of parameters that are bound to it. Attributes such as
//! `start` keep the parameter's own value.

use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::ir::ast::Variability;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{FlatModel, Variable};
use crate::symbolic::rewrite::Rewriter;

use super::annotation::Pair;
use super::cause::{FlattenCause, WrongVariation};

/// Lets the parameters vary, each given with its factor: adds a variable for each of them and for each parameter that is bound to one,
/// and reads it in all equations.
pub(super) fn apply(flat: &mut FlatModel, variations: &[Pair]) -> Vec<Diagnostic> {
    if variations.is_empty() {
        return Vec::new();
    }
    let mut problems = Vec::new();
    let by_name: FastMap<&str, VarId> =
        flat.variables.enumerate().map(|(v, x)| (x.name.as_str(), v)).collect();
    let mut factors: Vec<(VarId, Vec<VarId>)> = Vec::new();
    for v in variations {
        let parameter = by_name.get(v.left.as_str()).copied();
        let factor = by_name.get(v.right.as_str()).copied();
        match check(flat, parameter, factor) {
            Ok((parameter, factor)) => {
                match factors.iter_mut().find(|(known, _)| *known == parameter) {
                    Some((_, all)) => all.push(factor),
                    None => factors.push((parameter, vec![factor])),
                }
            }
            Err(why) => {
                let (parameter, factor) = (v.left.clone(), v.right.clone());
                let cause = FlattenCause::UnusableVariation { parameter, factor, why };
                problems.push(Diagnostic::new(cause, v.span));
            }
        }
    }
    let variants = variants(flat, &factors);
    for (v, _) in &variants {
        // A parameter that fixes the structure cannot follow the one that it is bound to.
        if flat.variables[*v].structural {
            let (parameter, why) = (flat.variables[*v].name.clone(), WrongVariation::Structural);
            let cause = FlattenCause::UnusableVariation { parameter, factor: String::new(), why };
            problems.push(Diagnostic::new(cause, flat.variables[*v].span));
        }
    }
    if problems.is_empty() {
        substitute(flat, &factors, &variants);
    }
    problems
}

fn check(
    flat: &FlatModel,
    parameter: Option<VarId>,
    factor: Option<VarId>,
) -> Result<(VarId, VarId), WrongVariation> {
    let parameter = parameter.ok_or(WrongVariation::Unknown)?;
    let p = &flat.variables[parameter];
    if p.ty != Type::Real || p.variability != Variability::Parameter {
        return Err(WrongVariation::NotReal);
    }
    let factor = factor.ok_or(WrongVariation::Factor)?;
    match flat.variables[factor].ty {
        Type::Real => Ok((parameter, factor)),
        _ => Err(WrongVariation::Factor),
    }
}

/// The varying form of every parameter that varies, in order of dependence.
fn variants(flat: &mut FlatModel, factors: &[(VarId, Vec<VarId>)]) -> Vec<(VarId, VarId)> {
    let mut taken: FastSet<String> = flat.variables.iter().map(|v| v.name.clone()).collect();
    let mut out: Vec<(VarId, VarId)> = Vec::new();
    let mut known: FastSet<VarId> = FastSet::default();
    let mut wanted: Vec<VarId> = factors.iter().map(|(p, _)| *p).collect();
    while !wanted.is_empty() {
        for v in wanted.drain(..) {
            let of = &flat.variables[v];
            let mut name = format!("{}_varying", of.name);
            while !taken.insert(name.clone()) {
                name.push('_');
            }
            let bare = Variable::bare(name, Type::Real, Variability::Continuous, of.span);
            let (unit, display_unit) = (of.unit, of.display_unit);
            let description = of.description.clone();
            let new = flat.variables.push(Variable { unit, display_unit, description, ..bare });
            flat.synthetic.push(new);
            known.insert(v);
            out.push((v, new));
        }
        for (v, x) in flat.variables.enumerate() {
            let bound = x.binding.filter(|_| x.variability == Variability::Parameter);
            let Some(bound) = bound.filter(|_| !known.contains(&v)) else { continue };
            if flat.graph.variables(bound).iter().any(|read| known.contains(read)) {
                wanted.push(v);
            }
        }
    }
    out
}

/// Defines the varying forms, and reads them wherever an equation reads the parameter.
fn substitute(flat: &mut FlatModel, factors: &[(VarId, Vec<VarId>)], variants: &[(VarId, VarId)]) {
    let varying: FastMap<VarId, VarId> = variants.iter().copied().collect();
    let mut graph = std::mem::take(&mut flat.graph);
    let mut rewriter = Rewriter::new();
    let mut replaced = |graph: &mut crate::ir::expr::Graph, e: ExprId| {
        rewriter.apply(graph, e, &mut |graph, e| match graph.node(e) {
            Node::Var(v) => varying.get(&v).map(|new| graph.var(*new, Type::Real)),
            _ => None,
        })
    };
    for e in flat.equations.iter_mut().chain(&mut flat.initial_equations) {
        e.map_expressions(&mut |e| replaced(&mut graph, e));
    }
    for x in flat.variables.iter_mut() {
        if x.variability > Variability::Parameter {
            x.binding = x.binding.map(|e| replaced(&mut graph, e));
        }
    }
    for delay in &mut flat.delays {
        delay.time = replaced(&mut graph, delay.time);
    }
    for (v, new) in variants {
        let binding = match factors.iter().find(|(p, _)| p == v) {
            Some((_, factors)) => {
                let mut product = graph.var(*v, Type::Real);
                for f in factors {
                    let f = graph.var(*f, Type::Real);
                    product = graph.mul(product, f);
                }
                Some(product)
            }
            None => flat.variables[*v].binding.map(|e| replaced(&mut graph, e)),
        };
        flat.variables[*new].binding = binding;
    }
    flat.graph = graph;
}
