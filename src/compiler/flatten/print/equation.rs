//! Prints equations, when-clauses and their actions.

use std::collections::BTreeSet;

use super::{ModelPrinter, WITH_DERIVATIVE};
use crate::ir::expr::{ExprId, Node, VarId};
use crate::ir::flat::{Action, Assert, AssertionLevel, Equation, EquationKind, WhenBranch};

impl ModelPrinter<'_> {
    pub(super) fn list(&mut self, list: &[Equation]) {
        for e in list {
            match &e.kind {
                EquationKind::Equal(a, _) if matches!(self.flat.graph.node(*a), Node::Var(v) if self.implicit.contains(&v)) =>
                    {}
                EquationKind::Equal(a, b) => match self.given_derivative(*a) {
                    Some((v, derivative)) => self.with_derivative(v, *b, derivative),
                    None => self.equality(*a, *b),
                },
                EquationKind::When(branches) => self.when(branches),
                EquationKind::Assert(a) => {
                    self.out.push_str("  ");
                    self.assertion(a);
                    self.out.push_str(";\n");
                }
                EquationKind::Algorithm { outputs, values } => {
                    for (v, e) in outputs.iter().zip(values) {
                        self.out.push_str("  ");
                        self.assignment(*v, *e);
                        self.out.push_str(";\n");
                    }
                }
            }
        }
    }

    /// The variable that an expression is and its derivative, if that is given.
    fn given_derivative(&self, e: ExprId) -> Option<(VarId, VarId)> {
        let Node::Var(v) = self.flat.graph.node(e) else { return None };
        // They are sorted by variable.
        let given = &self.flat.given_derivatives;
        let k = given.binary_search_by_key(&v, |g| g.variable).ok()?;
        Some((v, given[k].derivative?))
    }

    fn with_derivative(&mut self, v: VarId, value: ExprId, derivative: VarId) {
        self.out.push_str("  ");
        self.name(v);
        self.push(&[" = ", WITH_DERIVATIVE, "("]);
        self.expression(value);
        self.out.push_str(", ");
        self.name(derivative);
        self.out.push_str(", time);\n");
    }

    /// An `if` on the left-hand side needs parentheses.
    fn equality(&mut self, a: ExprId, b: ExprId) {
        self.out.push_str("  ");
        let chosen = matches!(self.flat.graph.node(a), Node::If(..));
        self.out.push_str(if chosen { "(" } else { "" });
        self.expression(a);
        self.out.push_str(if chosen { ") = " } else { " = " });
        self.expression(b);
        self.out.push_str(";\n");
    }

    fn assignment(&mut self, v: VarId, e: ExprId) {
        self.name(v);
        self.out.push_str(" = ");
        self.expression(e);
    }

    /// A when-equation. In the branches of one, each variable has an equation, while those of a when-statement may leave
    /// variables as they are (Modelica 3.6, section 8.3.5.2).
    fn when(&mut self, branches: &[WhenBranch]) {
        let of_all: BTreeSet<VarId> =
            branches.iter().flat_map(|b| WhenBranch::assigned(&b.actions)).collect();
        for (k, branch) in branches.iter().enumerate() {
            self.out.push_str(if k == 0 { "  when " } else { "  elsewhen " });
            let several = branch.conditions.len() != 1;
            self.out.push_str(if several { "{" } else { "" });
            for (k, c) in branch.conditions.iter().enumerate() {
                self.out.push_str(if k > 0 { ", " } else { "" });
                self.expression(*c);
            }
            self.out.push_str(if several { "} then\n" } else { " then\n" });
            for a in &branch.actions {
                self.out.push_str("    ");
                self.action(a);
                self.out.push_str(";\n");
            }
            for v in of_all.difference(&WhenBranch::assigned(&branch.actions)) {
                self.out.push_str("    ");
                self.name(*v);
                self.out.push_str(" = pre(");
                self.name(*v);
                self.out.push_str(");\n");
            }
        }
        self.out.push_str("  end when;\n");
    }

    fn action(&mut self, action: &Action) {
        match action {
            Action::Assign(v, e) => self.assignment(*v, *e),
            Action::Reinit { state, value, guard } => {
                self.guard(*guard);
                self.out.push_str("reinit(");
                self.name(*state);
                self.out.push_str(", ");
                self.expression(*value);
                self.out.push_str(if guard.is_some() { "); end if" } else { ")" });
            }
            Action::Assert(a) => self.assertion(a),
            Action::Terminate { message, guard } => {
                self.guard(*guard);
                self.out.push_str("terminate(");
                self.expression(*message);
                self.out.push_str(if guard.is_some() { "); end if" } else { ")" });
            }
        }
    }

    /// The condition of an action, if it has one.
    fn guard(&mut self, guard: Option<ExprId>) {
        if let Some(guard) = guard {
            self.out.push_str("if ");
            self.expression(guard);
            self.out.push_str(" then ");
        }
    }

    fn assertion(&mut self, a: &Assert) {
        self.out.push_str("assert(");
        self.expression(a.condition);
        self.out.push_str(", ");
        self.expression(a.message);
        let level =
            if a.level == AssertionLevel::Error { ")" } else { ", AssertionLevel.warning)" };
        self.out.push_str(level);
    }
}
