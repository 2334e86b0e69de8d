//! Expressions, literals and references.

use std::sync::Arc;

use super::Builder;
use crate::base::diag::Diagnostic;
use crate::ir::ast::*;
use crate::parse::error::SyntaxCause;

/// The arguments between the parentheses of a call.
#[derive(Debug)]
pub enum Args {
    /// Arguments.
    List(Vec<Arg>),
    /// `e for i in r`
    Reduction(Box<Expr>, Vec<Iterator>),
}

/// One argument of a call.
#[derive(Debug)]
pub enum Arg {
    /// `e`
    Positional(Box<Expr>),
    /// `a = e`
    Named(Ident, Box<Expr>),
}

impl Builder<'_> {
    /// An expression with its span.
    pub fn expr(&mut self, kind: ExprKind, start: u32, end: u32) -> Box<Expr> {
        Box::new(Expr { kind, span: self.span(start, end) })
    }

    // ---- Literals ----

    /// An Integer literal; beyond 64 bits it becomes a Real literal.
    pub fn integer(&mut self, start: u32, end: u32) -> Box<Expr> {
        match self.text(start, end).parse() {
            Ok(value) => self.expr(ExprKind::Integer(value), start, end),
            Err(_) => self.real(start, end),
        }
    }
    /// A Real literal.
    pub fn real(&mut self, start: u32, end: u32) -> Box<Expr> {
        let value: f64 = self.text(start, end).parse().unwrap_or(f64::INFINITY);
        if value.is_finite() {
            return self.expr(ExprKind::Real(value), start, end);
        }
        let span = self.span(start, end);
        let problem = Diagnostic::new(SyntaxCause::NumberTooLarge, span);
        self.report(problem.note("the largest real number is about 1.8e308"));
        self.expr(ExprKind::Broken, start, end)
    }
    /// A string as an expression.
    pub fn string_literal(&mut self, start: u32, end: u32) -> Box<Expr> {
        let text = self.string(start, end);
        self.expr(ExprKind::String(text), start, end)
    }
    /// The value of a string literal with its escapes resolved.
    pub fn string(&mut self, start: u32, end: u32) -> Arc<str> {
        let quoted = self.text(start, end);
        let inner = quoted.strip_prefix('"').unwrap_or(quoted);
        let inner = inner.strip_suffix('"').unwrap_or(inner);
        if !inner.contains('\\') {
            return inner.into();
        }
        let mut text = String::with_capacity(inner.len());
        let mut chars = inner.char_indices();
        while let Some((_, c)) = chars.next() {
            if c != '\\' {
                text.push(c);
                continue;
            }
            let Some((at, escaped)) = chars.next() else { break };
            match resolve_escape(escaped) {
                Some(c) => text.push(c),
                None => {
                    let at = start + at as u32;
                    let span = self.span(at, at + 1 + escaped.len_utf8() as u32);
                    self.report(Diagnostic::new(SyntaxCause::UnknownEscape { escaped }, span));
                    text.push(escaped);
                }
            }
        }
        text.into()
    }
    /// `"a" + "b"` in a description.
    pub fn concatenate(&mut self, first: Arc<str>, start: u32, end: u32) -> Arc<str> {
        let second = self.string(start, end);
        format!("{first}{second}").into()
    }

    // ---- References and calls ----

    /// `a.b[2]`
    pub fn component_ref(&mut self, parts: Vec<RefPart>, end: u32) -> ComponentRef {
        let start = parts.first().map_or(end, |p| p.name.span.start);
        ComponentRef { global: false, parts, span: self.span(start, end) }
    }
    /// `.a.b[2]`
    pub fn global_component_ref(
        &mut self,
        parts: Vec<RefPart>,
        start: u32,
        end: u32,
    ) -> ComponentRef {
        ComponentRef { global: true, parts, span: self.span(start, end) }
    }
    /// A reference as an expression.
    pub fn reference(&mut self, reference: ComponentRef) -> Box<Expr> {
        let span = reference.span;
        Box::new(Expr { kind: ExprKind::Ref(reference), span })
    }
    /// `der`, `initial`, `pure`: keywords that are called like functions.
    pub fn keyword_function(&mut self, start: u32, end: u32) -> ComponentRef {
        let name = self.ident(start, end);
        self.component_ref(vec![RefPart { name, subscripts: Vec::new() }], end)
    }
    /// `f(...)`
    pub fn call(&mut self, function: ComponentRef, args: Args, end: u32) -> Box<Expr> {
        let start = function.span.start;
        let kind = match args {
            Args::Reduction(body, iterators) => ExprKind::Reduction { function, body, iterators },
            Args::List(list) => {
                let (mut args, mut named) = (Vec::new(), Vec::new());
                for arg in list {
                    match arg {
                        Arg::Named(name, value) => named.push((name, *value)),
                        Arg::Positional(value) => {
                            if let Some((first, _)) = named.first() {
                                let cause = SyntaxCause::PositionalAfterNamed;
                                let problem = Diagnostic::new(cause, value.span);
                                self.report(problem.also(first.span, "the named argument"));
                            }
                            args.push(*value);
                        }
                    }
                }
                ExprKind::Call { function, args, named }
            }
        };
        self.expr(kind, start, end)
    }
    /// `function f(a = 1)`
    pub fn partial_function(
        &mut self,
        function: Path,
        named: Vec<(Ident, Expr)>,
        start: u32,
        end: u32,
    ) -> Box<Expr> {
        self.expr(ExprKind::PartialFunction { function, named }, start, end)
    }

    // ---- Operators ----

    /// `a + b`
    pub fn binary(&mut self, op: BinaryOp, left: Box<Expr>, right: Box<Expr>) -> Box<Expr> {
        let span = left.span.to(right.span);
        Box::new(Expr { kind: ExprKind::Binary(op, left, right), span })
    }
    /// `-a`
    pub fn unary(&mut self, op: UnaryOp, operand: Box<Expr>, start: u32) -> Box<Expr> {
        let end = operand.span.end;
        self.expr(ExprKind::Unary(op, operand), start, end)
    }
    /// `a : step : b`
    pub fn range(
        &mut self,
        start: Box<Expr>,
        step: Option<Box<Expr>>,
        stop: Box<Expr>,
    ) -> Box<Expr> {
        let span = start.span.to(stop.span);
        Box::new(Expr { kind: ExprKind::Range { start, step, stop }, span })
    }
    /// `if c then x elseif ... else y`
    pub fn if_expr(
        &mut self,
        condition: Box<Expr>,
        value: Box<Expr>,
        more: Vec<(Expr, Expr)>,
        otherwise: Box<Expr>,
        start: u32,
        end: u32,
    ) -> Box<Expr> {
        let branches = std::iter::once((*condition, *value)).chain(more).collect();
        self.expr(ExprKind::If { branches, otherwise }, start, end)
    }

    // ---- Brackets ----

    /// `(a)`, `()` and `(a, , b)`
    pub fn parenthesised(
        &mut self,
        slots: Vec<Option<Box<Expr>>>,
        start: u32,
        end: u32,
    ) -> Box<Expr> {
        let mut slots: Vec<Option<Expr>> = slots.into_iter().map(|s| s.map(|e| *e)).collect();
        let kind = match slots.as_mut_slice() {
            [only] => match only.take() {
                Some(inner) => ExprKind::Parenthesised(Box::new(inner)),
                None => ExprKind::Tuple(Vec::new()),
            },
            _ => ExprKind::Tuple(slots),
        };
        self.expr(kind, start, end)
    }
    /// `(a)[1]`; `middle` is the end of the parenthesis.
    pub fn indexed(
        &mut self,
        slots: Vec<Option<Box<Expr>>>,
        subscripts: Vec<Subscript>,
        start: u32,
        middle: u32,
        end: u32,
    ) -> Box<Expr> {
        let base = self.parenthesised(slots, start, middle);
        self.expr(ExprKind::Indexed(base, subscripts), start, end)
    }
    /// `[a, b; c, d]`
    pub fn matrix(&mut self, rows: Vec<Vec<Expr>>, start: u32, end: u32) -> Box<Expr> {
        self.expr(ExprKind::Matrix(rows), start, end)
    }
    /// `{a, b}`
    pub fn array(&mut self, entries: Vec<Box<Expr>>, start: u32, end: u32) -> Box<Expr> {
        let entries = self.unbox(entries);
        self.expr(ExprKind::Array(entries), start, end)
    }
    /// `{e for i in r}`
    pub fn comprehension(
        &mut self,
        body: Box<Expr>,
        iterators: Vec<Iterator>,
        start: u32,
        end: u32,
    ) -> Box<Expr> {
        self.expr(ExprKind::Comprehension { body, iterators }, start, end)
    }
}

/// The escapes of Modelica 3.6, section 2.3.2 (S-ESCAPE).
fn resolve_escape(escaped: char) -> Option<char> {
    Some(match escaped {
        '\'' | '"' | '?' | '\\' => escaped,
        'a' => '\u{7}',
        'b' => '\u{8}',
        'f' => '\u{c}',
        'n' => '\n',
        'r' => '\r',
        't' => '\t',
        'v' => '\u{b}',
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::diag::Problems;
    use crate::base::source::FileId;
    use crate::parse::grammar::parse;

    /// The binding of the only component of a model.
    fn binding(text: &str) -> Expr {
        let text = format!("model A Real x = {text}; end A;");
        let mut problems = Problems::new();
        let file = parse(FileId(0), &text, &mut problems);
        assert!(problems.is_empty(), "{text}: {problems:?}");
        let ClassBody::Long(body) = &file.classes[0].body else { panic!("a long class") };
        let ElementKind::Components(clause) = &body.elements[0].kind else { panic!("components") };
        let modification = clause.components[0].modification.as_ref().expect("a modification");
        modification.binding.as_deref().expect("a binding").clone()
    }
    /// The tree in prefix form: every operator with its operands in parentheses.
    fn shape(e: &Expr) -> String {
        let list = |v: &[Expr]| v.iter().map(shape).collect::<Vec<_>>().join(", ");
        match &e.kind {
            ExprKind::Real(v) => format!("{v:?}"),
            ExprKind::Integer(v) => v.to_string(),
            ExprKind::String(s) => format!("{s:?}"),
            ExprKind::Boolean(b) => b.to_string(),
            ExprKind::Ref(r) => reference(r),
            ExprKind::Unary(op, x) => format!("{op:?}({})", shape(x)),
            ExprKind::Binary(op, x, y) => format!("{op:?}({}, {})", shape(x), shape(y)),
            ExprKind::Range { start, step, stop } => {
                let step = step.as_ref().map_or("_".into(), |s| shape(s));
                format!("Range({}, {step}, {})", shape(start), shape(stop))
            }
            ExprKind::If { branches, otherwise } => {
                let branches: Vec<_> =
                    branches.iter().map(|(c, v)| format!("{}: {}", shape(c), shape(v))).collect();
                format!("If({}; {})", branches.join("; "), shape(otherwise))
            }
            ExprKind::Call { function, args, named } => {
                let named: Vec<_> =
                    named.iter().map(|(n, v)| format!("{}={}", n.name, shape(v))).collect();
                format!("{}[{}][{}]", reference(function), list(args), named.join(", "))
            }
            ExprKind::Array(v) => format!("{{{}}}", list(v)),
            ExprKind::Matrix(rows) => {
                format!("[{}]", rows.iter().map(|r| list(r)).collect::<Vec<_>>().join("; "))
            }
            ExprKind::Parenthesised(x) => format!("({})", shape(x)),
            ExprKind::Tuple(v) => {
                let v: Vec<_> = v.iter().map(|x| x.as_ref().map_or("_".into(), shape)).collect();
                format!("Tuple({})", v.join(", "))
            }
            ExprKind::Indexed(x, s) => format!("{}[{}]", shape(x), s.len()),
            ExprKind::Reduction { function, body, iterators } => {
                format!("{}<{}>({})", reference(function), iterators.len(), shape(body))
            }
            ExprKind::Comprehension { body, iterators } => {
                format!("array<{}>({})", iterators.len(), shape(body))
            }
            ExprKind::PartialFunction { function, named } => format!("{function}<{}>", named.len()),
            ExprKind::End => "end".into(),
            ExprKind::Break => "break".into(),
            ExprKind::Broken => "broken".into(),
        }
    }
    fn reference(r: &ComponentRef) -> String {
        let part = |p: &RefPart| {
            let subscripts: Vec<_> = p
                .subscripts
                .iter()
                .map(|s| match s {
                    Subscript::Colon(_) => ":".into(),
                    Subscript::Expr(e) => shape(e),
                })
                .collect();
            match subscripts.is_empty() {
                true => p.name.name.to_string(),
                false => format!("{}[{}]", p.name.name, subscripts.join(", ")),
            }
        };
        let dot = if r.global { "." } else { "" };
        format!("{dot}{}", r.parts.iter().map(part).collect::<Vec<_>>().join("."))
    }

    #[test]
    fn precedence_of_operators() {
        for (text, tree) in [
            ("-a^2", "Minus(Pow(a, 2))"),
            ("-a*b", "Minus(Mul(a, b))"),
            ("-a + b", "Add(Minus(a), b)"),
            ("a - b - c", "Sub(Sub(a, b), c)"),
            ("a / b * c", "Mul(Div(a, b), c)"),
            ("a + b*c^d", "Add(a, Mul(b, Pow(c, d)))"),
            ("a .* b .+ c .^ d", "ElementAdd(ElementMul(a, b), ElementPow(c, d))"),
            ("not a < b and c or d", "Or(And(Not(Less(a, b)), c), d)"),
            ("a or b and c", "Or(a, And(b, c))"),
            ("1:2*n", "Range(1, _, Mul(2, n))"),
            ("1:2:n + 1", "Range(1, 2, Add(n, 1))"),
            ("(a + b)*c", "Mul((Add(a, b)), c)"),
            ("if a then b elseif c then d else e + 1", "If(a: b; c: d; Add(e, 1))"),
        ] {
            assert_eq!(shape(&binding(text)), tree, "{text}");
        }
    }
    #[test]
    fn primaries() {
        for (text, tree) in [
            ("1.", "1.0"),
            (".5", "0.5"),
            ("1e5", "100000.0"),
            ("9223372036854775807", "9223372036854775807"),
            ("9223372036854775808", "9.223372036854776e18"),
            (r#""a\"\n\\""#, r#""a\"\n\\""#),
            (".a.b[1, :].'c d'", ".a.b[1, :].'c d'"),
            ("x[end - 1, 2:end]", "x[Sub(end, 1), Range(2, _, end)]"),
            ("f(a, b, c = d, e = 1)", "f[a, b][c=d, e=1]"),
            ("der(x)", "der[x][]"),
            ("initial()", "initial[][]"),
            ("pure(f(x))", "pure[f[x][]][]"),
            ("sum(i*j for i in 1:3, j)", "sum<2>(Mul(i, j))"),
            ("{i for i in 1:3}", "array<1>(i)"),
            ("{a, {b}, {}}", "{a, {b}, {}}"),
            ("[a, b; c, d]", "[a, b; c, d]"),
            ("f(function g(x = 1), y = function h())", "f[g<1>][y=h<0>]"),
            ("(a)[1]", "(a)[1]"),
            ("(a, , b)", "Tuple(a, _, b)"),
            ("()", "Tuple()"),
        ] {
            assert_eq!(shape(&binding(text)), tree, "{text}");
        }
    }
    #[test]
    fn nesting_is_bounded_and_long_sums_are_accepted() {
        let codes = |expr: String| {
            let text = format!("model A Real x = {expr}; end A;");
            let mut problems = Problems::new();
            parse(FileId(0), &text, &mut problems);
            problems.iter().map(|p| p.code).collect::<Vec<_>>()
        };
        let n = 100_000;
        assert_eq!(codes("a + ".repeat(5000) + "a"), [""; 0]);
        assert_eq!(codes("if a then b else ".repeat(1000) + "c"), [""; 0]);
        for expr in [
            "(".repeat(n) + "a" + &")".repeat(n),
            "if a then b else ".repeat(n) + "c",
            "a + ".repeat(n) + "a",
            "-".repeat(n) + "a",
        ] {
            assert_eq!(codes(expr), ["MO0014"]);
        }
    }
}
