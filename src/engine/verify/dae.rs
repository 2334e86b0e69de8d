//! The contract of [`Dae`].

use super::expressions::Scope;
use crate::base::index::{FastMap, FastSet, Id};
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Binary, ExprId, Node, Type, VarId};

/// Everything in which a system breaks its contract.
pub fn check(dae: &Dae) -> Vec<String> {
    let mut found = Vec::new();
    let mut roots = Vec::new();
    dae.for_each_expression(&mut |e| roots.push(e));
    let type_of = |v: VarId| dae.variables.get(v).map(|x| x.ty);
    let relations = dae.relations.len();
    let forbidden = |node| match node {
        Node::Der(_) => Some("derivatives are variables"),
        Node::Sample(..) => Some("clocks are flags"),
        Node::Homotopy(..) => Some("only the actual expression is left"),
        Node::Relation(k) if k as usize >= relations => Some("there is no such relation"),
        _ => None,
    };
    let scope = Scope {
        graph: &dae.graph,
        type_of: &type_of,
        functions: &dae.functions,
        forbidden: &forbidden,
    };
    scope.check(&roots, &mut found);
    if found.is_empty() {
        // What follows reads the expressions and variables.
        variables(dae, &mut found);
        parameters(dae, &mut found);
        equations(dae, &mut found);
        events(dae, &mut found);
        for function in &dae.functions {
            super::function::check(&dae.graph, function, &mut found);
        }
    }
    found
}

fn name(dae: &Dae, v: VarId) -> &str {
    dae.variables.get(v).map_or("?", |x| x.name.as_str())
}

fn variables(dae: &Dae, found: &mut Vec<String>) {
    let eliminated: FastSet<VarId> = dae.eliminated.iter().map(|(v, _)| *v).collect();
    if eliminated.len() != dae.eliminated.len() {
        found.push("a variable is eliminated twice".to_owned());
    }
    for (v, variable) in dae.variables.enumerate() {
        if let VariableKind::Differentiated { derivative } = variable.kind
            && dae.variables.get(derivative).is_none_or(|d| d.derivative_of != Some(v))
        {
            found.push(format!("the derivative of `{}` is not its derivative", variable.name));
        }
        if (variable.kind == VariableKind::Eliminated) != eliminated.contains(&v) {
            found.push(format!("`{}` is eliminated without a value, or not", variable.name));
        }
    }
    for &(v, value) in &dae.eliminated {
        for read in dae.graph.variables(value) {
            if eliminated.contains(&read) {
                found.push(format!("`{}` is replaced by eliminated variables", name(dae, v)));
            }
        }
    }
}

/// Each value reads earlier ones only.
fn parameters(dae: &Dae, found: &mut Vec<String>) {
    let position: FastMap<VarId, usize> =
        dae.parameters.iter().enumerate().map(|(k, (v, _))| (*v, k)).collect();
    for (k, &(v, value)) in dae.parameters.iter().enumerate() {
        if dae.variables[v].kind != VariableKind::Parameter {
            found.push(format!("`{}` has a value and is not a parameter", name(dae, v)));
        }
        for read in dae.graph.variables(value) {
            if position.get(&read).is_none_or(|at| *at >= k) {
                let (of, read) = (name(dae, v), name(dae, read));
                found.push(format!("parameter `{of}` reads `{read}`, which is not before it"));
            }
        }
    }
}

fn equations(dae: &Dae, found: &mut Vec<String>) {
    let ty = |e: ExprId| dae.graph.ty(e);
    for (id, e) in dae.equations.enumerate() {
        if ty(e.residual) != Type::Real {
            found.push(format!("continuous equation {} is of type {:?}", id.0, ty(e.residual)));
        }
        if e.derivative_of.is_some_and(|of| of >= id) {
            found.push(format!("equation {} precedes the one it is the derivative of", id.0));
        }
    }
    let mut assigned = FastSet::default();
    for d in &dae.discrete {
        let kind = dae.variables.get(d.variable).map(|x| x.kind);
        if kind != Some(VariableKind::Discrete) {
            found.push(format!(
                "`{}` has a discrete equation, and is {kind:?}",
                name(dae, d.variable)
            ));
        }
        if !assigned.insert(d.variable) {
            found.push(format!("`{}` has two discrete equations", name(dae, d.variable)));
        }
    }
}

fn events(dae: &Dae, found: &mut Vec<String>) {
    for (k, r) in dae.relations.iter().enumerate() {
        let ordered = matches!(
            r.op,
            Binary::Less | Binary::LessEqual | Binary::Greater | Binary::GreaterEqual
        );
        if !ordered {
            found.push(format!("relation {k} is {:?}", r.op));
        }
    }
    for r in &dae.reinits {
        let kind = dae.variables.get(r.state).map(|x| x.kind);
        if !matches!(kind, Some(VariableKind::Differentiated { .. })) {
            found.push(format!("reinit() of `{}`, which is {kind:?}", name(dae, r.state)));
        }
    }
    for s in &dae.samples {
        if s.flag.idx() >= dae.variables.len() || dae.variables[s.flag].ty != Type::Boolean {
            found.push(format!("the flag `{}` of a clock is not Boolean", name(dae, s.flag)));
        }
    }
}
