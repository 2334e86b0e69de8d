//! Formulas over the columns of a table, row by row, in Modelica syntax, for charts.

use crate::base::source::SourceMap;
use crate::ir::ast::{BinaryOp, ComponentRef, Expr, ExprKind, RefPart, Subscript, UnaryOp};
use crate::ir::expr::Unary;
use crate::ir::external::Externals;
use crate::parse::fragment::binding;
use crate::symbolic::eval;

/// A formula.
#[derive(Clone, Debug)]
pub struct Formula {
    text: String,
    tree: Expr,
}

/// Columns by name.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// Names.
    pub names: Vec<String>,
    /// Values, one vector for each name; NaN where there is none.
    pub values: Vec<Vec<f64>>,
}

impl Formula {
    /// Reads a formula.
    pub fn read(text: &str) -> Result<Formula, String> {
        let whole = format!("y={text}");
        let tree = binding("--y", &whole, 2, None, &mut SourceMap::default());
        let tree = tree.ok_or_else(|| format!("`{text}` is not a formula"))?;
        Ok(Formula { text: text.trim().to_owned(), tree })
    }

    /// Its values; none if the table lacks one of its columns. The error names unsupported syntax.
    pub fn of(&self, columns: &Columns) -> Result<Option<Vec<f64>>, String> {
        let rows = columns.values.first().map_or(0, Vec::len);
        match evaluate(&self.tree, columns, rows) {
            Ok(values) => Ok(Some(values)),
            Err(Why::Missing) => Ok(None),
            Err(Why::Unknown(what)) => Err(format!("`{}`: {what}", self.text)),
        }
    }
}

enum Why {
    Missing,
    Unknown(String),
}

fn evaluate(e: &Expr, columns: &Columns, rows: usize) -> Result<Vec<f64>, Why> {
    let unknown = |what: &str| Why::Unknown(what.to_owned());
    let of = |e: &Expr| evaluate(e, columns, rows);
    let both = |a: &Expr, b: &Expr, f: fn(f64, f64) -> f64| {
        Ok(of(a)?.into_iter().zip(of(b)?).map(|(a, b)| f(a, b)).collect())
    };
    match &e.kind {
        ExprKind::Real(x) => Ok(vec![*x; rows]),
        ExprKind::Integer(n) => Ok(vec![*n as f64; rows]),
        ExprKind::Parenthesised(a) => of(a),
        ExprKind::Ref(r) => {
            let name = name_of(r);
            let at = columns.names.iter().position(|n| *n == name).ok_or(Why::Missing)?;
            Ok(columns.values[at].clone())
        }
        ExprKind::Unary(UnaryOp::Minus, a) => Ok(of(a)?.into_iter().map(|x| -x).collect()),
        ExprKind::Binary(op, a, b) => match op {
            BinaryOp::Add => both(a, b, |a, b| a + b),
            BinaryOp::Sub => both(a, b, |a, b| a - b),
            BinaryOp::Mul => both(a, b, |a, b| a * b),
            BinaryOp::Div => both(a, b, |a, b| a / b),
            BinaryOp::Pow => both(a, b, f64::powf),
            _ => Err(unknown("only + - * / ^ are supported")),
        },
        ExprKind::Call { function, args, .. } => {
            match (name_of(function).as_str(), args.as_slice()) {
                ("slope", [y, x, Expr { kind: ExprKind::Integer(n), .. }]) => {
                    Ok(slopes(&of(x)?, &of(y)?, (*n).clamp(1, 10_000) as usize))
                }
                (name, [a]) if let Some(op) = Unary::called(name) => {
                    let none = Externals::default();
                    Ok(of(a)?.into_iter().map(|x| eval::unary(op, x, &none)).collect())
                }
                _ => Err(unknown(
                    "only functions of one argument, such as sqrt(a), and slope(y, x, rows) are supported",
                )),
            }
        }
        _ => Err(unknown("only numbers, columns, arithmetic and functions are supported")),
    }
}

/// The slope of the straight line through each row and `n` neighbours on either side, by least squares: the
/// derivative of a noisy signal (Savitzky and Golay 1964, first order).
fn slopes(x: &[f64], y: &[f64], n: usize) -> Vec<f64> {
    let slope = |k: usize| {
        let near = k.saturating_sub(n)..(k + n + 1).min(x.len());
        let count = near.len() as f64;
        let mean = |v: &[f64]| v[near.clone()].iter().sum::<f64>() / count;
        let (mx, my) = (mean(x), mean(y));
        let sums = near.clone().fold((0.0, 0.0), |(xy, xx), i| {
            (xy + (x[i] - mx) * (y[i] - my), xx + (x[i] - mx) * (x[i] - mx))
        });
        sums.0 / sums.1
    };
    (0..x.len()).map(slope).collect()
}

/// A reference as a string, with literal subscripts.
pub fn name_of(r: &ComponentRef) -> String {
    let index = |s: &Subscript| match s {
        Subscript::Expr(Expr { kind: ExprKind::Integer(i), .. }) => i.to_string(),
        _ => "?".to_owned(),
    };
    let part = |p: &RefPart| {
        let list: Vec<String> = p.subscripts.iter().map(index).collect();
        if list.is_empty() {
            p.name.name.to_string()
        } else {
            format!("{}[{}]", p.name.name, list.join(","))
        }
    };
    r.parts.iter().map(part).collect::<Vec<_>>().join(".")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Columns {
        let x: Vec<f64> = (0..5).map(f64::from).collect();
        let y = x.iter().map(|x| 3.0 * x + 1.0).collect();
        Columns { names: vec!["t".into(), "a.b[2]".into()], values: vec![x, y] }
    }

    #[test]
    fn formulas_are_evaluated_row_by_row() {
        let of = |text: &str| Formula::read(text).unwrap().of(&columns());
        assert_eq!(of("2*(a.b[2] - 1)^2/9"), Ok(Some(vec![0.0, 2.0, 8.0, 18.0, 32.0])));
        assert_eq!(of("slope(a.b[2], t, 1)"), Ok(Some(vec![3.0; 5])));
        assert_eq!(of("missing + 1"), Ok(None));
        assert_eq!(of("sqrt(t*t)"), Ok(Some(vec![0.0, 1.0, 2.0, 3.0, 4.0])));
        assert!(of("atan2(t, t)").is_err() && of("t > 1").is_err());
        assert!(Formula::read("1 +").is_err());
    }
}
