//! Expressions as Modelica text, with no more parentheses than needed.

use crate::ir::builtin::Syntax;
use crate::ir::expr::{Binary, Const, ExprId, Form, Graph, Node, Type, Unary, VarId};

/// Bytes of an expression that are printed for people. Shared expressions double when they are written
/// out, so that the text of a small graph may be longer than any memory.
const LONGEST: usize = 4000;

/// Prints `e` for people, cut off where nobody reads on; `names` gives each variable its name.
pub fn print(graph: &Graph, e: ExprId, names: &dyn Fn(VarId) -> String) -> String {
    let variable = |v: VarId, out: &mut String| out.push_str(&names(v));
    let enumeration = |name: &str| name.to_string();
    let longest = LONGEST;
    let (relation, special) = (&|_| None, &|_, _: &mut String| false);
    let mut text = Printer {
        graph,
        variable: &variable,
        enumeration: &enumeration,
        relation,
        special,
        longest,
    }
    .print(e);
    if text.len() > LONGEST {
        let end = (0..=LONGEST).rev().find(|k| text.is_char_boundary(*k)).unwrap_or(0);
        text.truncate(end);
        text.push_str(" ...");
    }
    text
}

/// How names are written.
#[derive(Clone, Copy)]
pub struct Printer<'a> {
    /// The expressions.
    pub graph: &'a Graph,
    /// Writes the name of a variable.
    pub variable: &'a dyn Fn(VarId, &mut String),
    /// The name of an enumeration type, from its full name.
    pub enumeration: &'a dyn Fn(&str) -> String,
    /// The operator and operands of a numbered relation, if it is to be expanded.
    pub relation: &'a dyn Fn(u32) -> Option<(Binary, ExprId, ExprId)>,
    /// Prints signals, transport reads, tables and equalities in another way; false if it does not.
    pub special: &'a dyn Fn(Node, &mut String) -> bool,
    /// Output beyond this number of bytes may be left out: shared expressions can be long when printed.
    pub longest: usize,
}

impl Printer<'_> {
    /// Prints `e`.
    pub fn print(&self, e: ExprId) -> String {
        let mut out = String::new();
        self.print_to(e, &mut out);
        out
    }

    /// Appends `e` to `out`.
    pub fn print_to(&self, e: ExprId, out: &mut String) {
        self.write(e, 0, out);
    }
}

/// A real number as a Modelica literal that reads back as the same `f64`.
pub fn real_literal(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), |whole| {
        if whole.len() <= 15 { format!("{whole}.0") } else { text.clone() }
    })
}

/// The first elements of a table.
fn push_elements(all: &[f64], whole: bool, out: &mut String) {
    let literal = |x: &f64| if whole { format!("{x}") } else { real_literal(*x) };
    let mut list: Vec<String> = all.iter().take(SHOWN).map(literal).collect();
    if all.len() > SHOWN {
        list.push("...".into());
    }
    out.push_str(&format!("{{{}}}", list.join(", ")));
}

/// Elements of a table that are shown.
const SHOWN: usize = 3;

// Binding strengths, loosest first (section 3.2 of the specification).
const IF: u8 = 1;
const OR: u8 = 2;
const AND: u8 = 3;
const NOT: u8 = 4;
const RELATION: u8 = 5;
const SUM: u8 = 6;
const PRODUCT: u8 = 7;
const POWER: u8 = 8;
const PRIMARY: u8 = 9;

impl Printer<'_> {
    fn write(&self, e: ExprId, outer: u8, out: &mut String) {
        if out.len() > self.longest {
            return;
        }
        let g = self.graph;
        let names = self.variable;
        let strength = self.strength(e);
        let parenthesised = strength < outer;
        if parenthesised {
            out.push('(');
        }
        match g.node(e) {
            Node::Const(c) => self.literal(c, out),
            Node::Time => out.push_str("time"),
            node @ (Node::Recorded(..)
            | Node::Unary(Unary::Carried(_) | Unary::External(_), _)
            | Node::Binary(Binary::Equal | Binary::NotEqual, ..))
                if (self.special)(node, out) => {}
            Node::Recorded(v, order) => {
                let mut of = String::new();
                names(v, &mut of);
                let name = match (of.trim_start_matches('\'').starts_with("$delay"), order) {
                    (true, _) => "delayed",
                    (false, 0) => "recorded",
                    _ => "recorded_rate",
                };
                call(out, name, |out| out.push_str(&of));
            }
            Node::Var(v) => names(v, out),
            Node::Der(v) => call(out, "der", |out| names(v, out)),
            Node::Pre(v) => call(out, "pre", |out| names(v, out)),
            Node::Unary(Unary::Neg, a) => {
                out.push('-');
                self.write(a, PRODUCT, out);
            }
            Node::Unary(Unary::Not, a) => {
                out.push_str("not ");
                self.write(a, RELATION, out);
            }
            Node::Unary(Unary::External(f), a)
                if let Some((all, whole)) = g.externals().get(f).elements() =>
            {
                push_elements(all, whole, out);
                out.push('[');
                self.write(a, 0, out);
                out.push(']');
            }
            Node::Unary(op, a) => call(out, self.unary_name(op), |out| {
                self.write(a, 0, out);
                if let Unary::Text(form) = op {
                    push_form(g.forms[form], g.ty(a), out);
                }
            }),
            Node::Binary(op, a, b) => match operator_strengths(op) {
                Some((_, left, right)) => {
                    self.write(a, left, out);
                    let spaced = !matches!(op, Binary::Pow);
                    if spaced {
                        out.push(' ');
                    }
                    out.push_str(op.name());
                    if spaced {
                        out.push(' ');
                    }
                    self.write(b, right, out);
                }
                None => call(out, self.binary_name(op), |out| {
                    self.write(a, 0, out);
                    out.push_str(", ");
                    self.write(b, 0, out);
                }),
            },
            Node::If(..) => self.if_chain(e, out),
            Node::NoEvent(a) => call(out, "noEvent", |out| self.write(a, 0, out)),
            Node::Smooth(k, a) => call(out, "smooth", |out| {
                out.push_str(&format!("{k}, "));
                self.write(a, 0, out);
            }),
            Node::Homotopy(a, b) => call(out, "homotopy", |out| {
                self.write(a, 0, out);
                out.push_str(", ");
                self.write(b, 0, out);
            }),
            Node::Sample(a, b) => call(out, "sample", |out| {
                self.write(a, 0, out);
                out.push_str(", ");
                self.write(b, 0, out);
            }),
            Node::Clocked(op, args) => call(out, op.name(), |out| {
                for (i, a) in g.list(args).iter().enumerate() {
                    if i > 0 {
                        out.push_str(", ");
                    }
                    self.write(*a, 0, out);
                }
            }),
            Node::Call { function, output, args } => {
                let name = format!("function{}_{}", function.0, output + 1);
                call(out, &name, |out| {
                    for (i, a) in g.list(args).iter().enumerate() {
                        if i > 0 {
                            out.push_str(", ");
                        }
                        self.write(*a, 0, out);
                    }
                });
            }
            Node::Initial => out.push_str("initial()"),
            Node::Terminal => out.push_str("terminal()"),
            Node::Relation(k) => match (self.relation)(k) {
                Some((op, a, b)) => {
                    self.write(a, SUM, out);
                    out.push_str(&format!(" {} ", op.name()));
                    self.write(b, SUM, out);
                }
                None => out.push_str(&format!("$relation[{}]", k + 1)),
            },
        }
        if parenthesised {
            out.push(')');
        }
    }

    fn unary_name(&self, op: Unary) -> &'static str {
        match op {
            Unary::External(f) => self.graph.externals().get(f).signature().name,
            op => op.name(),
        }
    }

    fn binary_name(&self, op: Binary) -> &'static str {
        match op {
            Binary::External(f) => self.graph.externals().get(f).signature().name,
            op => op.name(),
        }
    }

    fn if_chain(&self, e: ExprId, out: &mut String) {
        let mut rest = e;
        let mut keyword = "if ";
        while let Node::If(c, a, b) = self.graph.node(rest) {
            out.push_str(keyword);
            self.write(c, OR, out);
            out.push_str(" then ");
            self.write(a, OR, out);
            keyword = " elseif ";
            rest = b;
        }
        out.push_str(" else ");
        self.write(rest, OR, out);
    }

    fn literal(&self, c: Const, out: &mut String) {
        match c {
            Const::Real(bits) => out.push_str(&real_literal(f64::from_bits(bits))),
            Const::Integer(i) => out.push_str(&i.to_string()),
            Const::Boolean(b) => out.push_str(if b { "true" } else { "false" }),
            Const::String(s) => {
                out.push('"');
                for ch in s.chars() {
                    match ch {
                        '"' => out.push_str("\\\""),
                        '\\' => out.push_str("\\\\"),
                        '\n' => out.push_str("\\n"),
                        '\t' => out.push_str("\\t"),
                        other => out.push(other),
                    }
                }
                out.push('"');
            }
            Const::Enumeration(e, k) => {
                let ty = &self.graph.enumerations[e];
                out.push_str(&(self.enumeration)(&ty.name));
                out.push('.');
                out.push_str(&ty.literals[k as usize - 1]);
            }
        }
    }

    fn strength(&self, e: ExprId) -> u8 {
        match self.graph.node(e) {
            Node::Const(Const::Real(bits)) if f64::from_bits(bits) < 0.0 => SUM,
            Node::Const(Const::Integer(i)) if i < 0 => SUM,
            Node::Unary(Unary::Neg, _) => SUM,
            Node::Unary(Unary::Not, _) => NOT,
            Node::Binary(op, ..) => operator_strengths(op).map_or(PRIMARY, |s| s.0),
            Node::If(..) => IF,
            Node::Relation(k) if (self.relation)(k).is_some() => RELATION,
            _ => PRIMARY,
        }
    }
}

fn call(out: &mut String, name: &str, args: impl FnOnce(&mut String)) {
    out.push_str(name);
    out.push('(');
    args(out);
    out.push(')');
}

/// The binding strength of the operator, and the least that its left and right operands need.
fn operator_strengths(op: Binary) -> Option<(u8, u8, u8)> {
    Some(match op.facts()?.syntax {
        Syntax::Disjunction => (OR, OR, AND),
        Syntax::Conjunction => (AND, AND, NOT),
        Syntax::Relation => (RELATION, SUM, SUM),
        Syntax::Sum => (SUM, SUM, PRODUCT),
        Syntax::Product => (PRODUCT, PRODUCT, PRODUCT + 1),
        Syntax::Power => (POWER, PRIMARY, PRIMARY),
        Syntax::Function | Syntax::Overloaded | Syntax::Prefix => return None,
    })
}

/// The arguments of `String` after the value, unless they have their defaults.
fn push_form(form: Form, ty: Type, out: &mut String) {
    if let Some(format) = form.format {
        out.push_str(&format!(", format = \"{format}\""));
        return;
    }
    if form.digits != Form::default().digits && ty == Type::Real {
        out.push_str(&format!(", significantDigits = {}", form.digits));
    }
    if form.width > 0 {
        out.push_str(&format!(", minimumLength = {}", form.width));
    }
    if !form.left {
        out.push_str(", leftJustified = false");
    }
}

/// The name of a scalar type in flat Modelica.
pub fn type_name(graph: &Graph, ty: Type) -> String {
    match ty {
        Type::Real => "Real".into(),
        Type::Integer => "Integer".into(),
        Type::Boolean => "Boolean".into(),
        Type::String => "String".into(),
        Type::Clock => "Clock".into(),
        Type::Enumeration(e) => graph.enumerations[e].name.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parentheses_only_where_the_meaning_needs_them() {
        let mut g = Graph::new();
        let [a, b, c] = [0, 1, 2].map(|i| g.var(VarId(i), Type::Real));
        let names = |v: VarId| ["a", "b", "c"][v.0 as usize].to_string();
        let sum = g.add(a, b);
        let difference = g.sub(b, c);
        let two = g.real(2.0);
        let cases = [
            (g.mul(sum, c), "(a + b) * c"),
            (g.sub(a, difference), "a - (b - c)"),
            (g.div(a, sum), "a / (a + b)"),
            (g.pow(sum, two), "(a + b)^2.0"),
            (g.add(sum, difference), "a + b + (b - c)"),
        ];
        for (e, text) in cases {
            assert_eq!(print(&g, e, &names), text);
        }
        let quotient = g.div(b, c);
        let e = g.mul(a, quotient);
        assert_eq!(print(&g, e, &names), "a * (b / c)");
        let negative = g.neg(sum);
        let e = g.mul(negative, c);
        assert_eq!(print(&g, e, &names), "-(a + b) * c");
        assert_eq!(real_literal(1e-9), "1e-9");
        assert_eq!(real_literal(0.1), "0.1");
    }
}
