//! What expressions were some time ago: `delay(e, T)` (section 3.7.4.2 of the specification).
//!
//! Each delayed expression has a history of points, made of pieces between its jumps. Inside of a
//! piece it is interpolated by polynomials of third degree through four points. A jump comes out a
//! time `T` after it went in, as an event known in advance; until that is handled, the piece before
//! it goes on, so that a step sees a smooth course to its end.

use crate::ir::program::{DelayCells, Layout, Slot};
use crate::numeric::polynomial_segment::{Extrapolation, PolynomialSegment, jumps};

/// The delays of one run.
#[derive(Clone, Default)]
pub struct Delayed {
    lines: Vec<Line>,
}

#[derive(Clone)]
struct Line {
    source: Slot,
    delay: Slot,
    moves: bool,
    /// Order of the derivative and its cell.
    cells: Vec<(u32, Slot)>,
    pieces: Vec<PolynomialSegment>,
    /// The piece that comes out now.
    current: usize,
}

impl Delayed {
    /// Histories that have not begun.
    pub fn new(layout: &Layout) -> Self {
        let line = |d: &DelayCells| Line {
            source: d.source,
            delay: d.delay,
            moves: d.moves,
            cells: layout
                .recorded
                .iter()
                .filter(|r| r.0 == d.variable)
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
            let before =
                line.pieces.first().and_then(PolynomialSegment::first).map(|(_, value)| value);
            changed |= before != Some(value);
            line.pieces = vec![PolynomialSegment::of(t, value)];
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
                memory[slot as usize] = piece.at(then, order, Extrapolation::Constant);
            }
        }
    }

    /// Adds a point to each history. What is noted at the other side of an event begins a new piece where
    /// it differs.
    pub fn note(&mut self, t: f64, memory: &[f64], after_event: bool) {
        for line in &mut self.lines {
            let value = memory[line.source as usize];
            let Some(piece) = line.pieces.last_mut() else { continue };
            match piece.last() {
                Some((last, old)) if after_event && jumps(old, value) => {
                    line.pieces.push(PolynomialSegment::of(last, value));
                }
                Some((last, _)) if last >= t => {}
                _ => piece.push_last(t, value),
            }
            line.forget(t - memory[line.delay as usize]);
        }
    }

    /// The next instant at which a jump comes out; infinity if none is under way.
    pub fn next_corner(&self, memory: &[f64]) -> f64 {
        let ends = self.lines.iter().filter(|l| l.current + 1 < l.pieces.len()).map(|l| {
            let end = l.pieces[l.current].last().map_or(f64::INFINITY, |(end, _)| end);
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
                && line.pieces[line.current].last().is_some_and(|(end, _)| end + delay <= t)
            {
                line.current += 1;
                any = true;
            }
        }
        any
    }

    /// True if something that is delayed moves between events.
    pub fn moves(&self) -> bool {
        self.lines.iter().any(|l| l.moves)
    }

    /// The shortest delay of what moves, s: no step may be longer, or it would need what is yet to come.
    pub fn shortest(&self, memory: &[f64]) -> f64 {
        let moving = self.lines.iter().filter(|l| l.moves);
        let positive = moving.map(|l| memory[l.delay as usize]).filter(|t| *t > 0.0);
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
        if piece.points() > KEPT {
            piece.discard_before(then);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::expr::VarId;

    #[test]
    fn a_jump_comes_out_later() {
        let layout = Layout {
            delays: vec![DelayCells { variable: VarId(0), source: 0, delay: 1, moves: true }],
            recorded: vec![(VarId(0), 0, 2)],
            ..Layout::default()
        };
        let mut memory = [1.0, 0.5, 0.0];
        let mut delayed = Delayed::new(&layout);
        assert!(delayed.begin(0.0, &memory));
        delayed.note(1.0, &memory, false);
        memory[0] = 3.0;
        delayed.note(1.0, &memory, true);
        delayed.note(2.0, &memory, false);
        assert_eq!(delayed.next_corner(&memory), 1.5);
        delayed.place(1.5, &mut memory);
        assert_eq!(memory[2], 1.0);
        assert!(delayed.pass(1.5, &memory));
        delayed.place(1.5, &mut memory);
        assert_eq!(memory[2], 3.0);
        assert_eq!(delayed.next_corner(&memory), f64::INFINITY);
    }
}
