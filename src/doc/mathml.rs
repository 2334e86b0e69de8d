//! Equations as MathML Core.
//!
//! A derivative is a dot above, a quotient a fraction, a power an exponent; the part of a name after `_` is its index, and
//! the name of a Greek letter is the letter. Forms without a notation of their own stand as they are written.

use crate::ir::ast::{
    BinaryOp, ComponentRef, Equation, EquationKind, Expr, ExprKind, RefPart, Subscript, UnaryOp,
};
use crate::ir::expr::Unary;
use crate::report::markup::escaped;

/// Greek letters by their names.
const GREEK: [(&str, char); 24] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Delta", 'Δ'),
    ("Phi", 'Φ'),
    ("Omega", 'Ω'),
];

/// Writes equations of a text.
pub struct Typesetter<'t> {
    /// The text of the file.
    pub text: &'t str,
}

impl Typesetter<'_> {
    /// An equation as lines; connections are not among them.
    pub fn equation(&self, equation: &Equation, out: &mut String, depth: usize) {
        let line = |content: String, out: &mut String| {
            let indent = 1.5 * depth as f64;
            out.push_str(&format!(
                "<div class=\"equation\" style=\"margin-left:{indent}em\"><math display=\"inline\"><mrow>{content}</mrow></math></div>\n"
            ));
        };
        let word = |text: &str| format!("<mtext>{text}&#160;</mtext>");
        let branches = |first: &str, all: &[(Expr, Vec<Equation>)], out: &mut String| {
            for (k, (condition, body)) in all.iter().enumerate() {
                let keyword = if k == 0 { first.to_owned() } else { format!("else{first}") };
                line(word(&keyword) + &self.expression(condition, 0), out);
                body.iter().for_each(|e| self.equation(e, out, depth + 1));
            }
        };
        match &equation.kind {
            EquationKind::Equal(a, b) => {
                line(format!("{}<mo>=</mo>{}", self.expression(a, 0), self.expression(b, 0)), out);
            }
            EquationKind::If { branches: all, otherwise } => {
                branches("if", all, out);
                if !otherwise.is_empty() {
                    line(word("else"), out);
                    otherwise.iter().for_each(|e| self.equation(e, out, depth + 1));
                }
            }
            EquationKind::When { branches: all } => branches("when", all, out),
            EquationKind::For { iterators, body } => {
                let names: Vec<String> =
                    iterators.iter().map(|i| i.name.name.to_string()).collect();
                line(word("for each") + &name(&names.join(", ")), out);
                body.iter().for_each(|e| self.equation(e, out, depth + 1));
            }
            EquationKind::Connect(..) | EquationKind::Broken => {}
            // What must hold is no equation.
            EquationKind::Call(call) if is_assertion(call) => {}
            EquationKind::Call(call) => line(self.expression(call, 0), out),
        }
    }

    fn written(&self, e: &Expr) -> String {
        let text = self.text.get(e.span.start as usize..e.span.end as usize).unwrap_or_default();
        format!("<mtext>{}</mtext>", escaped(text))
    }

    /// An expression whose operators bind at least as strongly as `level`; weaker ones get parentheses.
    fn expression(&self, e: &Expr, level: u8) -> String {
        match &e.kind {
            ExprKind::Real(_) | ExprKind::Integer(_) => self.number(e),
            ExprKind::Parenthesised(inner) => self.expression(inner, level),
            ExprKind::Boolean(flag) => format!("<mi>{flag}</mi>"),
            ExprKind::Ref(r) => self.reference(r),
            ExprKind::Unary(op, inner) => {
                let sign = match op {
                    UnaryOp::Not => "<mo>¬</mo>",
                    UnaryOp::Minus | UnaryOp::ElementMinus => "<mo>−</mo>",
                    _ => "",
                };
                bracketed(format!("{sign}{}", self.expression(inner, 4)), level > 3)
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, level),
            ExprKind::If { branches, otherwise } => {
                let row = |value: &Expr, condition: String| {
                    format!(
                        "<mtr><mtd>{}</mtd><mtd>{condition}</mtd></mtr>",
                        self.expression(value, 0)
                    )
                };
                let rows: String = branches
                    .iter()
                    .map(|(c, v)| {
                        row(v, format!("<mtext>if&#160;</mtext>{}", self.expression(c, 0)))
                    })
                    .collect();
                let last = row(otherwise, "<mtext>otherwise</mtext>".to_owned());
                format!(
                    "<mrow><mo>{{</mo><mtable columnalign=\"left\">{rows}{last}</mtable></mrow>"
                )
            }
            ExprKind::Call { function, args, named } if named.is_empty() => {
                self.call(function, args)
            }
            _ => self.written(e),
        }
    }

    fn number(&self, e: &Expr) -> String {
        let text = self.text.get(e.span.start as usize..e.span.end as usize).unwrap_or_default();
        match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => {
                let exponent = exponent.trim_start_matches('+').replace('-', "−");
                format!("<mn>{mantissa}</mn><mo>·</mo><msup><mn>10</mn><mn>{exponent}</mn></msup>")
            }
            None => format!("<mn>{}</mn>", escaped(text)),
        }
    }

    fn binary(&self, op: BinaryOp, a: &Expr, b: &Expr, level: u8) -> String {
        use BinaryOp as Op;
        if matches!(op, Op::Div | Op::ElementDiv) {
            let (a, b) = (self.expression(a, 0), self.expression(b, 0));
            return format!("<mfrac><mrow>{a}</mrow><mrow>{b}</mrow></mfrac>");
        }
        if matches!(op, Op::Pow | Op::ElementPow) {
            let (a, b) = (self.expression(a, 6), self.expression(b, 0));
            return format!("<msup><mrow>{a}</mrow><mrow>{b}</mrow></msup>");
        }
        let (sign, own) = match op {
            Op::Add | Op::ElementAdd => ("+", 3),
            Op::Sub | Op::ElementSub => ("−", 3),
            Op::Mul | Op::ElementMul => ("·", 4),
            Op::Less => ("&lt;", 2),
            Op::LessEqual => ("≤", 2),
            Op::Greater => ("&gt;", 2),
            Op::GreaterEqual => ("≥", 2),
            Op::Equal => ("=", 2),
            Op::NotEqual => ("≠", 2),
            Op::And => ("∧", 1),
            Op::Or => ("∨", 0),
            Op::Div | Op::ElementDiv | Op::Pow | Op::ElementPow => ("", 4),
        };
        // What is subtracted or multiplied needs its sum in parentheses.
        let right = if matches!(op, Op::Sub | Op::ElementSub | Op::Mul | Op::ElementMul) {
            own + 1
        } else {
            own
        };
        let text =
            format!("{}<mo>{sign}</mo>{}", self.expression(a, own), self.expression(b, right));
        bracketed(text, level > own)
    }

    fn call(&self, function: &ComponentRef, args: &[Expr]) -> String {
        let called: Vec<String> = function.parts.iter().map(|p| p.name.name.to_string()).collect();
        let called = called.join(".");
        match (Unary::called(&called), args) {
            (Some(Unary::Sqrt), [x]) => {
                return format!("<msqrt>{}</msqrt>", self.expression(x, 0));
            }
            (Some(Unary::Abs), [x]) => {
                return format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", self.expression(x, 0));
            }
            _ => {}
        }
        match (called.as_str(), args) {
            ("der", [x]) => format!(
                "<mover accent=\"true\"><mrow>{}</mrow><mo>˙</mo></mover>",
                self.expression(x, 6)
            ),
            ("noEvent" | "smooth", [.., x]) => self.expression(x, 0),
            ("pre", [x]) => {
                format!("<mi>pre</mi><mrow><mo>(</mo>{}<mo>)</mo></mrow>", self.expression(x, 0))
            }
            _ => {
                let all: Vec<String> = args.iter().map(|a| self.expression(a, 0)).collect();
                let short = called.rsplit('.').next().unwrap_or(&called);
                format!(
                    "<mi>{}</mi><mo>&#8289;</mo><mrow><mo>(</mo>{}<mo>)</mo></mrow>",
                    escaped(short),
                    all.join("<mo>,</mo>")
                )
            }
        }
    }

    fn reference(&self, r: &ComponentRef) -> String {
        let part = |p: &RefPart| {
            let own = name(&p.name.name);
            if p.subscripts.is_empty() {
                return own;
            }
            let subscripts = p.subscripts.iter().map(|s| match s {
                Subscript::Expr(e) => self.expression(e, 0),
                _ => "<mo>:</mo>".to_owned(),
            });
            let all: Vec<String> = subscripts.collect();
            format!("<mrow>{own}<mo>[</mo>{}<mo>]</mo></mrow>", all.join("<mo>,</mo>"))
        };
        r.parts.iter().map(part).collect::<Vec<_>>().join("<mo>.</mo>")
    }
}

fn is_assertion(call: &Expr) -> bool {
    let ExprKind::Call { function, .. } = &call.kind else { return false };
    function.simple().is_some_and(|name| &*name == "assert")
}

fn bracketed(text: String, is_weak: bool) -> String {
    if is_weak { format!("<mrow><mo>(</mo>{text}<mo>)</mo></mrow>") } else { text }
}

/// A name with its index.
fn name(text: &str) -> String {
    let letter = |word: &str| {
        let greek = GREEK.iter().find(|(name, _)| *name == word);
        greek.map_or_else(|| escaped(word), |(_, letter)| letter.to_string())
    };
    match text.split_once('_').filter(|(a, b)| !a.is_empty() && !b.is_empty()) {
        Some((base, index)) => {
            format!(
                "<msub><mi>{}</mi><mtext>{}</mtext></msub>",
                letter(base),
                letter(&index.replace('_', ","))
            )
        }
        None => format!("<mi>{}</mi>", letter(text)),
    }
}
