//! What is carried along a line and read where it has got to: `spatialDistribution` (section 3.7.4.2 of
//! the specification), and `delay` by a time that changes, where time itself is the line.
//!
//! What is carried keeps its place on the line; the ends of what can be read move over it. Where an end
//! moves outwards what enters there is written, where it moves inwards what stood there has left. The
//! values stand in pieces between jumps, inside of which they are interpolated by polynomials of third
//! degree. A reader reads its piece until an event says that it has come to the end of that: a step sees
//! a smooth course to its end.

use std::collections::VecDeque;

use crate::ir::expr::Carried;
use crate::ir::program::{Layout, TransportCells};
use crate::numeric::polynomial_segment::{Extrapolation, PolynomialSegment, jumps};

/// Points that are kept beyond what can be read before they are thrown away.
const KEPT: usize = 4096;

/// Part of a line by which an end may move in one step.
const REACH: f64 = 0.1;

/// The lines of one run.
#[derive(Clone, Default)]
pub struct Transports {
    lines: Vec<Line>,
}

#[derive(Clone)]
struct Line {
    cells: TransportCells,
    /// From low to high; none before the line begins.
    pieces: VecDeque<PolynomialSegment>,
    /// The ends of what can be read, when points were noted last.
    ends: [f64; 2],
    /// What stood ready to enter there then.
    ready: [f64; 2],
    /// Whether the end moved outwards when it moved last.
    enters: [bool; 2],
    /// When points were noted last.
    noted: f64,
    /// How fast the ends move at most, per s.
    speed: f64,
    /// By reader the piece that it reads.
    current: Vec<usize>,
}

impl Transports {
    /// Lines that have not begun.
    pub fn new(layout: &Layout) -> Self {
        let line = |cells: &TransportCells| Line {
            current: vec![0; cells.readers.len()],
            cells: cells.clone(),
            pieces: VecDeque::new(),
            ends: [0.0; 2],
            ready: [0.0; 2],
            enters: [false; 2],
            noted: 0.0,
            speed: 0.0,
        };
        Transports { lines: layout.transports.iter().map(line).collect() }
    }

    /// True without any.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Begins all lines anew with what stands in the memory; true if that is something else than before.
    pub fn begin(&mut self, t: f64, memory: &mut [f64]) -> bool {
        let mut changed = false;
        for line in &mut self.lines {
            let before = std::mem::take(&mut line.pieces);
            line.begin(t, memory);
            let same = |(a, b): (&PolynomialSegment, &PolynomialSegment)| {
                a.first() == b.first() && a.last() == b.last()
            };
            changed |=
                before.len() != line.pieces.len() || !before.iter().zip(&line.pieces).all(same);
            line.place(memory);
        }
        changed
    }

    /// Writes the borders of the pieces that are read, which relations watch.
    #[inline]
    pub fn place(&self, memory: &mut [f64]) {
        self.lines.iter().for_each(|line| line.place(memory));
    }

    /// What a reader reads at a place of its line, or the derivative by the place.
    #[inline]
    pub fn read(&self, what: Carried, place: f64) -> f64 {
        let line = &self.lines[usize::from(what.line)];
        let k = line.current[usize::from(what.reader)];
        let Some(piece) = line.pieces.get(k) else { return 0.0 };
        let outermost = (k == 0 && line.cells.entering[0].is_some() && place < line.ends[0])
            || (k + 1 == line.pieces.len() && place > line.ends[1]);
        let beyond = if outermost { Extrapolation::Linear } else { Extrapolation::Constant };
        piece.at(place, u32::from(what.order), beyond)
    }

    /// Takes note of the course of a step, in ascending order of `t`. What is noted at the other side of an
    /// event begins a new piece where it differs.
    pub fn note(&mut self, t: f64, memory: &[f64], after_event: bool) {
        for line in &mut self.lines {
            line.note(t, memory, after_event);
        }
    }

    /// Lets readers go on to the pieces at which they have arrived; true if there is any.
    pub fn pass(&mut self, memory: &mut [f64]) -> bool {
        let mut any = false;
        for line in &mut self.lines {
            for (reader, current) in line.cells.readers.iter().zip(&mut line.current) {
                let at = memory[reader.place as usize];
                let passed = arrive(&line.pieces, *current, at);
                any |= passed != *current;
                *current = passed;
            }
            line.place(memory);
        }
        any
    }

    /// How long a step may be at most so that nothing is read that is yet to come, s.
    pub fn leash(&self, memory: &[f64]) -> f64 {
        self.lines.iter().map(|l| l.leash(memory)).fold(f64::INFINITY, f64::min)
    }
}

/// The piece that is read at a place, beginning from one: a reader on a border stays where it is going up,
/// and goes on where it is going down, as the relations say that watch for it.
fn arrive(pieces: &VecDeque<PolynomialSegment>, mut current: usize, at: f64) -> usize {
    while current + 1 < pieces.len() && pieces[current].last().is_some_and(|(end, _)| at >= end) {
        current += 1;
    }
    while current > 0 && pieces[current].first().is_some_and(|(begin, _)| at < begin) {
        current -= 1;
    }
    current
}

impl Line {
    fn ends(&self, memory: &[f64]) -> [f64; 2] {
        self.cells.ends.map(|slot| memory[slot as usize])
    }

    fn ready(&self, memory: &[f64]) -> [f64; 2] {
        self.cells.entering.map(|slot| slot.map_or(0.0, |slot| memory[slot as usize]))
    }

    fn begin(&mut self, t: f64, memory: &[f64]) {
        self.ends = self.ends(memory);
        self.ready = self.ready(memory);
        (self.enters, self.noted, self.speed) = ([false; 2], t, 0.0);
        for pair in self.cells.initial.windows(2) {
            let [(p, a), (q, b)] = [pair[0], pair[1]].map(|(place, value)| {
                (self.ends[0] + memory[place as usize], memory[value as usize])
            });
            if p < q {
                let mut piece = PolynomialSegment::of(p, a);
                piece.push_last(q, b);
                self.pieces.push_back(piece);
            }
        }
        if self.pieces.is_empty() {
            self.pieces.push_back(PolynomialSegment::of(self.ends[1], self.ready[1]));
        }
        for (reader, current) in self.cells.readers.iter().zip(&mut self.current) {
            *current = arrive(&self.pieces, 0, memory[reader.place as usize]);
        }
    }

    fn note(&mut self, t: f64, memory: &[f64], after_event: bool) {
        if self.pieces.is_empty() {
            return;
        }
        let now = self.ends(memory);
        if t > self.noted {
            let moved = (now[0] - self.ends[0]).abs().max((now[1] - self.ends[1]).abs());
            self.speed = moved / (t - self.noted);
        }
        let ready = self.ready(memory);
        let outwards = [self.ends[0] - now[0], now[1] - self.ends[1]];
        for end in 0..2 {
            let opens = self.cells.entering[end].is_some();
            if opens && outwards[end] > 0.0 && !self.enters[end] {
                // It turns: what has left is gone, and what stood ready begins where the end stood. Even
                // if it begins with the same value, it goes on along another course.
                self.cut(end);
                self.begin_piece(end, self.ready[end], memory);
            }
            if outwards[end] != 0.0 {
                self.enters[end] = opens && outwards[end] > 0.0;
            }
            let other = jumps(self.ready[end], ready[end]);
            match self.enters[end] {
                true if other && (after_event || outwards[end] == 0.0) => {
                    self.begin_piece(end, ready[end], memory);
                }
                true if outwards[end] > 0.0 => self.go_on(end, now[end], ready[end]),
                true => {}
                false => self.leave(end, now[end]),
            }
        }
        (self.ends, self.ready, self.noted) = (now, ready, t);
    }

    /// What enters at an end begins a new piece there.
    fn begin_piece(&mut self, end: usize, value: f64, memory: &[f64]) {
        let outermost = if end == 1 { self.pieces.back() } else { self.pieces.front() };
        let Some(piece) = outermost else { return };
        let Some((place, _)) = (if end == 1 { piece.last() } else { piece.first() }) else {
            return;
        };
        // What only waited has not entered.
        let waited = piece.points() == 1 && self.pieces.len() > 1;
        if end == 1 {
            if waited {
                self.pieces.pop_back();
            }
            self.pieces.push_back(PolynomialSegment::of(place, value));
            return;
        }
        if waited {
            self.pieces.pop_front();
        } else {
            self.current.iter_mut().for_each(|c| *c += 1);
        }
        self.pieces.push_front(PolynomialSegment::of(place, value));
        // Whoever reads at the end itself reads what enters there.
        for (reader, current) in self.cells.readers.iter().zip(&mut self.current) {
            if memory[reader.place as usize] <= place {
                *current = 0;
            }
        }
    }

    /// What enters goes on where an end has moved to.
    fn go_on(&mut self, end: usize, at: f64, value: f64) {
        if end == 1 {
            self.pieces.back_mut().into_iter().for_each(|p| p.push_last(at, value));
        } else {
            self.pieces.front_mut().into_iter().for_each(|p| p.push_first(at, value));
        }
    }

    /// True if the outermost piece lies beyond an end.
    fn has_left(&self, end: usize, at: f64) -> bool {
        self.pieces.len() > 1
            && if end == 1 {
                self.pieces
                    .back()
                    .and_then(PolynomialSegment::first)
                    .is_some_and(|(begin, _)| begin > at)
            } else {
                self.pieces
                    .front()
                    .and_then(PolynomialSegment::last)
                    .is_some_and(|(last, _)| last < at)
            }
    }

    /// What stands beyond an end has left, but for what readers are still at.
    fn leave(&mut self, end: usize, at: f64) {
        let outermost = |line: &Line| if end == 1 { line.pieces.len() - 1 } else { 0 };
        while self.has_left(end, at) && !self.current.contains(&outermost(self)) {
            self.drop_outermost(end);
        }
        let piece = if end == 1 { self.pieces.back_mut() } else { self.pieces.front_mut() };
        if let Some(piece) = piece.filter(|p| p.points() > KEPT) {
            if end == 1 { piece.discard_after(at) } else { piece.discard_before(at) }
        }
    }

    /// What stands beyond an end goes.
    fn cut(&mut self, end: usize) {
        let at = self.ends[end];
        while self.has_left(end, at) {
            self.drop_outermost(end);
        }
        let piece = if end == 1 { self.pieces.back_mut() } else { self.pieces.front_mut() };
        if let Some(piece) = piece {
            if end == 1 { piece.cut_after(at) } else { piece.cut_before(at) }
        }
    }

    fn drop_outermost(&mut self, end: usize) {
        if end == 1 {
            self.pieces.pop_back();
            let last = self.pieces.len() - 1;
            self.current.iter_mut().for_each(|c| *c = (*c).min(last));
        } else {
            self.pieces.pop_front();
            self.current.iter_mut().for_each(|c| *c = c.saturating_sub(1));
        }
    }

    fn place(&self, memory: &mut [f64]) {
        let last = self.pieces.len().saturating_sub(1);
        for (reader, &current) in self.cells.readers.iter().zip(&self.current) {
            let piece = self.pieces.get(current);
            let from = piece.and_then(PolynomialSegment::first).filter(|_| current > 0);
            let to = piece.and_then(PolynomialSegment::last).filter(|_| current < last);
            memory[reader.from as usize] = from.map_or(-f64::MAX, |(begin, _)| begin);
            memory[reader.to as usize] = to.map_or(f64::MAX, |(end, _)| end);
        }
    }

    fn leash(&self, memory: &[f64]) -> f64 {
        let [low, high] = self.ends(memory);
        if self.cells.entering[0].is_some() {
            return if self.speed > 0.0 {
                REACH * (high - low) / self.speed
            } else {
                f64::INFINITY
            };
        }
        // Time is the line: what a reader has behind it is as long as it lasts.
        let behind = self.cells.readers.iter().map(|r| high - memory[r.place as usize]);
        behind.fold(f64::INFINITY, f64::min)
    }
}
