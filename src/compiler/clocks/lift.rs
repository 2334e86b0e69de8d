//! Names for what converts between clocks, so that each conversion is an equation of its own (Modelica 3.6, section
//! 16.7.1).
//!
//! Afterwards the first argument of `sample`, `hold`, `previous` and of the conversions is a variable, and
//! conversions are alone on one side of an equation.

use super::error::ClockCause;
use super::expression::{is_fixed, is_unknown, known, variable};
use super::{Item, add_variable, equal};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Const, ExprId, Node, Type};
use crate::ir::flat::{Action, EquationKind, FlatModel, Origin};

/// Takes all equations and bindings out of the model.
pub fn items(flat: &mut FlatModel, problems: &mut Vec<Diagnostic>) -> Vec<Item> {
    let mut lift = Lift { flat, problems, added: Vec::new(), named: FastMap::default() };
    let mut items = Vec::new();
    for equation in std::mem::take(&mut lift.flat.equations) {
        items.push(Item { equation, binding_of: None });
    }
    for v in lift.flat.variables.ids() {
        if is_unknown(lift.flat, v)
            && let Some(value) = lift.flat.variables[v].binding.take()
        {
            let variable = &lift.flat.variables[v];
            let component = variable.name.rsplit_once('.').map_or("", |(path, _)| path);
            let origin = Origin { span: variable.span, component: component.into() };
            let read = lift.flat.read(v);
            items.push(Item { equation: equal(read, value, &origin), binding_of: Some(v) });
        }
    }
    for item in &mut items {
        lift.item(item);
    }
    items.append(&mut lift.added);
    items
}

struct Lift<'a> {
    flat: &'a mut FlatModel,
    problems: &'a mut Vec<Diagnostic>,
    added: Vec<Item>,
    /// The names of sampled expressions.
    named: FastMap<ExprId, ExprId>,
}

impl Lift<'_> {
    fn item(&mut self, item: &mut Item) {
        let origin = item.equation.origin.clone();
        match &mut item.equation.kind {
            EquationKind::Equal(lhs, rhs) => {
                let names = [*rhs, *lhs].map(|e| variable(&self.flat.graph, e).is_some());
                *lhs = self.root(*lhs, names[0], &origin);
                *rhs = self.root(*rhs, names[1], &origin);
            }
            EquationKind::Assert(assert) => {
                assert.condition = self.root(assert.condition, false, &origin);
                assert.message = self.root(assert.message, false, &origin);
            }
            EquationKind::Algorithm { values, .. } => {
                for value in values {
                    *value = self.root(*value, false, &origin);
                }
            }
            EquationKind::When(branches) => {
                for branch in branches {
                    for condition in &mut branch.conditions {
                        *condition = self.root(*condition, false, &origin);
                    }
                    for action in &mut branch.actions {
                        self.action(action, &origin);
                    }
                }
            }
        }
    }

    fn action(&mut self, action: &mut Action, origin: &Origin) {
        match action {
            Action::Assign(_, value) => {
                *value = self.root(*value, false, origin);
            }
            Action::Reinit { value, guard, .. } | Action::Terminate { message: value, guard } => {
                *value = self.root(*value, false, origin);
                if let Some(guard) = guard {
                    *guard = self.root(*guard, false, origin);
                }
            }
            Action::Assert(assert) => {
                assert.condition = self.root(assert.condition, false, origin);
                assert.message = self.root(assert.message, false, origin);
            }
        }
    }

    /// `keep` says whether a conversion may stay at the root.
    fn root(&mut self, root: ExprId, keep: bool, origin: &Origin) -> ExprId {
        let clocked = self.flat.graph.any([root], |_, node| matches!(node, Node::Clocked(..)));
        if !clocked && self.flat.graph.ty(root) != Type::Clock {
            return root;
        }
        let mut done: FastMap<ExprId, ExprId> = FastMap::default();
        let mut operands = Vec::new();
        for e in self.flat.graph.postorder([root]) {
            operands.clear();
            self.flat.graph.for_each_operand(e, |a| operands.push(done[&a]));
            let new = match self.flat.graph.node(e) {
                Node::Clocked(op, _) => self.operator(e, op, &operands, keep && e == root, origin),
                Node::If(c, ..) if self.flat.graph.ty(e) == Type::Clock => {
                    match known(self.flat, c) {
                        Some(Const::Boolean(true)) => operands[1],
                        Some(Const::Boolean(false)) => operands[2],
                        _ => {
                            self.problems
                                .push(Diagnostic::new(ClockCause::SwitchedClock, origin.span));
                            operands[1]
                        }
                    }
                }
                _ => self.flat.graph.rebuild(e, &operands),
            };
            done.insert(e, new);
        }
        done[&root]
    }

    fn operator(
        &mut self,
        e: ExprId,
        op: ClockOperator,
        operands: &[ExprId],
        keep: bool,
        origin: &Origin,
    ) -> ExprId {
        let ty = self.flat.graph.ty(e);
        let mut args = operands.to_vec();
        let converts = op.converts() || op == ClockOperator::Solver;
        match op {
            ClockOperator::Sample if is_fixed(self.flat, args[0]) => {
                return self.flat.graph.clocked(ClockOperator::At, &args, ty);
            }
            ClockOperator::Sample => args[0] = self.sampled(args[0], origin),
            _ if converts && is_fixed(self.flat, args[0]) => return args[0],
            _ if converts => args[0] = self.name(args[0], origin),
            _ => {}
        }
        let new = self.flat.graph.clocked(op, &args, ty);
        if keep || !(converts || op == ClockOperator::Sample) {
            return new;
        }
        self.name(new, origin)
    }

    fn sampled(&mut self, e: ExprId, origin: &Origin) -> ExprId {
        if let Some(known) = self.named.get(&e) {
            return *known;
        }
        let name = self.name(e, origin);
        self.named.insert(e, name);
        name
    }

    /// A variable with this value.
    fn name(&mut self, e: ExprId, origin: &Origin) -> ExprId {
        if variable(&self.flat.graph, e).is_some() {
            return e;
        }
        let ty = self.flat.graph.ty(e);
        let name = format!("$clocked{}", self.flat.variables.len());
        let v = add_variable(self.flat, name, ty, origin);
        let read = self.flat.read(v);
        self.added.push(Item { equation: equal(read, e, origin), binding_of: None });
        read
    }
}
