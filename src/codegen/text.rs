//! Operations on texts. A run computes with their numbers, which equal texts share.

use crate::ir::expr::{Binary, Type, Unary};
use crate::ir::native::{Function, Native};
use crate::ir::program::Op;

/// An operation on two texts.
pub struct Operation {
    /// What is done with their numbers.
    pub op: Op,
    /// With the second text as the first operand.
    pub swapped: bool,
    /// The result is the contrary.
    pub negated: bool,
}

/// The operator for an operand of type `ty`.
pub fn unary(op: Unary, ty: Type) -> Unary {
    match op {
        Unary::Text(form) => Unary::Native(Native::of(Function::Written(form, ty != Type::Real))),
        op => op,
    }
}

/// The operation on two texts.
pub fn binary(op: Binary) -> Operation {
    let native = |f| Op::Binary(Binary::Native(Native::of(f)));
    let of = |op, swapped, negated| Operation { op, swapped, negated };
    match op {
        Binary::Add => of(native(Function::Joined), false, false),
        Binary::Less => of(native(Function::Precedes), false, false),
        Binary::Greater => of(native(Function::Precedes), true, false),
        Binary::LessEqual => of(native(Function::Precedes), true, true),
        Binary::GreaterEqual => of(native(Function::Precedes), false, true),
        op => of(Op::Binary(op), false, false),
    }
}
