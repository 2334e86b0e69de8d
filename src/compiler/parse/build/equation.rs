//! Equations and statements.

use super::Builder;
use super::class::Description;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::ast::*;
use crate::parse::error::{SyntaxCause, equals_as_assignment};
use crate::parse::token::TokenKind;

/// Conditions with the equations or statements that they guard.
type Branches<T> = Vec<(Expr, Vec<T>)>;

impl Builder<'_> {
    // ---- Equations ----

    /// Adds the description and the span of an equation.
    pub fn describe(
        &mut self,
        mut equation: Box<Equation>,
        description: Description,
        start: u32,
        end: u32,
    ) -> Box<Equation> {
        equation.description = description.0;
        equation.span = self.span(start, end);
        equation
    }
    fn equation(&mut self, kind: EquationKind) -> Box<Equation> {
        Box::new(Equation { kind, span: Span::NONE, description: None })
    }
    /// An expression without `=`: a call or an error.
    pub fn lone_equation(&mut self, expr: Box<Expr>) -> Box<Equation> {
        if matches!(expr.kind, ExprKind::Call { .. }) {
            return self.equation(EquationKind::Call(*expr));
        }
        if let ExprKind::Binary(BinaryOp::Equal, x, y) = &expr.kind {
            let operator = self.between(x, y);
            let problem = Diagnostic::new(SyntaxCause::ComparisonAsEquation, operator);
            self.report(problem.label("should be `=`"));
        } else {
            self.incomplete(&expr, "an equation");
        }
        self.equation(EquationKind::Broken)
    }
    /// `a = b`
    pub fn equal(&mut self, left: Box<Expr>, right: Box<Expr>) -> Box<Equation> {
        self.equation(EquationKind::Equal(*left, *right))
    }
    /// `a := b` in an equation section: reported and treated as `a = b`.
    pub fn assigned_equation(
        &mut self,
        left: Box<Expr>,
        right: Box<Expr>,
        start: u32,
        end: u32,
    ) -> Box<Equation> {
        let operator = self.span(start, end);
        let problem = Diagnostic::new(SyntaxCause::AssignmentAsEquation, operator);
        self.report(problem.label("should be `=`"));
        self.equal(left, right)
    }
    /// `if`
    pub fn if_equation(
        &mut self,
        condition: Box<Expr>,
        body: Vec<Equation>,
        more: Branches<Equation>,
        otherwise: Vec<Equation>,
    ) -> Box<Equation> {
        self.leave();
        let branches = branches(condition, body, more);
        self.equation(EquationKind::If { branches, otherwise })
    }
    /// `for`
    pub fn for_equation(&mut self, iterators: Vec<Iterator>, body: Vec<Equation>) -> Box<Equation> {
        self.leave();
        self.equation(EquationKind::For { iterators, body })
    }
    /// `when`
    pub fn when_equation(
        &mut self,
        condition: Box<Expr>,
        body: Vec<Equation>,
        more: Branches<Equation>,
    ) -> Box<Equation> {
        self.leave();
        self.equation(EquationKind::When { branches: branches(condition, body, more) })
    }
    /// `connect`
    pub fn connect(&mut self, left: ComponentRef, right: ComponentRef) -> Box<Equation> {
        self.equation(EquationKind::Connect(left, right))
    }

    // ---- Statements ----

    /// Adds the span of a statement.
    pub fn locate(
        &mut self,
        mut statement: Box<Statement>,
        start: u32,
        end: u32,
    ) -> Box<Statement> {
        statement.span = self.span(start, end);
        statement
    }
    /// A statement without a span.
    pub fn statement(&mut self, kind: StatementKind) -> Box<Statement> {
        Box::new(Statement { kind, span: Span::NONE })
    }
    /// An expression without `:=`: a call or an error.
    pub fn lone_statement(&mut self, expr: Box<Expr>) -> Box<Statement> {
        if matches!(expr.kind, ExprKind::Call { .. }) {
            return self.statement(StatementKind::Call(*expr));
        }
        if let ExprKind::Binary(BinaryOp::Equal, x, y) = &expr.kind {
            let operator = self.between(x, y);
            self.report(equals_as_assignment("==", operator));
        } else {
            self.incomplete(&expr, "a statement");
        }
        self.statement(StatementKind::Broken)
    }
    /// `a := b`, `(a, b) := f(x)`
    pub fn assign(&mut self, left: Box<Expr>, right: Box<Expr>) -> Box<Statement> {
        let span = left.span;
        let kind = match left.kind {
            ExprKind::Ref(target) => Some(StatementKind::Assign(target, *right)),
            ExprKind::Parenthesised(target) => {
                target_of(*target).map(|t| StatementKind::AssignTuple(vec![Some(t)], *right))
            }
            ExprKind::Tuple(slots) => slots
                .into_iter()
                .map(|slot| slot.map_or(Some(None), |e| target_of(e).map(Some)))
                .collect::<Option<Vec<_>>>()
                .map(|targets| StatementKind::AssignTuple(targets, *right)),
            ExprKind::Broken => Some(StatementKind::Broken),
            _ => None,
        };
        let kind = kind.unwrap_or_else(|| {
            let problem = Diagnostic::new(SyntaxCause::NotAssignable, span);
            self.report(problem.label("this is not a variable"));
            StatementKind::Broken
        });
        self.statement(kind)
    }
    /// `a = b` in an algorithm section: reported and treated as `a := b`.
    pub fn equal_statement(
        &mut self,
        left: Box<Expr>,
        right: Box<Expr>,
        start: u32,
        end: u32,
    ) -> Box<Statement> {
        let operator = self.span(start, end);
        self.report(equals_as_assignment("=", operator));
        self.assign(left, right)
    }
    /// `if`
    pub fn if_statement(
        &mut self,
        condition: Box<Expr>,
        body: Vec<Statement>,
        more: Branches<Statement>,
        otherwise: Vec<Statement>,
    ) -> Box<Statement> {
        self.leave();
        let branches = branches(condition, body, more);
        self.statement(StatementKind::If { branches, otherwise })
    }
    /// `for`
    pub fn for_statement(
        &mut self,
        iterators: Vec<Iterator>,
        body: Vec<Statement>,
    ) -> Box<Statement> {
        self.leave();
        self.statement(StatementKind::For { iterators, body })
    }
    /// `while`
    pub fn while_statement(
        &mut self,
        condition: Box<Expr>,
        body: Vec<Statement>,
    ) -> Box<Statement> {
        self.leave();
        self.statement(StatementKind::While { condition: *condition, body })
    }
    /// `when`
    pub fn when_statement(
        &mut self,
        condition: Box<Expr>,
        body: Vec<Statement>,
        more: Branches<Statement>,
    ) -> Box<Statement> {
        self.leave();
        self.statement(StatementKind::When { branches: branches(condition, body, more) })
    }

    /// The operator between two operands.
    fn between(&self, left: &Expr, right: &Expr) -> Span {
        let from = self.tokens.partition_point(|t| t.start < left.span.end);
        self.tokens
            .get(from)
            .filter(|t| t.end <= right.span.start)
            .map_or(left.span, |t| self.span(t.start, t.end))
    }
    /// Reports an expression that should be part of an equation or statement, unless the parser is
    /// about to report the tokens that follow it.
    fn incomplete(&mut self, expr: &Expr, wanted: &'static str) {
        let next = self.tokens.partition_point(|t| t.start < expr.span.end);
        let ends = self.tokens.get(next).is_none_or(|t| {
            matches!(t.kind, TokenKind::Semicolon | TokenKind::String | TokenKind::Annotation)
                || t.kind.starts_section()
        });
        let follows_error = expr.span.start < self.quiet_until;
        if ends && !follows_error && !matches!(expr.kind, ExprKind::Broken) {
            let problem = Diagnostic::new(SyntaxCause::LoneExpression { wanted }, expr.span);
            self.report(problem.label(format!("this alone is not {wanted}")));
        }
    }
}

fn branches<T>(condition: Box<Expr>, body: Vec<T>, more: Branches<T>) -> Branches<T> {
    std::iter::once((*condition, body)).chain(more).collect()
}

fn target_of(expr: Expr) -> Option<ComponentRef> {
    match expr.kind {
        ExprKind::Ref(target) => Some(target),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::diag::Problems;
    use crate::base::source::FileId;
    use crate::parse::grammar::parse;

    fn body(text: &str) -> Composition {
        let mut problems = Problems::new();
        let file = parse(FileId(0), &format!("model A {text} end A;"), &mut problems);
        assert!(problems.is_empty(), "{text}: {problems:?}");
        match &file.classes[0].body {
            ClassBody::Long(body) => body.clone(),
            other => panic!("not a long class: {other:?}"),
        }
    }

    #[test]
    fn all_forms_of_equations() {
        let c = body(
            "initial equation x = 0 \"start\"; equation connect(a.b[1], c); (u, , v) = f(x); \
             if a then elseif b then x = 1; else y = 2; z = 3; end if; \
             for i in 1:3, j loop x[i, j] = 0; end for; \
             when {a, b} then reinit(x, 0); elsewhen c then terminate(\"t\"); end when; assert(a, \"b\");",
        );
        assert!(c.equations[0].initial && !c.equations[1].initial);
        assert_eq!(c.equations[0].equations[0].description.as_deref(), Some("start"));
        let e = &c.equations[1].equations;
        assert!(matches!(e[0].kind, EquationKind::Connect(..)));
        let EquationKind::Equal(left, _) = &e[1].kind else { panic!("equal") };
        assert!(matches!(&left.kind, ExprKind::Tuple(slots) if slots.len() == 3));
        let EquationKind::If { branches, otherwise } = &e[2].kind else { panic!("if") };
        assert_eq!((branches.len(), branches[0].1.len(), otherwise.len()), (2, 0, 2));
        let EquationKind::For { iterators, .. } = &e[3].kind else { panic!("for") };
        assert!(iterators[0].range.is_some() && iterators[1].range.is_none());
        assert!(matches!(&e[4].kind, EquationKind::When { branches } if branches.len() == 2));
        assert!(matches!(e[5].kind, EquationKind::Call(_)));
    }
    #[test]
    fn all_forms_of_statements() {
        let c = body(
            "initial algorithm x := 1; algorithm (a, , b[2]) := f(x); g(x) \"d\"; \
             if a then break; else return; end if; while x > 1 loop x := x - 1; end while; \
             for i loop x := i; end for; when a then x := 1; elsewhen b then x := 2; end when; \
             (a) := f(x);",
        );
        assert!(c.algorithms[0].initial);
        let s = &c.algorithms[1].statements;
        let StatementKind::AssignTuple(targets, _) = &s[0].kind else { panic!("tuple") };
        let given: Vec<bool> = targets.iter().map(Option::is_some).collect();
        assert_eq!(given, [true, false, true]);
        assert!(matches!(s[1].kind, StatementKind::Call(_)));
        assert!(matches!(&s[2].kind, StatementKind::If { otherwise, .. } if otherwise.len() == 1));
        assert!(matches!(s[3].kind, StatementKind::While { .. }));
        assert!(matches!(s[4].kind, StatementKind::For { .. }));
        assert!(matches!(&s[5].kind, StatementKind::When { branches } if branches.len() == 2));
        assert!(matches!(&s[6].kind, StatementKind::AssignTuple(targets, _) if targets.len() == 1));
    }
    #[test]
    fn external_functions() {
        let c = body("external \"C\" y[1] = f(x, size(x, 1)) annotation(Library = \"m\");");
        let external = c.external.unwrap();
        assert_eq!(external.language.as_deref(), Some("C"));
        assert_eq!((external.args.len(), external.annotation.is_some()), (2, true));
        assert!(body("external;").external.unwrap().function.is_none());
    }
}
