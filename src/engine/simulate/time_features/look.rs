//! The search for extrema, zeros and jumps of expressions of time on a grid.

use crate::ir::program::{Instr, Program, Slot};
use crate::numeric::brent::maximum;
use crate::runtime::machine::compute;

use super::dependence::{Expressions, Watched, is_oscillation};

/// Accuracy of the location of an extremum, as a fraction of the run.
const LOCATION_TOLERANCE: f64 = 1e-12;
/// Distance of points, relative to the time, from which rates are those of the expressions: some thousand times the spacing
/// of doubles.
const RESOLVED: f64 = 1e-12;
/// Bisections that locate a jump to the spacing of doubles.
const BISECTIONS: u32 = 60;

/// A look over a part of a run.
pub struct Look<'p> {
    program: &'p Program,
    /// A copy of the machine's memory, whose parameters and held variables the expressions read.
    pub memory: Vec<f64>,
    /// Instructions that may still be executed.
    pub budget: f64,
    code: Vec<Instr>,
    watched: Vec<Watched>,
    /// For each instruction, the largest rate of its first operand, 1/s.
    rates: Vec<f64>,
    /// Instants of features, s, in no order.
    pub found: Vec<f64>,
}

impl<'p> Look<'p> {
    /// One that has not begun, at expressions of which some are watched.
    pub fn new(
        program: &'p Program,
        memory: Vec<f64>,
        expressions: &Expressions,
        watched: Vec<Watched>,
    ) -> Look<'p> {
        let code = expressions.code.clone();
        let rates = vec![0.0; code.len()];
        Look { program, memory, budget: f64::INFINITY, code, watched, rates, found: Vec::new() }
    }

    fn evaluate(&mut self, t: f64) {
        self.budget -= self.code.len() as f64;
        self.memory[self.program.layout.time as usize] = t;
        for i in &self.code {
            compute::<false>(&mut self.memory, i, self.program.externals());
        }
    }

    /// Looks over the time from `start` to `stop`, s, on a grid of so many intervals.
    pub fn scan(&mut self, start: f64, stop: f64, intervals: usize) {
        let width = self.watched.len();
        let at = |k: usize| start + (stop - start) * (k as f64 / intervals as f64);
        let spacing = (stop - start) / intervals as f64;
        // Between points that are too close, operands differ by rounding.
        let is_resolved = spacing > RESOLVED * start.abs().max(stop.abs());
        // The values at the last three points of the grid, the operands at the last, and their changes up to it.
        let mut rows = [vec![0.0; width], vec![0.0; width], vec![0.0; width]];
        let mut operands = vec![0.0; self.code.len()];
        let mut changes = vec![f64::INFINITY; self.code.len()];
        for k in 0..=intervals {
            self.evaluate(at(k));
            rows.rotate_left(1);
            for (value, w) in rows[2].iter_mut().zip(&self.watched) {
                *value = self.memory[w.slot as usize];
            }
            for (n, i) in self.code.iter().enumerate() {
                let operand = self.memory[i.a as usize];
                if k > 0 && is_resolved {
                    let change = (operand - operands[n]).abs();
                    // A jump changes an operand once: on a finer grid it would be faster without end.
                    if k > 1 || intervals == 1 {
                        self.rates[n] = self.rates[n].max(change.min(changes[n]) / spacing);
                    }
                    changes[n] = change;
                }
                operands[n] = operand;
            }
            for n in 0..width {
                let [a, b, c] = rows.each_ref().map(|row| row[n]);
                let w = self.watched[n];
                if k > 0 && ((w.jumps && b != c) || (w.crosses && b * c < 0.0)) {
                    self.bisect(w, at(k - 1), at(k), b);
                } else if k > 0 && w.crosses && c == 0.0 && b != 0.0 {
                    self.found.push(at(k));
                }
                if k > 1 && !w.jumps && (b - a) * (c - b) < 0.0 {
                    self.refine(w.slot, at(k - 2), at(k), b > a, stop - start);
                }
                if self.budget < 0.0 {
                    return;
                }
            }
        }
    }

    /// The largest rate of the argument of a sine or cosine that a slot of `counted` holds, 1/s; zero if there is none.
    pub fn fastest(&self, counted: &[bool]) -> f64 {
        let oscillations = self.code.iter().zip(&self.rates).filter(|(i, _)| {
            is_oscillation(i.op) && counted.get(i.dst as usize).is_some_and(|counts| *counts)
        });
        oscillations.map(|(_, rate)| *rate).fold(0.0, f64::max)
    }

    /// The instant at which a value departs from `before`, or its sign does.
    fn bisect(&mut self, w: Watched, mut low: f64, mut high: f64, before: f64) {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            self.evaluate(middle);
            let value = self.memory[w.slot as usize];
            let same = if w.jumps { value == before } else { value * before > 0.0 };
            if same { low = middle } else { high = middle }
        }
        self.found.push(high);
    }

    fn refine(&mut self, slot: Slot, low: f64, high: f64, is_maximum: bool, span: f64) {
        let sign = if is_maximum { 1.0 } else { -1.0 };
        let value = |t: f64| {
            self.evaluate(t);
            sign * self.memory[slot as usize]
        };
        let (t, _) = maximum(value, low, high, LOCATION_TOLERANCE * span);
        self.found.push(t);
    }
}
