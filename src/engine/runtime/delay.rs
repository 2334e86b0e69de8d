//! Histories of delayed expressions: `delay(e, T)` (Modelica specification 3.6, section 3.7.4.1).
//!
//! A history is a sequence of segments between jumps. Within a segment values are interpolated by
//! cubic polynomials through four points. A jump appears at the output a time `T` after it
//! occurred, as a time event. Until that event is handled, the segment before it is extrapolated,
//! so that a step sees a smooth signal up to its end.

use crate::ir::expr::VarId;
use crate::ir::program::{DelaySlots, Layout, Slot};
use crate::numeric::polynomial_segment::{Extrapolation, PolynomialSegment, jumps};

/// The delay buffers of one run.
#[derive(Clone, Default)]
pub struct DelayBuffers {
    lines: Vec<Line>,
}

#[derive(Clone)]
struct Line {
    variable: VarId,
    input: Option<VarId>,
    source: Slot,
    delay: Slot,
    moves: bool,
    /// Order of the derivative and its slot.
    slots: Vec<(u32, Slot)>,
    segments: Vec<PolynomialSegment>,
    /// The segment at the output.
    current: usize,
    /// The values that it has started with since the last extrapolation.
    starts: Vec<f64>,
}

impl DelayBuffers {
    /// Empty histories.
    pub fn new(layout: &Layout) -> Self {
        let line = |d: &DelaySlots| Line {
            variable: d.variable,
            input: d.input,
            source: d.source,
            delay: d.delay,
            moves: d.moves,
            slots: layout
                .signals
                .iter()
                .filter(|r| r.0 == d.variable)
                .map(|(_, order, slot)| (*order, *slot))
                .collect(),
            segments: Vec::new(),
            current: 0,
            starts: Vec::new(),
        };
        DelayBuffers { lines: layout.delays.iter().map(line).collect() }
    }

    /// Leaves the delays of driven inputs to [`InputSignals`](super::input_signals::InputSignals), which know their past.
    pub fn leave_inputs(&mut self, is_driven: impl Fn(VarId) -> bool) {
        self.lines.retain(|line| !line.input.is_some_and(&is_driven));
    }

    /// Number of delays.
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// True if the model has no delays.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Restarts all histories with the current values; the first variable of which this value is new. A delayed value may
    /// depend on itself, so this is repeated until none is.
    pub fn begin(&mut self, t: f64, memory: &[f64]) -> Option<VarId> {
        let mut changed = None;
        for line in &mut self.lines {
            let mut value = memory[line.source as usize];
            let before = line.segments.first().and_then(PolynomialSegment::first);
            if !before.is_some_and(|(_, before)| is_settled(before, value)) {
                changed = changed.or(Some(line.variable));
                value = line.next_start(value);
            }
            line.segments = vec![PolynomialSegment::of(t, value)];
            line.current = 0;
        }
        changed
    }

    /// Writes the delayed values at `t`.
    #[inline]
    pub fn write_slots(&self, t: f64, memory: &mut [f64]) {
        for line in &self.lines {
            let Some(segment) = line.segments.get(line.current) else { continue };
            let then = t - memory[line.delay as usize].max(0.0);
            for &(order, slot) in &line.slots {
                memory[slot as usize] = segment.at(then, order, Extrapolation::Constant);
            }
        }
    }

    /// The delayed expressions as they are now.
    pub fn sources<'m>(&'m self, memory: &'m [f64]) -> impl Iterator<Item = f64> + 'm {
        self.lines.iter().map(|line| memory[line.source as usize])
    }

    /// Adds a point to each history. A value that differs after an event starts a new segment, and any event may be a
    /// corner. Values at the output from the instant `needed` on may still be asked for.
    pub fn record(&mut self, t: f64, memory: &[f64], after_event: bool, needed: f64) {
        for line in &mut self.lines {
            let value = memory[line.source as usize];
            line.add(t, value, after_event, needed - memory[line.delay as usize]);
        }
    }

    /// Adds a point with these values, in the order of [`DelayBuffers::sources`], to each history.
    pub fn record_values(&mut self, t: f64, values: &[f64], memory: &[f64], needed: f64) {
        for (line, value) in self.lines.iter_mut().zip(values) {
            line.add(t, *value, false, needed - memory[line.delay as usize]);
        }
    }

    /// The values that were recorded last.
    pub fn last_values(&self) -> impl Iterator<Item = f64> + '_ {
        let last = |line: &Line| line.segments.last().and_then(PolynomialSegment::last);
        self.lines.iter().map(move |line| last(line).map_or(0.0, |(_, value)| value))
    }

    /// The next instant at which a jump reaches the output; infinity if there is none.
    pub fn next_breakpoint(&self, memory: &[f64]) -> f64 {
        let ends = self.lines.iter().filter(|l| l.current + 1 < l.segments.len()).map(|l| {
            let end = l.segments[l.current].last().map_or(f64::INFINITY, |(end, _)| end);
            end + memory[l.delay as usize].max(0.0)
        });
        ends.fold(f64::INFINITY, f64::min)
    }

    /// Advances the outputs past the jumps up to `t`; true if there are any.
    pub fn advance_past(&mut self, t: f64, memory: &[f64]) -> bool {
        let mut any = false;
        for line in &mut self.lines {
            let delay = memory[line.delay as usize].max(0.0);
            while line.current + 1 < line.segments.len()
                && line.segments[line.current].last().is_some_and(|(end, _)| end + delay <= t)
            {
                line.current += 1;
                any = true;
            }
        }
        any
    }

    /// True if a delayed variable varies between events.
    pub fn moves(&self) -> bool {
        self.lines.iter().any(|l| l.moves)
    }

    /// The shortest delay of a continuously varying variable, s. A longer step would need values
    /// that are not yet computed.
    pub fn shortest_delay(&self, memory: &[f64]) -> f64 {
        let moving = self.lines.iter().filter(|l| l.moves);
        let positive = moving.map(|l| memory[l.delay as usize]).filter(|t| *t > 0.0);
        positive.fold(f64::INFINITY, f64::min)
    }
}

/// True if a start has changed by rounding errors only.
fn is_settled(before: f64, value: f64) -> bool {
    const RELATIVE: f64 = 1e-10;
    const ABSOLUTE: f64 = 1e-12;
    (value - before).abs() <= RELATIVE * value.abs().max(before.abs()) + ABSOLUTE
}

impl Line {
    /// The start after one that led to this value: of a sequence of three, the limit that it would have if its differences
    /// were a geometric sequence (Aitken 1926), as those of a linear equation are, also where they grow.
    fn next_start(&mut self, value: f64) -> f64 {
        self.starts.push(value);
        let [a, b, c] = self.starts[..] else { return value };
        self.starts.clear();
        let limit = a - (b - a).powi(2) / (c - 2.0 * b + a);
        if limit.is_finite() { limit } else { value }
    }

    /// Adds a point; values from the instant `needed` on may still be asked for.
    fn add(&mut self, t: f64, value: f64, after_event: bool, needed: f64) {
        let Some(segment) = self.segments.last_mut() else { return };
        match segment.last() {
            Some((last, old)) if after_event && jumps(old, value) => {
                self.segments.push(PolynomialSegment::of(last, value));
            }
            Some((last, _)) if last >= t => {
                if after_event {
                    segment.mark_corner();
                }
            }
            _ => segment.push_last(t, value),
        }
        self.discard_before(needed);
    }

    /// Drops points that can no longer reach the output.
    fn discard_before(&mut self, then: f64) {
        const CAPACITY: usize = 4096;
        if self.current > CAPACITY {
            self.segments.drain(..self.current);
            self.current = 0;
        }
        let segment = &mut self.segments[self.current];
        if segment.points() > CAPACITY {
            segment.discard_before(then);
        }
    }
}

crate::base::wire::wire_struct!(Line {
    variable,
    input,
    source,
    delay,
    moves,
    slots,
    segments,
    current,
    starts
});
crate::base::wire::wire_struct!(DelayBuffers { lines });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_delayed() {
        let layout = Layout {
            delays: vec![DelaySlots {
                variable: VarId(0),
                source: 0,
                delay: 1,
                input: None,
                moves: true,
            }],
            signals: vec![(VarId(0), 0, 2)],
            ..Layout::default()
        };
        let mut memory = [1.0, 0.5, 0.0];
        let mut delays = DelayBuffers::new(&layout);
        assert_eq!(delays.begin(0.0, &memory), Some(VarId(0)));
        delays.record(1.0, &memory, false, 0.0);
        memory[0] = 3.0;
        delays.record(1.0, &memory, true, 1.0);
        delays.record(2.0, &memory, false, 1.0);
        assert_eq!(delays.next_breakpoint(&memory), 1.5);
        delays.write_slots(1.5, &mut memory);
        assert_eq!(memory[2], 1.0);
        assert!(delays.advance_past(1.5, &memory));
        delays.write_slots(1.5, &mut memory);
        assert_eq!(memory[2], 3.0);
        assert_eq!(delays.next_breakpoint(&memory), f64::INFINITY);
    }
}
