//! An interpolated function as a function of Modelica.

use super::Extrapolation;
use super::curve::Curve;
use crate::numeric::hermite::polynomial;

impl Curve {
    /// The declaration of a function of this name whose value is the derivative of this order; the curve itself for order 0.
    pub fn modelica(&self, name: &str, order: u8) -> String {
        let (first, last) = self.range();
        let head = format!("  function {name}\n    input Real u;\n    output Real y;\n");
        let value = |x: f64| format!("{x:?}");
        // A sign does not follow an operator.
        let operand = |x: f64| if x < 0.0 { format!("({x:?})") } else { value(x) };
        if self.pieces().is_empty() {
            let constant = value(self.at(first, order));
            return format!("{head}  algorithm\n    y := {constant};\n  end {name};\n");
        }
        let points: Vec<String> = self.points().iter().map(|x| value(*x)).collect();
        // The coefficients of the derivative, lowest power first.
        let factor = [1.0, 1.0, 2.0, 6.0];
        let coefficient = |piece: &[f64; 4], k: usize| {
            let k = k as u8;
            let above = if k + order > 3 { 0.0 } else { polynomial(piece, 0.0, k + order) };
            value(above / factor[usize::from(k)])
        };
        let row = |piece: &[f64; 4]| {
            let all: Vec<String> = (0..4).map(|k| coefficient(piece, k)).collect();
            format!("{{{}}}", all.join(", "))
        };
        let rows: Vec<String> = self.pieces().iter().map(row).collect();
        let beyond = |end: f64, outside: f64| {
            let at_end = if order == 0 { self.end(end) } else { self.at(outside, order) };
            match (order, self.extrapolation()) {
                (0, Extrapolation::Linear) => {
                    let slope = operand(self.at(outside, 1));
                    format!("{} + {slope}*(d - {})", value(at_end), operand(end))
                }
                _ => value(at_end),
            }
        };
        let span = last - first;
        let (before, after) = (beyond(first, first - span), beyond(last, last + span));
        let (n, m) = (points.len(), rows.len());
        let inside = match self.extrapolation() {
            Extrapolation::Periodic => {
                format!("u - {span:?}*floor((u - {})/{span:?})", operand(first))
            }
            _ => "u".to_owned(),
        };
        let (first, last) = (value(first), value(last));
        // The last point belongs to the last interval, as in `Curve::at`.
        let after_last = if order == 0 { ">=" } else { ">" };
        let (points, rows) = (points.join(", "), rows.join(", "));
        format!(
            "{head}  protected\n    constant Real x[{n}] = {{{points}}};\n    \
             constant Real c[{m}, 4] = {{{rows}}};\n    Real d;\n    Integer k;\n  algorithm\n    \
             d := {inside};\n    \
             if d < {first} then\n      y := {before};\n    \
             elseif d {after_last} {last} then\n      y := {after};\n    else\n      k := 1;\n      \
             while k < {m} and d >= x[k + 1] loop\n        k := k + 1;\n      end while;\n      \
             d := d - x[k];\n      \
             y := c[k, 1] + d*(c[k, 2] + d*(c[k, 3] + d*c[k, 4]));\n    end if;\n  end {name};\n"
        )
    }
}
