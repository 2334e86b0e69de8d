//! String operations. The runtime represents strings by numbers; equal strings have equal numbers.

use std::cmp::Ordering::{self, Equal, Greater, Less};
use std::sync::Arc;

use crate::external::string_operator::{CompareStrings, Concatenate, FormatNumber};
use crate::ir::expr::{Binary, Graph, Type, Unary};

/// The operator for an operand of type `ty`.
pub fn unary(graph: &mut Graph, op: Unary, ty: Type) -> Unary {
    match op {
        Unary::Text(form) => {
            let format = FormatNumber { form: graph.forms[form], is_integer: ty != Type::Real };
            Unary::External(graph.add_external(Arc::new(format)))
        }
        op => op,
    }
}

/// The operator for operands of type `ty`.
pub fn binary(graph: &mut Graph, op: Binary, ty: Type) -> Binary {
    if ty != Type::String {
        return op;
    }
    let orders: &[Ordering] = match op {
        Binary::Add => return Binary::External(graph.add_external(Arc::new(Concatenate))),
        Binary::Less => &[Less],
        Binary::LessEqual => &[Less, Equal],
        Binary::Greater => &[Greater],
        Binary::GreaterEqual => &[Greater, Equal],
        op => return op,
    };
    Binary::External(graph.add_external(Arc::new(CompareStrings(orders.to_vec()))))
}
