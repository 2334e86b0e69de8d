//! Expressions, literals and references.

use std::sync::Arc;

use super::Builder;
use crate::ir::ast::*;
use crate::parse::error::SyntaxError;

/// What stands between the parentheses of a call.
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
    /// An expression at its place.
    pub fn expr(&mut self, kind: ExprKind, start: u32, end: u32) -> Box<Expr> {
        Box::new(Expr { kind, span: self.span(start, end) })
    }

    // ---- Literals ----

    /// An integer; one beyond 64 bits is read as a real number.
    pub fn integer(&mut self, start: u32, end: u32) -> Box<Expr> {
        match self.text(start, end).parse() {
            Ok(value) => self.expr(ExprKind::Integer(value), start, end),
            Err(_) => self.real(start, end),
        }
    }
    /// A real number.
    pub fn real(&mut self, start: u32, end: u32) -> Box<Expr> {
        let value: f64 = self.text(start, end).parse().unwrap_or(f64::INFINITY);
        if value.is_finite() {
            return self.expr(ExprKind::Real(value), start, end);
        }
        let span = self.span(start, end);
        self.report(SyntaxError::NumberTooLarge { span });
        self.expr(ExprKind::Broken, start, end)
    }
    /// A string as an expression.
    pub fn string_literal(&mut self, start: u32, end: u32) -> Box<Expr> {
        let text = self.string(start, end);
        self.expr(ExprKind::String(text), start, end)
    }
    /// The text of a string with its escapes resolved.
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
                    self.report(SyntaxError::UnknownEscape { span });
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
                                let (span, named) = (value.span, *first);
                                self.report(SyntaxError::PositionalAfterNamed { span, named });
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
