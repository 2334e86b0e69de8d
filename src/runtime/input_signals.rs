//! Inputs driven by recorded signals. Their values are written to the memory whenever time is set,
//! so the interpreter and machine code read an input like a state.

use std::sync::Arc;

use crate::ir::expr::VarId;
use crate::ir::program::{Layout, Slot};
use crate::numeric::time_series::{Interpolation, TimeSeries};

/// The driven inputs of one run.
#[derive(Clone, Default)]
pub struct InputSignals {
    signals: Vec<InputSignal>,
}

#[derive(Clone)]
struct InputSignal {
    series: Arc<TimeSeries>,
    /// The interval between sample instants that contained the last evaluation. For signals with
    /// breakpoints it is fixed during a step, so that the step sees a smooth signal up to its end.
    interval: usize,
    has_breakpoints: bool,
    /// Slots of the derivatives, in ascending order from 0.
    slots: Vec<Slot>,
}

impl InputSignals {
    /// Signals that drive inputs from the instant `t` on.
    pub fn new(layout: &Layout, sources: &[(VarId, Arc<TimeSeries>)], t: f64) -> Self {
        let one = |(v, series): &(VarId, Arc<TimeSeries>)| {
            let mut slots: Vec<(u32, Slot)> = layout
                .signals
                .iter()
                .filter(|r| r.0 == *v)
                .map(|(_, order, slot)| (*order, *slot))
                .collect();
            slots.sort_unstable();
            let has_breakpoints =
                matches!(series.interpolation(), Interpolation::Hold | Interpolation::Linear);
            InputSignal {
                series: Arc::clone(series),
                interval: series.interval(t, 0),
                has_breakpoints,
                slots: slots.into_iter().map(|(_, slot)| slot).collect(),
            }
        };
        InputSignals { signals: sources.iter().map(one).collect() }
    }

    /// Writes the values of all signals at `t`.
    #[inline]
    pub fn write_slots(&mut self, t: f64, memory: &mut [f64]) {
        for p in &mut self.signals {
            if !p.has_breakpoints {
                p.interval = p.series.interval(t, p.interval);
            }
            for (order, slot) in p.slots.iter().enumerate() {
                memory[*slot as usize] = p.series.at(t, p.interval, order as u8);
            }
        }
    }

    /// The end of the current interval of the signals with breakpoints; infinity if there are none.
    pub fn next_breakpoint(&self) -> f64 {
        let has_breakpoints = self.signals.iter().filter(|p| p.has_breakpoints);
        has_breakpoints.map(|p| p.series.end_of(p.interval)).fold(f64::INFINITY, f64::min)
    }

    /// Advances past the breakpoints up to `t`; true if a value or rate that the program reads may
    /// jump there.
    pub fn advance_past(&mut self, t: f64) -> bool {
        let mut jumps = false;
        for p in self.signals.iter_mut().filter(|p| p.has_breakpoints) {
            let now = p.series.interval(t, p.interval);
            if now != p.interval {
                p.interval = now;
                // The highest order serves events only.
                let read = p.slots.len().saturating_sub(1);
                jumps |= p.series.interpolation() == Interpolation::Hold || read > 1;
            }
        }
        jumps
    }

    /// The typical sampling interval of the signals; infinity if there are none.
    pub fn spacing(&self) -> f64 {
        self.signals.iter().map(|p| p.series.spacing()).fold(f64::INFINITY, f64::min)
    }

    /// Calls `visit` with each slot and its rate of change.
    pub fn rates(&self, memory: &[f64], mut visit: impl FnMut(Slot, f64)) {
        for p in &self.signals {
            for pair in p.slots.windows(2) {
                visit(pair[0], memory[pair[1] as usize]);
            }
        }
    }
}
