//! Transport lines: `spatialDistribution` (Modelica specification 3.6, section 3.7.4.2), and
//! `delay` with a variable delay time, where the line coordinate is time itself.
//!
//! The transported profile is fixed to the line; the window of readable coordinates moves over it.
//! When an end of the window moves outwards, the inflow is appended there; when it moves inwards,
//! the values beyond it have left. The profile consists of segments between jumps; within a segment
//! values are interpolated by cubic polynomials. A reader stays on its segment until an event moves
//! it to the next one, so that a step sees a smooth signal up to its end.

use std::collections::VecDeque;

use crate::ir::expr::Carried;
use crate::ir::program::{Layout, TransportSlots};
use crate::numeric::polynomial_segment::{Extrapolation, PolynomialSegment, jumps};

/// Number of points of a segment beyond which unreadable ones are discarded.
const CAPACITY: usize = 4096;

/// Fraction of the line by which an end may move in one step.
const MAX_DISPLACEMENT: f64 = 0.1;

/// The transport lines of one run.
#[derive(Clone, Default)]
pub struct TransportLines {
    lines: Vec<Line>,
}

#[derive(Clone)]
struct Line {
    slots: TransportSlots,
    /// Segments from low to high; empty before initialization.
    segments: VecDeque<PolynomialSegment>,
    /// The ends of the window at the last recorded point.
    ends: [f64; 2],
    /// The values at the inlets of both ends at that time.
    inflow: [f64; 2],
    /// True if the end last moved outwards.
    is_inflow: [bool; 2],
    /// Time of the last recorded point, s.
    recorded_at: f64,
    /// The larger speed of the two ends, per s.
    speed: f64,
    /// The current segment of each reader.
    current: Vec<usize>,
}

impl TransportLines {
    /// Empty transport lines.
    pub fn new(layout: &Layout) -> Self {
        let line = |slots: &TransportSlots| Line {
            current: vec![0; slots.readers.len()],
            slots: slots.clone(),
            segments: VecDeque::new(),
            ends: [0.0; 2],
            inflow: [0.0; 2],
            is_inflow: [false; 2],
            recorded_at: 0.0,
            speed: 0.0,
        };
        TransportLines { lines: layout.transports.iter().map(line).collect() }
    }

    /// True if the model has no transport lines.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Restarts all lines with the current values; true if a profile has changed.
    pub fn begin(&mut self, t: f64, memory: &mut [f64]) -> bool {
        let mut changed = false;
        for line in &mut self.lines {
            let before = std::mem::take(&mut line.segments);
            line.begin(t, memory);
            let same = |(a, b): (&PolynomialSegment, &PolynomialSegment)| {
                a.first() == b.first() && a.last() == b.last()
            };
            changed |=
                before.len() != line.segments.len() || !before.iter().zip(&line.segments).all(same);
            line.write_slots(memory);
        }
        changed
    }

    /// Writes the ends of the current segments, which relations monitor.
    #[inline]
    pub fn write_slots(&self, memory: &mut [f64]) {
        self.lines.iter().for_each(|line| line.write_slots(memory));
    }

    /// The value of a line at a coordinate, or its derivative with respect to the coordinate.
    #[inline]
    pub fn read(&self, what: Carried, place: f64) -> f64 {
        let line = &self.lines[usize::from(what.line)];
        let k = line.current[usize::from(what.reader)];
        let Some(segment) = line.segments.get(k) else { return 0.0 };
        let outermost = (k == 0 && line.slots.entering[0].is_some() && place < line.ends[0])
            || (k + 1 == line.segments.len() && place > line.ends[1]);
        let beyond = if outermost { Extrapolation::Linear } else { Extrapolation::Constant };
        segment.at(place, u32::from(what.order), beyond)
    }

    /// Records a point of a step; called in ascending order of `t`. A value that differs after an
    /// event starts a new segment.
    pub fn record(&mut self, t: f64, memory: &[f64], after_event: bool) {
        for line in &mut self.lines {
            line.record(t, memory, after_event);
        }
    }

    /// Moves readers to the segments they have reached; true if any reader moved.
    pub fn advance_past(&mut self, memory: &mut [f64]) -> bool {
        let mut any = false;
        for line in &mut self.lines {
            for (reader, current) in line.slots.readers.iter().zip(&mut line.current) {
                let at = memory[reader.place as usize];
                let passed = segment_at(&line.segments, *current, at);
                any |= passed != *current;
                *current = passed;
            }
            line.write_slots(memory);
        }
        any
    }

    /// The maximum step, s, that reads no values that are not yet computed.
    pub fn max_step(&self, memory: &[f64]) -> f64 {
        self.lines.iter().map(|l| l.max_step(memory)).fold(f64::INFINITY, f64::min)
    }
}

/// The segment at a coordinate, searched from `current`. At a boundary the upper segment applies,
/// consistent with the relations that monitor it.
fn segment_at(segments: &VecDeque<PolynomialSegment>, mut current: usize, at: f64) -> usize {
    while current + 1 < segments.len() && segments[current].last().is_some_and(|(end, _)| at >= end)
    {
        current += 1;
    }
    while current > 0 && segments[current].first().is_some_and(|(begin, _)| at < begin) {
        current -= 1;
    }
    current
}

impl Line {
    fn ends(&self, memory: &[f64]) -> [f64; 2] {
        self.slots.ends.map(|slot| memory[slot as usize])
    }

    fn inflow(&self, memory: &[f64]) -> [f64; 2] {
        self.slots.entering.map(|slot| slot.map_or(0.0, |slot| memory[slot as usize]))
    }

    fn begin(&mut self, t: f64, memory: &[f64]) {
        self.ends = self.ends(memory);
        self.inflow = self.inflow(memory);
        (self.is_inflow, self.recorded_at, self.speed) = ([false; 2], t, 0.0);
        for pair in self.slots.initial.windows(2) {
            let [(p, a), (q, b)] = [pair[0], pair[1]].map(|(place, value)| {
                (self.ends[0] + memory[place as usize], memory[value as usize])
            });
            if p < q {
                let mut segment = PolynomialSegment::of(p, a);
                segment.push_last(q, b);
                self.segments.push_back(segment);
            }
        }
        if self.segments.is_empty() {
            self.segments.push_back(PolynomialSegment::of(self.ends[1], self.inflow[1]));
        }
        for (reader, current) in self.slots.readers.iter().zip(&mut self.current) {
            *current = segment_at(&self.segments, 0, memory[reader.place as usize]);
        }
    }

    fn record(&mut self, t: f64, memory: &[f64], after_event: bool) {
        if self.segments.is_empty() {
            return;
        }
        let now = self.ends(memory);
        if t > self.recorded_at {
            let moved = (now[0] - self.ends[0]).abs().max((now[1] - self.ends[1]).abs());
            self.speed = moved / (t - self.recorded_at);
        }
        let inflow = self.inflow(memory);
        let outwards = [self.ends[0] - now[0], now[1] - self.ends[1]];
        for end in 0..2 {
            let opens = self.slots.entering[end].is_some();
            if opens && outwards[end] > 0.0 && !self.is_inflow[end] {
                // Flow reversal: the outflow has left, and the inflow starts at the old end. Even
                // if it starts with the same value, its slope differs.
                self.cut(end);
                self.begin_segment(end, self.inflow[end], memory);
            }
            if outwards[end] != 0.0 {
                self.is_inflow[end] = opens && outwards[end] > 0.0;
            }
            let other = jumps(self.inflow[end], inflow[end]);
            match self.is_inflow[end] {
                true if other && (after_event || outwards[end] == 0.0) => {
                    self.begin_segment(end, inflow[end], memory);
                }
                true if outwards[end] > 0.0 => self.extend(end, now[end], inflow[end]),
                true => {}
                false => self.leave(end, now[end]),
            }
        }
        (self.ends, self.inflow, self.recorded_at) = (now, inflow, t);
    }

    /// Starts a new segment of the inflow at an end.
    fn begin_segment(&mut self, end: usize, value: f64, memory: &[f64]) {
        let outermost = if end == 1 { self.segments.back() } else { self.segments.front() };
        let Some(segment) = outermost else { return };
        let Some((place, _)) = (if end == 1 { segment.last() } else { segment.first() }) else {
            return;
        };
        // A single point has not entered the line yet.
        let is_pending = segment.points() == 1 && self.segments.len() > 1;
        if end == 1 {
            if is_pending {
                self.segments.pop_back();
            }
            self.segments.push_back(PolynomialSegment::of(place, value));
            return;
        }
        if is_pending {
            self.segments.pop_front();
        } else {
            self.current.iter_mut().for_each(|c| *c += 1);
        }
        self.segments.push_front(PolynomialSegment::of(place, value));
        // Readers at the end itself read the inflow.
        for (reader, current) in self.slots.readers.iter().zip(&mut self.current) {
            if memory[reader.place as usize] <= place {
                *current = 0;
            }
        }
    }

    /// Extends the inflow up to the new position of an end.
    fn extend(&mut self, end: usize, at: f64, value: f64) {
        if end == 1 {
            self.segments.back_mut().into_iter().for_each(|p| p.push_last(at, value));
        } else {
            self.segments.front_mut().into_iter().for_each(|p| p.push_first(at, value));
        }
    }

    /// True if the outermost segment lies beyond an end.
    fn has_left(&self, end: usize, at: f64) -> bool {
        self.segments.len() > 1
            && if end == 1 {
                self.segments
                    .back()
                    .and_then(PolynomialSegment::first)
                    .is_some_and(|(begin, _)| begin > at)
            } else {
                self.segments
                    .front()
                    .and_then(PolynomialSegment::last)
                    .is_some_and(|(last, _)| last < at)
            }
    }

    /// Drops segments beyond an end, unless readers are still on them.
    fn leave(&mut self, end: usize, at: f64) {
        let outermost = |line: &Line| if end == 1 { line.segments.len() - 1 } else { 0 };
        while self.has_left(end, at) && !self.current.contains(&outermost(self)) {
            self.drop_outermost(end);
        }
        let segment = if end == 1 { self.segments.back_mut() } else { self.segments.front_mut() };
        if let Some(segment) = segment.filter(|p| p.points() > CAPACITY) {
            if end == 1 { segment.discard_after(at) } else { segment.discard_before(at) }
        }
    }

    /// Cuts the profile at an end.
    fn cut(&mut self, end: usize) {
        let at = self.ends[end];
        while self.has_left(end, at) {
            self.drop_outermost(end);
        }
        let segment = if end == 1 { self.segments.back_mut() } else { self.segments.front_mut() };
        if let Some(segment) = segment {
            if end == 1 { segment.cut_after(at) } else { segment.cut_before(at) }
        }
    }

    fn drop_outermost(&mut self, end: usize) {
        if end == 1 {
            self.segments.pop_back();
            let last = self.segments.len() - 1;
            self.current.iter_mut().for_each(|c| *c = (*c).min(last));
        } else {
            self.segments.pop_front();
            self.current.iter_mut().for_each(|c| *c = c.saturating_sub(1));
        }
    }

    fn write_slots(&self, memory: &mut [f64]) {
        let last = self.segments.len().saturating_sub(1);
        for (reader, &current) in self.slots.readers.iter().zip(&self.current) {
            let segment = self.segments.get(current);
            let from = segment.and_then(PolynomialSegment::first).filter(|_| current > 0);
            let to = segment.and_then(PolynomialSegment::last).filter(|_| current < last);
            memory[reader.from as usize] = from.map_or(-f64::MAX, |(begin, _)| begin);
            memory[reader.to as usize] = to.map_or(f64::MAX, |(end, _)| end);
        }
    }

    fn max_step(&self, memory: &[f64]) -> f64 {
        let [low, high] = self.ends(memory);
        if self.slots.entering[0].is_some() {
            return if self.speed > 0.0 {
                MAX_DISPLACEMENT * (high - low) / self.speed
            } else {
                f64::INFINITY
            };
        }
        // The line coordinate is time: a step may be as long as the shortest delay.
        let behind = self.slots.readers.iter().map(|r| high - memory[r.place as usize]);
        behind.fold(f64::INFINITY, f64::min)
    }
}

crate::base::wire::wire_struct!(Line {
    slots,
    segments,
    ends,
    inflow,
    is_inflow,
    recorded_at,
    speed,
    current
});
crate::base::wire::wire_struct!(TransportLines { lines });
