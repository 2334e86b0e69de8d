//! String operations. The runtime represents strings by numbers; equal strings have equal numbers.

use std::cmp::Ordering::{Equal, Greater, Less};

use crate::ir::expr::{Binary, Type, Unary};
use crate::ir::native::{Function, Native};

/// The operator for an operand of type `ty`.
pub fn unary(op: Unary, ty: Type) -> Unary {
    match op {
        Unary::Text(form) => Unary::Native(Native::of(Function::Written(form, ty != Type::Real))),
        op => op,
    }
}

/// The operator for operands of type `ty`.
pub fn binary(op: Binary, ty: Type) -> Binary {
    if ty != Type::String {
        return op;
    }
    let function = match op {
        Binary::Add => Function::Joined,
        Binary::Less => Function::Ordered(vec![Less]),
        Binary::LessEqual => Function::Ordered(vec![Less, Equal]),
        Binary::Greater => Function::Ordered(vec![Greater]),
        Binary::GreaterEqual => Function::Ordered(vec![Greater, Equal]),
        op => return op,
    };
    Binary::Native(Native::of(function))
}
