//! The contract of [`FlatModel`].

use super::expressions::{Scope, compatible};
use crate::base::index::{FastSet, Id};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{Action, Assert, EquationKind, FlatModel, Variability, WhenBranch};

/// Everything in which a flat model breaks its contract.
pub fn check(flat: &FlatModel) -> Vec<String> {
    let mut found = Vec::new();
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    let type_of = |v: VarId| flat.variables.get(v).map(|x| x.ty);
    let constant =
        |v: VarId| flat.variables.get(v).is_some_and(|x| x.variability < Variability::Continuous);
    let forbidden = |node| match node {
        Node::Der(v) if constant(v) => Some("der() of a variable that is not continuous"),
        Node::Relation(_) => Some("relations are numbered by `lower`"),
        _ => None,
    };
    let scope = Scope {
        graph: &flat.graph,
        type_of: &type_of,
        functions: &flat.functions,
        forbidden: &forbidden,
    };
    scope.check(&roots, &mut found);
    if !found.is_empty() {
        // What follows reads the expressions.
        return found;
    }
    variables(flat, &mut found);
    for equation in flat.equations.iter().chain(&flat.initial_equations) {
        kind(flat, &equation.kind, &mut found);
    }
    for function in &flat.functions {
        super::function::check(&flat.graph, function, &mut found);
    }
    let exists = |v: &VarId| v.idx() < flat.variables.len();
    let referred =
        flat.recorded.iter().chain(&flat.synthetic).chain(flat.delays.iter().map(|d| &d.variable));
    if !referred.chain(flat.transports.iter().flat_map(|t| &t.ends)).all(exists) {
        found.push("a recorded, delayed or synthetic variable does not exist".to_owned());
    }
    found
}

fn variables(flat: &FlatModel, found: &mut Vec<String>) {
    let mut names: FastSet<&str> = FastSet::default();
    for variable in &flat.variables {
        if variable.name.is_empty() || !names.insert(&variable.name) {
            found.push(format!("the name `{}` is empty or not unique", variable.name));
        }
        if variable.variability == Variability::Continuous && variable.ty != Type::Real {
            found.push(format!("`{}` is continuous and not Real", variable.name));
        }
        if let Some(e) = variable.binding
            && !compatible(flat.graph.ty(e), variable.ty)
        {
            let given = flat.graph.ty(e);
            found.push(format!("`{}` is {:?}, its binding {given:?}", variable.name, variable.ty));
        }
    }
}

fn kind(flat: &FlatModel, kind: &EquationKind, found: &mut Vec<String>) {
    let ty = |e: ExprId| flat.graph.ty(e);
    match kind {
        EquationKind::Equal(a, b) if !compatible(ty(*a), ty(*b)) => {
            found.push(format!("an equation of {:?} and {:?}", ty(*a), ty(*b)));
        }
        EquationKind::Equal(..) => {}
        EquationKind::Assert(assert) => message(flat, assert, found),
        EquationKind::Algorithm { outputs, values } => {
            if outputs.len() != values.len() {
                let counts = (outputs.len(), values.len());
                found
                    .push(format!("an algorithm has {} outputs and {} values", counts.0, counts.1));
            }
            for (v, e) in outputs.iter().zip(values) {
                assigned(flat, *v, *e, found);
            }
        }
        EquationKind::When(branches) => {
            for WhenBranch { conditions, actions } in branches {
                if conditions.is_empty() || conditions.iter().any(|c| ty(*c) != Type::Boolean) {
                    found.push("a when-clause has no Boolean condition".to_owned());
                }
                for action in actions {
                    match action {
                        Action::Assign(v, e) | Action::Reinit { state: v, value: e, .. } => {
                            assigned(flat, *v, *e, found);
                        }
                        Action::Assert(assert) => message(flat, assert, found),
                        Action::Terminate { message, .. } if ty(*message) != Type::String => {
                            found.push("terminate() without a string".to_owned());
                        }
                        Action::Terminate { .. } => {}
                    }
                }
            }
        }
    }
}

/// That a variable may be assigned at all is checked by `lower`, which reports it to the user.
fn assigned(flat: &FlatModel, v: VarId, e: ExprId, found: &mut Vec<String>) {
    let Some(variable) = flat.variables.get(v) else {
        found.push(format!("variable {} is assigned and does not exist", v.0));
        return;
    };
    if !compatible(variable.ty, flat.graph.ty(e)) {
        let given = flat.graph.ty(e);
        found.push(format!("`{}` is {:?}, and is assigned {given:?}", variable.name, variable.ty));
    }
}

fn message(flat: &FlatModel, assert: &Assert, found: &mut Vec<String>) {
    let types = (flat.graph.ty(assert.condition), flat.graph.ty(assert.message));
    if types != (Type::Boolean, Type::String) {
        found.push(format!("an assertion of {:?} with a message of {:?}", types.0, types.1));
    }
}
