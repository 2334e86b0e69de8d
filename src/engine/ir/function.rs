//! Functions that are called at run time: Modelica functions whose calls were not inlined, loops whose trip
//! count is known only at run time, and functions that call themselves.
//!
//! *Holds:* scalar locals, and statements over them; a call of another function, or of itself, is an
//! expression. The assertions of the user are statements.
//! *Never holds:* variables of the model, time, events, arrays, records.
//! *Made by:* `evaluate`. *Read by:* all stages from the flat model to the code.

use super::expr::ExprId;
use crate::base::index::IndexVec;
use crate::base::name::Name;
use crate::base::source::Span;

/// `assert(condition, message, level)`
#[derive(Clone, Debug)]
pub struct Assert {
    /// Must be true.
    pub condition: ExprId,
    /// A `String` expression.
    pub message: ExprId,
    /// The consequence if it is false.
    pub level: AssertionLevel,
}

/// The consequence of a violated assertion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AssertionLevel {
    /// The run fails.
    Error,
    /// The run goes on with a warning.
    Warning,
    /// The message is a line for this file, for the terminal if it has no name: `Streams.print`.
    Print(Name),
}

/// A function that is called at run time.
#[derive(Clone, Debug)]
pub struct Function {
    /// Full name.
    pub name: String,
    /// Place of its definition.
    pub span: Span,
    /// Scalar inputs.
    pub inputs: Vec<LocalId>,
    /// Scalar outputs.
    pub outputs: Vec<LocalId>,
    /// Names of all scalar locals, inputs and outputs included.
    pub locals: IndexVec<LocalId, String>,
    /// The body; expressions read locals as `Node::Var(VarId(local))`.
    pub body: Vec<Statement>,
}

impl Function {
    /// The assertions and the values of the outputs, in terms of the inputs, of a function whose body is no more
    /// than that under the condition that is its first input.
    pub fn straight_line(&self) -> Option<StraightLine> {
        let [Statement::If(_, body, otherwise)] = self.body.as_slice() else { return None };
        let mut found = StraightLine { asserts: Vec::new(), outputs: Vec::new() };
        for statement in body {
            match statement {
                Statement::Assert(assert, span) => found.asserts.push((assert.clone(), *span)),
                Statement::Assign(local, value)
                    if self.outputs.get(found.outputs.len()) == Some(local) =>
                {
                    found.outputs.push(*value);
                }
                _ => return None,
            }
        }
        let is_complete = otherwise.is_empty() && found.outputs.len() == self.outputs.len();
        is_complete.then_some(found)
    }

    /// Changes the values of the outputs of a [straight line](Function::straight_line), given the number of each.
    pub fn map_outputs(&mut self, mut change: impl FnMut(usize, ExprId) -> ExprId) {
        if self.straight_line().is_none() {
            return;
        }
        let [Statement::If(_, body, _)] = self.body.as_mut_slice() else { return };
        let assigned = body.iter_mut().filter_map(|statement| match statement {
            Statement::Assign(_, value) => Some(value),
            _ => None,
        });
        for (k, value) in assigned.enumerate() {
            *value = change(k, *value);
        }
    }

    /// Whether it executes a loop of its own.
    pub fn has_loop(&self) -> bool {
        has_loop(&self.body)
    }

    /// The expressions of the statements, but for messages.
    pub fn values(&self) -> Vec<ExprId> {
        let mut out = Vec::new();
        values_of(&self.body, &mut out);
        out
    }
}

/// A body without loops and branches, see [`Function::straight_line`].
pub struct StraightLine {
    /// Its assertions.
    pub asserts: Vec<(Assert, Span)>,
    /// The values of the outputs.
    pub outputs: Vec<ExprId>,
}

fn has_loop(body: &[Statement]) -> bool {
    body.iter().any(|statement| match statement {
        Statement::While(..) => true,
        Statement::If(_, a, b) => has_loop(a) || has_loop(b),
        _ => false,
    })
}

fn values_of(body: &[Statement], out: &mut Vec<ExprId>) {
    for statement in body {
        match statement {
            Statement::Assign(_, value) => out.push(*value),
            Statement::If(c, a, b) => {
                out.push(*c);
                values_of(a, out);
                values_of(b, out);
            }
            Statement::While(c, a) => {
                out.push(*c);
                values_of(a, out);
            }
            Statement::Assert(a, _) => out.push(a.condition),
            Statement::Break | Statement::Return => {}
        }
    }
}

crate::define_id! {
    /// A scalar local of a [`Function`].
    pub struct LocalId
}

/// A statement of a [`Function`].
#[derive(Clone, Debug)]
pub enum Statement {
    /// `local := value`
    Assign(LocalId, ExprId),
    /// `if`
    If(ExprId, Vec<Statement>, Vec<Statement>),
    /// `while`
    While(ExprId, Vec<Statement>),
    /// `break`
    Break,
    /// `return`
    Return,
    /// `assert(...)` and its position.
    Assert(Assert, Span),
}
