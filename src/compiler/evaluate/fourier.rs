//! The discrete Fourier transform of numbers that only a run knows: a function of the flat model, with a
//! local variable for each term of each shorter transform.
//!
//! *J. W. Cooley and J. W. Tukey, An algorithm for the machine calculation of complex Fourier series,
//! Math. Comp. 19 (1965)*, with a factor for each prime of the length.

use super::Evaluator;
use super::external::Refusal;
use super::value::Value;
use crate::base::index::Id;
use crate::base::source::Span;
use crate::ir::expr::{Binary, ExprId, FunctionId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::{Function, LocalId, Statement};

/// A complex number: real and imaginary part.
type Complex = [ExprId; 2];

impl Evaluator<'_> {
    /// `ModelicaFFT_kiss_fftr(u, ...)`: whether it could be done (0), and amplitudes and phases of the
    /// lower half of the spectrum, the amplitudes divided by their number.
    pub(super) fn fourier_function(
        &mut self,
        args: &[Value],
        span: Span,
    ) -> Result<Vec<Value>, Refusal> {
        let u: Option<Vec<ExprId>> = match args.first() {
            Some(Value::Array(a)) => a.elements.iter().map(Value::scalar).collect(),
            _ => None,
        };
        let u = u.filter(|u| !u.is_empty()).ok_or(Refusal::Unknown)?;
        if u.len() % 2 != 0 {
            return Err(Refusal::Wrong("the number of samples must be even".into()));
        }
        self.loops.functions.push(spectrum(&mut self.class_graph.graph, u.len(), span));
        let function = FunctionId::from_usize(self.loops.functions.len() - 1);
        let args = self.graph.intern_list(&u);
        let half = u.len() / 2 + 1;
        let mut call = |first: usize| -> Value {
            let outputs = (first..first + half).map(|k| k as u32);
            let calls = outputs.map(|output| Node::Call { function, output, args });
            Value::vector(calls.map(|call| self.graph.intern(call, Type::Real)).collect())
        };
        let (amplitudes, phases) = (call(0), call(half));
        let done = Value::Scalar(self.graph.integer(0));
        Ok(vec![done, amplitudes, phases])
    }
}

/// The function from `n` samples to amplitudes and phases.
fn spectrum(graph: &mut Graph, n: usize, span: Span) -> Function {
    let half = n / 2 + 1;
    let mut making = Making { graph, locals: Vec::new(), body: Vec::new() };
    let zero = making.graph.real(0.0);
    let samples: Vec<Complex> = (0..n).map(|_| [making.local(), zero]).collect();
    let terms = making.transform(&samples, half);
    let count = making.graph.real(half as f64);
    let mut amplitudes = Vec::with_capacity(half);
    let mut phases = Vec::with_capacity(half);
    for [re, im] in terms {
        let graph = &mut *making.graph;
        let (a, b) = (graph.mul(re, re), graph.mul(im, im));
        let square = graph.add(a, b);
        let size = graph.unary(Unary::Sqrt, square);
        amplitudes.push(graph.div(size, count));
        phases.push(graph.binary(Binary::Atan2, im, re));
    }
    let first = making.locals.len();
    for e in amplitudes.into_iter().chain(phases) {
        making.kept(e);
    }
    Function {
        name: format!("spectrum of {n}"),
        span,
        inputs: (0..n).map(LocalId::from_usize).collect(),
        outputs: (first..making.locals.len()).map(LocalId::from_usize).collect(),
        locals: making.locals.into_iter().collect(),
        body: making.body,
    }
}

/// A function in the making.
struct Making<'g> {
    graph: &'g mut Graph,
    locals: Vec<String>,
    body: Vec<Statement>,
}

impl Making<'_> {
    /// A new local variable.
    fn local(&mut self) -> ExprId {
        let number = self.locals.len();
        self.locals.push(format!("x{}", number + 1));
        self.graph.var(VarId(number as u32), Type::Real)
    }

    /// A local variable with this value.
    fn kept(&mut self, value: ExprId) -> ExprId {
        let number = self.locals.len();
        let own = self.local();
        self.body.push(Statement::Assign(LocalId::from_usize(number), value));
        own
    }

    /// The first `wanted` terms of the transform.
    fn transform(&mut self, x: &[Complex], wanted: usize) -> Vec<Complex> {
        let n = x.len();
        let Some(p) = (2..=n).find(|p| n.is_multiple_of(*p)) else { return x.to_vec() };
        let m = n / p;
        // Every p-th sample makes a transform of its own.
        let mut parts = Vec::with_capacity(p);
        for r in 0..p {
            let own: Vec<Complex> = x.iter().skip(r).step_by(p).copied().collect();
            parts.push(self.transform(&own, m));
        }
        let mut terms = Vec::with_capacity(wanted);
        for k in 0..wanted {
            let mut sum = parts[0][k % m];
            for (r, part) in parts.iter().enumerate().skip(1) {
                let turned = turned(self.graph, part[k % m], (r * k) % n, n);
                sum = [0, 1].map(|i| self.graph.add(sum[i], turned[i]));
            }
            terms.push(sum.map(|e| match self.graph.node(e) {
                Node::Const(_) | Node::Var(_) => e,
                _ => self.kept(e),
            }));
        }
        terms
    }
}

/// `x exp(-2 pi i k / n)`
fn turned(graph: &mut Graph, x: Complex, k: usize, n: usize) -> Complex {
    let angle = std::f64::consts::TAU * k as f64 / n as f64;
    let exact = |value: f64| if value.abs() < f64::EPSILON { 0.0 } else { value };
    let (c, s) = (graph.real(exact(angle.cos())), graph.real(exact(angle.sin())));
    let [a, b, d, e] = [(x[0], c), (x[1], s), (x[1], c), (x[0], s)].map(|(u, v)| graph.mul(u, v));
    [graph.add(a, b), graph.sub(d, e)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_the_sum_that_defines_it() {
        let mut graph = Graph::new();
        let n = 30;
        let x: Vec<f64> = (0..n).map(|k| ((k * k) as f64).sin() + 0.1 * k as f64).collect();
        let samples: Vec<Complex> = x.iter().map(|v| [graph.real(*v), graph.real(0.0)]).collect();
        let mut making = Making { graph: &mut graph, locals: Vec::new(), body: Vec::new() };
        let terms = making.transform(&samples, n);
        for (k, [re, im]) in terms.into_iter().enumerate() {
            let angle = |j: usize| -std::f64::consts::TAU * (j * k) as f64 / n as f64;
            let real: f64 = x.iter().enumerate().map(|(j, v)| v * angle(j).cos()).sum();
            let imaginary: f64 = x.iter().enumerate().map(|(j, v)| v * angle(j).sin()).sum();
            let value = |e: ExprId| graph.as_number(e).unwrap_or(f64::NAN);
            assert!((value(re) - real).abs() < 1e-12 * n as f64, "{k}");
            assert!((value(im) - imaginary).abs() < 1e-12 * n as f64, "{k}");
        }
    }
}
