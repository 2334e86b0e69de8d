//! What expressions were some time ago: `delay(e, T)` (section 3.7.4.2 of the specification).
//!
//! Each delayed expression has a history of points, made of pieces between its jumps. Inside of a
//! piece it is interpolated by polynomials of third degree through four points. A jump comes out a
//! time `T` after it went in, as an event known in advance; until that is handled, the piece before
//! it goes on, so that a step sees a smooth course to its end.

use crate::ir::program::{Layout, Slot};

/// The delays of one run.
#[derive(Clone, Default)]
pub struct Delayed {
    lines: Vec<Line>,
}

#[derive(Clone)]
struct Line {
    source: Slot,
    delay: Slot,
    /// Order of the derivative and its cell.
    cells: Vec<(u32, Slot)>,
    pieces: Vec<Piece>,
    /// The piece that comes out now.
    current: usize,
}

#[derive(Clone, Default)]
struct Piece {
    t: Vec<f64>,
    value: Vec<f64>,
}

impl Delayed {
    /// Histories that have not begun.
    pub fn new(layout: &Layout) -> Self {
        let line = |&(v, source, delay): &(crate::ir::expr::VarId, Slot, Slot)| Line {
            source,
            delay,
            cells: layout
                .recorded
                .iter()
                .filter(|r| r.0 == v)
                .map(|(_, order, slot)| (*order, *slot))
                .collect(),
            pieces: Vec::new(),
            current: 0,
        };
        Delayed { lines: layout.delays.iter().map(line).collect() }
    }

    /// True without any.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Begins all histories anew with what stands in the memory; true if a first value is another
    /// one than before.
    pub fn begin(&mut self, t: f64, memory: &[f64]) -> bool {
        let mut changed = false;
        for line in &mut self.lines {
            let value = memory[line.source as usize];
            let before = line.pieces.first().map(|p| p.value[0]);
            changed |= before != Some(value);
            line.pieces = vec![Piece { t: vec![t], value: vec![value] }];
            line.current = 0;
        }
        changed
    }

    /// Writes what comes out at `t`.
    #[inline]
    pub fn place(&self, t: f64, memory: &mut [f64]) {
        for line in &self.lines {
            let Some(piece) = line.pieces.get(line.current) else { continue };
            let then = t - memory[line.delay as usize].max(0.0);
            for &(order, slot) in &line.cells {
                memory[slot as usize] = piece.at(then, order);
            }
        }
    }

    /// Adds a point to each history. A value at the instant of the last point is the other side of an
    /// event: where it differs, a new piece begins.
    pub fn note(&mut self, t: f64, memory: &[f64]) {
        for line in &mut self.lines {
            let value = memory[line.source as usize];
            let Some(piece) = line.pieces.last_mut() else { continue };
            match (piece.t.last(), piece.value.last()) {
                (Some(last), Some(old)) if *last == t => {
                    if *old != value {
                        line.pieces.push(Piece { t: vec![t], value: vec![value] });
                    }
                }
                (Some(last), _) if *last > t => {}
                _ => {
                    piece.t.push(t);
                    piece.value.push(value);
                }
            }
            line.forget(t - memory[line.delay as usize]);
        }
    }

    /// The next instant at which a jump comes out; infinity if none is under way.
    pub fn next_corner(&self, memory: &[f64]) -> f64 {
        let ends = self.lines.iter().filter(|l| l.current + 1 < l.pieces.len()).map(|l| {
            let end = l.pieces[l.current].t.last().copied().unwrap_or(f64::INFINITY);
            end + memory[l.delay as usize].max(0.0)
        });
        ends.fold(f64::INFINITY, f64::min)
    }

    /// Lets the jumps up to `t` come out; true if there is any.
    pub fn pass(&mut self, t: f64, memory: &[f64]) -> bool {
        let mut any = false;
        for line in &mut self.lines {
            let delay = memory[line.delay as usize].max(0.0);
            while line.current + 1 < line.pieces.len()
                && line.pieces[line.current].t.last().is_some_and(|end| end + delay <= t)
            {
                line.current += 1;
                any = true;
            }
        }
        any
    }

    /// The shortest delay, s: no step may be longer, or it would need what is yet to come.
    pub fn shortest(&self, memory: &[f64]) -> f64 {
        let positive = self.lines.iter().map(|l| memory[l.delay as usize]).filter(|t| *t > 0.0);
        positive.fold(f64::INFINITY, f64::min)
    }
}

impl Line {
    /// Drops what can not come out any more.
    fn forget(&mut self, then: f64) {
        const KEPT: usize = 4096;
        if self.current > KEPT {
            self.pieces.drain(..self.current);
            self.current = 0;
        }
        let piece = &mut self.pieces[self.current];
        if piece.t.len() > KEPT {
            let passed = piece.t.partition_point(|t| *t < then).saturating_sub(4);
            if passed > KEPT / 2 {
                piece.t.drain(..passed);
                piece.value.drain(..passed);
            }
        }
    }
}

impl Piece {
    /// The value, or its first derivative; beyond the ends the piece rests.
    fn at(&self, t: f64, order: u32) -> f64 {
        let n = self.t.len();
        let (first, last) = (self.t[0], self.t[n - 1]);
        if n == 1 || t <= first || t >= last {
            let end = if t <= first { self.value[0] } else { self.value[n - 1] };
            return if order == 0 { end } else { 0.0 };
        }
        let after = self.t.partition_point(|x| *x <= t);
        let from = after.saturating_sub(2).min(n.saturating_sub(4));
        let to = (from + 4).min(n);
        match order {
            0 => lagrange(&self.t[from..to], &self.value[from..to], t),
            1 => slope(&self.t[from..to], &self.value[from..to], t),
            _ => 0.0,
        }
    }
}

fn lagrange(x: &[f64], y: &[f64], t: f64) -> f64 {
    let weight = |i: usize| -> f64 {
        (0..x.len()).filter(|j| *j != i).map(|j| (t - x[j]) / (x[i] - x[j])).product()
    };
    (0..x.len()).map(|i| y[i] * weight(i)).sum()
}

fn slope(x: &[f64], y: &[f64], t: f64) -> f64 {
    let n = x.len();
    let mut sum = 0.0;
    for i in 0..n {
        for k in (0..n).filter(|k| *k != i) {
            let rest: f64 = (0..n)
                .filter(|j| *j != i && *j != k)
                .map(|j| (t - x[j]) / (x[i] - x[j]))
                .product();
            sum += y[i] * rest / (x[i] - x[k]);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_met_with_its_slope() {
        let t: Vec<f64> = [0.0, 0.3, 0.7, 1.2, 1.5, 2.1].to_vec();
        let f = |t: f64| 1.0 + t * (2.0 - t * (0.5 + t));
        let piece = Piece { value: t.iter().map(|t| f(*t)).collect(), t };
        for u in [0.1, 0.5, 1.3, 2.0] {
            assert!((piece.at(u, 0) - f(u)).abs() < 1e-13);
            assert!((piece.at(u, 1) - (2.0 - u - 3.0 * u * u)).abs() < 1e-12);
        }
        assert_eq!((piece.at(-1.0, 0), piece.at(3.0, 0)), (f(0.0), f(2.1)));
    }

    #[test]
    fn a_jump_comes_out_later() {
        let layout = Layout {
            delays: vec![(crate::ir::expr::VarId(0), 0, 1)],
            recorded: vec![(crate::ir::expr::VarId(0), 0, 2)],
            ..Layout::default()
        };
        let mut memory = [1.0, 0.5, 0.0];
        let mut delayed = Delayed::new(&layout);
        assert!(delayed.begin(0.0, &memory));
        delayed.note(1.0, &memory);
        memory[0] = 3.0;
        delayed.note(1.0, &memory);
        delayed.note(2.0, &memory);
        assert_eq!(delayed.next_corner(&memory), 1.5);
        delayed.place(1.5, &mut memory);
        assert_eq!(memory[2], 1.0);
        assert!(delayed.pass(1.5, &memory));
        delayed.place(1.5, &mut memory);
        assert_eq!(memory[2], 3.0);
        assert_eq!(delayed.next_corner(&memory), f64::INFINITY);
    }
}
