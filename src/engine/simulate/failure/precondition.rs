//! Assertions about parameters: checked before anything is solved.
//!
//! Modelica specification 3.6, section 8.3.7: an assertion of level error keeps the model from
//! being evaluated outside of its limits of validity. So assertions about parameters come before
//! the initialization that uses them.

use crate::base::index::FastMap;
use crate::ir::dae::VariableKind;
use crate::ir::expr::{ExprId, Node};
use crate::ir::flat::AssertionLevel;
use crate::runtime::machine::Machine;
use crate::symbolic::eval;

/// The first violated assertion of level error whose condition reads only parameters. Parameters
/// must be in the memory.
pub fn violated(machine: &Machine<'_>) -> Option<usize> {
    let mut values = Values { machine, known: FastMap::default() };
    let asserts = &machine.program.blocks.dae.asserts;
    asserts.iter().position(|a| {
        let always = a.active.is_none() && a.assert.level == AssertionLevel::Error;
        always && values.of(a.assert.condition) == Some(0.0)
    })
}

/// Values of expressions; `None` if they read anything other than parameters, or are NaN.
struct Values<'a, 'p> {
    machine: &'a Machine<'p>,
    known: FastMap<ExprId, Option<f64>>,
}

impl Values<'_, '_> {
    fn of(&mut self, e: ExprId) -> Option<f64> {
        if let Some(known) = self.known.get(&e) {
            return *known;
        }
        let value = self.compute(e).filter(|value| !value.is_nan());
        self.known.insert(e, value);
        value
    }

    fn compute(&mut self, e: ExprId) -> Option<f64> {
        let dae = &self.machine.program.blocks.dae;
        match dae.graph.node(e) {
            Node::Const(c) => Some(c.register()),
            Node::Var(v) => {
                (dae.variables[v].kind == VariableKind::Parameter).then(|| self.machine.value(v))
            }
            Node::Unary(op, a) => Some(eval::unary(op, self.of(a)?, dae.graph.externals())),
            Node::Binary(op, a, b) => {
                Some(eval::binary(op, self.of(a)?, self.of(b)?, dae.graph.externals()))
            }
            Node::If(c, a, b) => {
                if self.of(c)? != 0.0 {
                    self.of(a)
                } else {
                    self.of(b)
                }
            }
            Node::NoEvent(a) | Node::Smooth(_, a) => self.of(a),
            Node::Relation(k) => {
                let relation = dae.relations.get(k as usize)?;
                let (lhs, rhs) = (self.of(relation.lhs)?, self.of(relation.rhs)?);
                Some(eval::binary(relation.op, lhs, rhs, dae.graph.externals()))
            }
            _ => None,
        }
    }
}
