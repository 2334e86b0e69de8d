//! Measures, split into the arguments of their functions and the arithmetic between the functions.

use std::sync::Arc;

use super::error;
use super::formula::name_of;
use crate::base::diag::Problems;
use crate::base::name::name;
use crate::base::source::{SourceMap, Span};
use crate::ir::ast::{BinaryOp, ComponentRef, Expr, ExprKind, Ident, RefPart};
use crate::parse::fragment::{binding, replace_keywords};
use crate::parse::token::TokenKind;

/// Functions that are called like keywords, as the parser gets them.
const WORDS: [(TokenKind, &str, &str); 3] = [
    (TokenKind::When, "when", "_hen"),
    (TokenKind::Final, "final", "_inal"),
    (TokenKind::Initial, "initial", "_nitial"),
];

/// Measures, ready to be put into a model.
#[derive(Clone, Default, Debug)]
pub struct Measures {
    /// In the order given.
    pub list: Vec<Measure>,
    /// The functions in them.
    pub functions: Vec<Function>,
    /// Arguments of functions.
    pub expressions: Vec<Expr>,
    /// When something has happened.
    pub conditions: Vec<Expr>,
    /// The model gets variables for the derivatives of measures ([`super::slopes`]).
    pub has_slopes: bool,
}

/// A measure.
#[derive(Clone, Debug)]
pub struct Measure {
    /// Its name.
    pub name: String,
    /// Its source after `=`.
    pub text: String,
    /// The arithmetic, in which parameters take the place of functions, see [`Measures::value_name`].
    pub value: Arc<Expr>,
    /// Positions of the functions that it needs, those of earlier measures too.
    pub needs: Vec<usize>,
}

/// A function of a measure: one number from the trajectory of an expression.
#[derive(Clone, PartialEq, Debug)]
pub enum Function {
    /// The first time at which a condition is true, s.
    When(usize),
    /// The value at the start of the run.
    Initial(usize),
    /// The value at the end of the run.
    Final(usize),
    /// The value when a condition becomes true, before anything jumps by it.
    At(usize, usize),
    /// The greatest or the least value in a range.
    ExtremumRequest {
        /// Of this expression.
        of: usize,
        /// The greatest.
        greatest: bool,
        /// Where.
        range: Range,
    },
    /// The integral over a range of time.
    Integral {
        /// Of this expression.
        of: usize,
        /// Where.
        range: Range,
        /// Divided by the length of the range.
        mean: bool,
    },
}

/// A part of a run, by conditions.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Range {
    /// Begins when this becomes true.
    pub from: Option<usize>,
    /// Ends when this becomes true.
    pub until: Option<usize>,
}

impl Measures {
    /// Reads all measures.
    pub fn read(texts: &[String], sources: &mut SourceMap, problems: &mut Problems) -> Measures {
        let mut all = Measures::default();
        for text in texts {
            all.add(text, sources, problems);
        }
        all
    }

    /// Name of the parameter that takes the value of a function.
    pub fn value_name(k: usize) -> String {
        format!("'measure: value {k}'")
    }

    /// The SI unit of a measure where that is plain: one function of one variable, `unit_of` it.
    pub fn unit(&self, measure: &Measure, unit_of: impl Fn(&str) -> String) -> String {
        let of = |e: usize| match &self.expressions[e].kind {
            ExprKind::Ref(r) => unit_of(&name_of(r)),
            _ => String::new(),
        };
        let ExprKind::Ref(r) = &measure.value.kind else { return String::new() };
        let value = r.simple();
        let function = (0..self.functions.len())
            .find(|k| value.is_some_and(|v| *v == *Measures::value_name(*k)));
        match function.map(|k| &self.functions[k]) {
            Some(Function::When(_)) => "s".to_owned(),
            Some(Function::Initial(e) | Function::Final(e) | Function::At(e, _)) => of(*e),
            Some(
                Function::ExtremumRequest { of: e, .. }
                | Function::Integral { of: e, mean: true, .. },
            ) => of(*e),
            _ => String::new(),
        }
    }

    fn add(&mut self, text: &str, sources: &mut SourceMap, problems: &mut Problems) {
        let named = text.split_once('=').filter(|(left, _)| is_name(left.trim()));
        let Some((left, right)) = named else {
            problems.push(error::no_name(text));
            return;
        };
        let called = left.trim();
        if self.list.iter().any(|m| m.name == called) {
            problems.push(error::twice(called));
            return;
        }
        let words = WORDS.map(|(kind, _, word)| (kind, word));
        let parsed = replace_keywords(right, &words);
        let place = text.len() - right.len();
        let Some(mut value) = binding("--measure", text, place, Some(&parsed), sources) else {
            problems.push(error::no_expression(text));
            return;
        };
        let mut needs = Vec::new();
        self.cut(&mut value, &mut needs, problems);
        let (name, text) = (called.to_owned(), right.trim().to_owned());
        self.list.push(Measure { name, text, value: Arc::new(value), needs });
    }

    /// Replaces the functions in an expression by names for their values.
    fn cut(&mut self, e: &mut Expr, needs: &mut Vec<usize>, problems: &mut Problems) {
        if let ExprKind::Ref(r) = &e.kind
            && let Some(earlier) = self.earlier(r)
        {
            needs.extend(&self.list[earlier].needs);
        }
        if let Some(function) = self.function(e, problems) {
            let k = self.functions.len();
            self.functions.push(function);
            needs.push(k);
            e.kind = reference(&Measures::value_name(k), e.span);
            return;
        }
        for_each_part(e, &mut |part| self.cut(part, needs, problems));
    }

    /// The function that a call is, if it is one of those of measures.
    fn function(&mut self, e: &Expr, problems: &mut Problems) -> Option<Function> {
        let ExprKind::Call { function, args, named } = &e.kind else { return None };
        let called = function.simple()?;
        let called = original(&called);
        let mut wrong = |usage: &str| {
            problems.push(error::arguments(e.span, called, usage));
            Some(Function::When(0))
        };
        let ranged = args.len() == 1 || args.len() == 2 && self.is_when(&args[1]);
        match called {
            "when" => match (args.as_slice(), named.as_slice()) {
                ([c], []) => Some(Function::When(self.condition(c, problems))),
                _ => wrong("when(CONDITION)"),
            },
            "initial" | "final" => match (args.as_slice(), named.as_slice()) {
                ([of], []) => {
                    let of = self.expression(of, problems);
                    Some(if called == "final" {
                        Function::Final(of)
                    } else {
                        Function::Initial(of)
                    })
                }
                _ => wrong(&format!("{called}(EXPRESSION)")),
            },
            "at" => match (args.as_slice(), named.as_slice()) {
                ([of, t], []) => {
                    let c = self.instant(t, problems);
                    Some(Function::At(self.expression(of, problems), c))
                }
                _ => wrong("at(EXPRESSION, TIME), the time in s or as when(CONDITION)"),
            },
            // With two arguments they are the built-in functions.
            "min" | "max" if !ranged => None,
            "min" | "max" | "integral" | "mean" => {
                let known = |n: &(Ident, Expr)| matches!(&*n.0.name, "from" | "until");
                if !ranged || !named.iter().all(known) {
                    return wrong(&format!(
                        "{called}(EXPRESSION, from = CONDITION, until = CONDITION)"
                    ));
                }
                let mut range = Range::default();
                for (which, c) in named {
                    let end = self.end(c, problems);
                    if *which.name == *"from" {
                        range.from = Some(end)
                    } else {
                        range.until = Some(end)
                    }
                }
                if let Some(until) = args.get(1) {
                    range.until = Some(self.end(until, problems));
                }
                let of = self.expression(&args[0], problems);
                Some(match called {
                    "integral" | "mean" => Function::Integral { of, range, mean: called == "mean" },
                    _ => Function::ExtremumRequest { of, range, greatest: called == "max" },
                })
            }
            _ => None,
        }
    }

    fn expression(&mut self, e: &Expr, problems: &mut Problems) -> usize {
        let before = problems.error_count();
        self.refuse_values(&mut e.clone(), problems);
        // What was refused must not be an unknown function as well.
        let is_refused = problems.error_count() > before;
        let time = || Expr { kind: reference("time", e.span), span: e.span };
        self.expressions.push(if is_refused { time() } else { e.clone() });
        self.expressions.len() - 1
    }

    fn condition(&mut self, e: &Expr, problems: &mut Problems) -> usize {
        let before = problems.error_count();
        self.refuse_values(&mut e.clone(), problems);
        let is_refused = problems.error_count() > before;
        let never = || Expr { kind: ExprKind::Boolean(false), span: e.span };
        self.conditions.push(if is_refused { never() } else { e.clone() });
        self.conditions.len() - 1
    }

    /// The end of a range: a condition, or when it becomes true.
    fn end(&mut self, e: &Expr, problems: &mut Problems) -> usize {
        match self.known_when(e) {
            Some(c) => c,
            None => match when_condition(e) {
                Some(inner) => self.condition(inner, problems),
                None => self.condition(e, problems),
            },
        }
    }

    /// An instant as a condition: a time, or when a condition becomes true.
    fn instant(&mut self, e: &Expr, problems: &mut Problems) -> usize {
        if self.is_when(e) {
            return self.end(e, problems);
        }
        let time = Expr { kind: reference("time", e.span), span: e.span };
        let kind = ExprKind::Binary(BinaryOp::GreaterEqual, Box::new(time), Box::new(e.clone()));
        self.condition(&Expr { kind, span: e.span }, problems)
    }

    fn is_when(&self, e: &Expr) -> bool {
        when_condition(e).is_some() || self.known_when(e).is_some()
    }

    /// The condition of an earlier measure that is nothing but `when(...)`.
    fn known_when(&self, e: &Expr) -> Option<usize> {
        let ExprKind::Ref(r) = &e.kind else { return None };
        let measure = &self.list[self.earlier(r)?];
        let ExprKind::Ref(value) = &measure.value.kind else { return None };
        let [k] = measure.needs.as_slice() else { return None };
        let whole = value.simple().is_some_and(|n| *n == *Measures::value_name(*k));
        match self.functions[*k] {
            Function::When(c) if whole => Some(c),
            _ => None,
        }
    }

    fn earlier(&self, r: &ComponentRef) -> Option<usize> {
        let wanted = r.simple()?;
        self.list.iter().position(|m| m.name.as_str() == &*wanted)
    }

    /// Reports values that are known only after the run in expressions that are computed during it.
    fn refuse_values(&self, e: &mut Expr, problems: &mut Problems) {
        match &e.kind {
            ExprKind::Ref(r) => {
                if let Some(k) = self.earlier(r) {
                    problems.push(error::earlier(e.span, &self.list[k].name));
                }
            }
            ExprKind::Call { function, args, .. } => {
                let called = function.simple();
                let called = called.as_ref().map_or("", |n| original(n));
                let own = WORDS.iter().any(|(_, word, _)| *word == called && !args.is_empty());
                if own || matches!(called, "integral" | "mean") {
                    problems.push(error::nested(e.span, called));
                }
            }
            _ => {}
        }
        for_each_part(e, &mut |part| self.refuse_values(part, problems));
    }
}

/// The condition of `when(condition)`.
fn when_condition(e: &Expr) -> Option<&Expr> {
    let ExprKind::Call { function, args, named } = &e.kind else { return None };
    match (args.as_slice(), named.as_slice()) {
        ([c], []) if original(&function.simple()?) == "when" => Some(c),
        _ => None,
    }
}

/// The name of a function as the user writes it.
fn original(called: &str) -> &str {
    WORDS.iter().find(|(_, _, word)| *word == called).map_or(called, |(_, word, _)| word)
}

fn is_name(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(|c| c.is_alphabetic() || c == '_')
        && letters.all(|c| c.is_alphanumeric() || c == '_')
        && TokenKind::keyword(text).is_none()
}

/// A reference to one name.
pub(super) fn reference(called: &str, span: Span) -> ExprKind {
    let part = RefPart { name: Ident { name: name(called), span }, subscripts: Vec::new() };
    ExprKind::Ref(ComponentRef { global: false, parts: vec![part], span })
}

/// Calls `visit` for each direct subexpression.
fn for_each_part(e: &mut Expr, visit: &mut dyn FnMut(&mut Expr)) {
    match &mut e.kind {
        ExprKind::Unary(_, a) | ExprKind::Parenthesised(a) | ExprKind::Indexed(a, _) => visit(a),
        ExprKind::Binary(_, a, b) => {
            visit(a);
            visit(b);
        }
        ExprKind::If { branches, otherwise } => {
            for (condition, value) in branches {
                visit(condition);
                visit(value);
            }
            visit(otherwise);
        }
        ExprKind::Call { args, named, .. } => {
            args.iter_mut().for_each(&mut *visit);
            named.iter_mut().for_each(|(_, value)| visit(value));
        }
        ExprKind::Array(items) => items.iter_mut().for_each(visit),
        ExprKind::Matrix(rows) => rows.iter_mut().flatten().for_each(visit),
        ExprKind::Range { start, step, stop } => {
            visit(start);
            step.iter_mut().for_each(|s| visit(s));
            visit(stop);
        }
        ExprKind::Tuple(items) => items.iter_mut().flatten().for_each(visit),
        ExprKind::Reduction { body, .. } | ExprKind::Comprehension { body, .. } => visit(body),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(texts: &[&str]) -> (Measures, Vec<String>) {
        let texts: Vec<String> = texts.iter().map(|t| (*t).to_owned()).collect();
        let mut problems = Problems::new();
        let all = Measures::read(&texts, &mut SourceMap::default(), &mut problems);
        (all, problems.iter().map(|d| d.message.clone()).collect())
    }

    #[test]
    fn functions_are_distinguished_from_built_in_ones() {
        let (all, problems) = read(&[
            "t = when(x > 1)",
            "a = max(x) - min(x, 2)",
            "b = max(max(x, y), until = t) + integral(x, when(y > 2))",
            "c = if final(x) > 0 then at(x, 0.5) else initial(x)",
        ]);
        assert_eq!(problems, [""; 0]);
        let whole = Range::default();
        let until = |c| Range { from: None, until: Some(c) };
        assert_eq!(
            all.functions,
            [
                Function::When(0),
                Function::ExtremumRequest { of: 0, greatest: true, range: whole },
                Function::ExtremumRequest { of: 1, greatest: true, range: until(0) },
                Function::Integral { of: 2, range: until(1), mean: false },
                Function::Final(3),
                Function::At(4, 2),
                Function::Initial(5),
            ]
        );
        assert_eq!(all.list[3].needs, [4, 5, 6]);
        assert_eq!(all.unit(&all.list[0], |_| String::new()), "s");
    }

    #[test]
    fn errors_are_reported() {
        let (_, problems) = read(&[
            "x > 1",
            "a = 1 +",
            "t = when(x > 1, 2)",
            "u = max(final(x))",
            "t = 2",
            "v = mean(2*u)",
        ]);
        assert_eq!(
            problems,
            [
                "the measure `x > 1` has no name",
                "the measure `a = 1 +` is not an expression",
                "`when` does not take these arguments",
                "`final` cannot occur inside another function of a measure",
                "there are two measures `t`",
                "the measure `u` cannot occur inside a function",
            ]
        );
    }
}
