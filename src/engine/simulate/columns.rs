//! Columns of a result: names, units, and which of them are aliases or constant.

use crate::base::index::FastMap;
use crate::ir::dae::{Dae, Variable, VariableKind};
use crate::ir::expr::{ExprId, Node, Type, Unary, VarId};
use crate::ir::program::Program;
use crate::ir::trajectory::{self, Column, ColumnStorage, Constant};
use crate::runtime::machine::Machine;

/// The columns of the recorded variables.
pub fn columns(program: &Program) -> Vec<Column> {
    program.recorded.iter().map(|v| column(&program.blocks.dae.variables[*v])).collect()
}

/// How each column is determined: aliases refer to another column, and expressions of parameters
/// are constant.
pub fn column_storage(program: &Program) -> Vec<ColumnStorage> {
    let dae = &program.blocks.dae;
    let values: FastMap<VarId, ExprId> = dae.eliminated.iter().copied().collect();
    let mut first: FastMap<VarId, (usize, bool)> = FastMap::default();
    let storage = |(at, v): (usize, &VarId)| {
        if dae.variables[*v].kind == VariableKind::InitialParameter {
            return ColumnStorage::Constant;
        }
        let (root, negated) = match values.get(v) {
            None => (*v, false),
            Some(&value) => match alias(dae, value) {
                Some(alias) => alias,
                None if is_constant(dae, value) => return ColumnStorage::Constant,
                None => return ColumnStorage::Own,
            },
        };
        if is_parameter(dae, root) {
            return ColumnStorage::Constant;
        }
        let &mut (of, other) = first.entry(root).or_insert((at, negated));
        if of == at {
            ColumnStorage::Own
        } else {
            ColumnStorage::Alias { of, negated: negated != other }
        }
    };
    program.recorded.iter().enumerate().map(storage).collect()
}

/// The parameters and constants of an initialized run.
pub fn constants(machine: &Machine<'_>) -> Vec<Constant> {
    let program = machine.program;
    let constant = |v: &VarId| Constant {
        column: column(&program.blocks.dae.variables[*v]),
        value: machine.value(*v),
    };
    program.constants.iter().map(constant).collect()
}

fn column(v: &Variable) -> Column {
    let kind = match v.ty {
        Type::Boolean => trajectory::Kind::Boolean,
        Type::Integer | Type::Enumeration(_) => trajectory::Kind::Integer,
        _ if v.kind == VariableKind::Discrete => trajectory::Kind::Discrete,
        _ => trajectory::Kind::Continuous,
    };
    Column {
        name: v.name.clone(),
        unit: v.unit.as_str().to_owned(),
        display_unit: v.display_unit.as_str().to_owned(),
        description: v.description.as_deref().unwrap_or_default().to_owned(),
        kind,
    }
}

/// The variable that a value is an alias of, and whether it is negated.
/// The variable of which an expression is another name, and whether the sign differs.
pub fn alias(dae: &Dae, value: ExprId) -> Option<(VarId, bool)> {
    match dae.graph.node(value) {
        Node::Var(v) | Node::Der(v) => Some((v, false)),
        Node::Unary(Unary::Neg, a) => match dae.graph.node(a) {
            Node::Var(v) => Some((v, true)),
            _ => None,
        },
        _ => None,
    }
}

/// True for parameters and constants.
pub fn is_parameter(dae: &Dae, v: VarId) -> bool {
    matches!(dae.variables[v].kind, VariableKind::Parameter | VariableKind::InitialParameter)
}

/// True if an expression reads only literals and parameters.
pub fn is_constant(dae: &Dae, value: ExprId) -> bool {
    dae.graph.all([value], |_, node| match node {
        Node::Const(_) | Node::Unary(..) | Node::Binary(..) | Node::If(..) => true,
        Node::Var(v) => is_parameter(dae, v),
        _ => false,
    })
}
