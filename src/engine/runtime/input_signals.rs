//! Inputs driven by recorded signals. Their values are written to the memory whenever time is set,
//! so the interpreter and machine code read an input like a state.
//!
//! The delay of such an input, `delay(u, T)` with a parameter `T`, is the same signal read a time `T` earlier: its past
//! is known, so it needs no history, and it is smooth in `T` down to zero.
//!
//! A Boolean or Integer input takes each value of its signal at an event, and keeps it until the next.

use std::sync::Arc;

use crate::ir::expr::{Type, VarId};
use crate::ir::foreign::ForeignSignal;
use crate::ir::program::{Program, Slot};
use crate::numeric::time_series::{Interpolation, TimeSeries};

/// The driven inputs of one run.
#[derive(Clone, Default)]
pub struct InputSignals {
    signals: Vec<InputSignal>,
}

#[derive(Clone)]
struct InputSignal {
    series: Arc<TimeSeries>,
    /// Slot of the time by which it is delayed, s.
    delay: Option<Slot>,
    /// The interval between sample instants that contained the last evaluation. For signals with
    /// breakpoints it is fixed during a step, so that the step sees a smooth signal up to its end.
    interval: usize,
    has_breakpoints: bool,
    /// The input changes at events alone, and steps between them may be long.
    is_discrete: bool,
    /// Slots of the derivatives, in ascending order from 0.
    slots: Vec<Slot>,
}

impl InputSignals {
    /// Signals that drive inputs from the instant `t` on.
    pub fn new(program: &Program, sources: &[(VarId, Arc<TimeSeries>)], t: f64) -> Self {
        let layout = &program.layout;
        let one = |v: VarId, series: &Arc<TimeSeries>, delay: Option<Slot>| {
            let mut slots: Vec<(u32, Slot)> = layout
                .signals
                .iter()
                .filter(|r| r.0 == v)
                .map(|(_, order, slot)| (*order, *slot))
                .collect();
            slots.sort_unstable();
            let variable = &program.blocks.dae.variables[v];
            // Only a Real that varies continuously has a signal of its own to read.
            let is_discrete = slots.is_empty() && variable.is_input();
            let series = match is_discrete {
                true => &Arc::new(series.held(|x| value_of(variable.ty, x))),
                false => series,
            };
            if is_discrete {
                slots.push((0, program.slot(v)));
            }
            let mut own = InputSignal::new(Arc::clone(series), delay, t);
            own.is_discrete = is_discrete;
            own.slots = slots.into_iter().map(|(_, slot)| slot).collect();
            own
        };
        let own = sources.iter().map(|(v, series)| one(*v, series, None));
        let delayed = layout.delays.iter().filter_map(|d| {
            let (_, series) = sources.iter().find(|(v, _)| Some(*v) == d.input)?;
            Some(one(d.variable, series, Some(d.delay)))
        });
        InputSignals { signals: own.chain(delayed).collect() }
    }

    /// Signals that drive the inputs of a foreign model from the instant `t` on; the slots of each follow those of the
    /// one before.
    pub fn foreign(signals: &[ForeignSignal], t: f64) -> Self {
        let mut next = 0;
        let one = |signal: &ForeignSignal| {
            let first = next;
            next += signal.orders as Slot;
            let mut own = InputSignal::new(Arc::clone(&signal.series), None, t);
            own.is_discrete = signal.is_discrete;
            own.slots = (first..next).collect();
            own
        };
        InputSignals { signals: signals.iter().map(one).collect() }
    }

    /// The signal that is written to a slot, as that of the value with this number.
    pub fn to_foreign(&self, slot: Slot, value: usize) -> Option<ForeignSignal> {
        let own = self.signals.iter().find(|p| p.slots.first() == Some(&slot))?;
        let (series, is_discrete) = (Arc::clone(&own.series), own.is_discrete);
        Some(ForeignSignal { value, series, is_discrete, orders: own.slots.len() })
    }

    /// Finds the intervals of the delayed signals at `t`, now that their delays are known.
    pub fn begin(&mut self, t: f64, memory: &[f64]) {
        for p in self.signals.iter_mut().filter(|p| p.delay.is_some()) {
            p.interval = p.series.interval(t - p.lag(memory), 0);
        }
    }

    /// Writes the values of all signals at `t`.
    #[inline]
    pub fn write_slots(&mut self, t: f64, memory: &mut [f64]) {
        for p in &mut self.signals {
            let then = t - p.lag(memory);
            if !p.has_breakpoints {
                p.interval = p.series.interval(then, p.interval);
            }
            for (order, slot) in p.slots.iter().enumerate() {
                memory[*slot as usize] = p.series.at(then, p.interval, order as u8);
            }
        }
    }

    /// The end of the current interval of the signals with breakpoints; infinity if there are none.
    pub fn next_breakpoint(&self, memory: &[f64]) -> f64 {
        self.signals.iter().map(|p| p.next_breakpoint(memory)).fold(f64::INFINITY, f64::min)
    }

    /// The slot of the delay that determines when the next breakpoint is, if that is due at `t` and a value or rate
    /// jumps there: an event whose instant depends on a parameter.
    pub fn delay_of_jump(&self, t: f64, memory: &[f64]) -> Option<Slot> {
        let due = |p: &&InputSignal| p.jumps() && p.next_breakpoint(memory) <= t;
        self.signals.iter().filter(due).find_map(|p| p.delay)
    }

    /// True if a breakpoint of a delayed signal is due at `t`: there the derivative by the delay, which is the rate of the
    /// signal, jumps.
    pub fn has_delayed_breakpoint(&self, t: f64, memory: &[f64]) -> bool {
        let mut delayed = self.signals.iter().filter(|p| p.delay.is_some());
        delayed.any(|p| p.next_breakpoint(memory) <= t)
    }

    /// True if an input that changes at events alone may change at `t`.
    pub fn has_event(&self, t: f64, memory: &[f64]) -> bool {
        self.signals.iter().any(|p| p.is_discrete && p.next_breakpoint(memory) <= t)
    }

    /// Advances past the breakpoints up to `t`; true if a value or rate that the program reads may
    /// jump there.
    pub fn advance_past(&mut self, t: f64, memory: &[f64]) -> bool {
        let mut jumps = false;
        for p in &mut self.signals {
            while p.next_breakpoint(memory) <= t {
                p.interval += 1;
                jumps |= p.jumps();
            }
        }
        jumps
    }

    /// The typical sampling interval of the signals; infinity if there are none.
    pub fn spacing(&self) -> f64 {
        let continuous = self.signals.iter().filter(|p| !p.is_discrete);
        continuous.map(|p| p.series.spacing()).fold(f64::INFINITY, f64::min)
    }

    /// Calls `visit` with each slot and its rate of change.
    pub fn rates(&self, memory: &[f64], mut visit: impl FnMut(Slot, f64)) {
        for p in &self.signals {
            for pair in p.slots.windows(2) {
                visit(pair[0], memory[pair[1] as usize]);
            }
        }
    }

    /// True if a signal is read some time later.
    pub fn has_delays(&self) -> bool {
        self.signals.iter().any(|p| p.delay.is_some())
    }

    /// The slots of the delayed signals and of their derivatives, each with that of its rate and that of the delay.
    pub fn delayed(&self) -> impl Iterator<Item = DelayedSlots> {
        self.signals.iter().filter_map(|p| Some((p, p.delay?))).flat_map(|(p, delay)| {
            let pairs = p.slots.windows(2);
            pairs.map(move |pair| DelayedSlots { value: pair[0], rate: pair[1], delay })
        })
    }
}

/// What a discrete variable of a type takes of a number.
fn value_of(ty: Type, x: f64) -> f64 {
    match ty {
        Type::Boolean => f64::from(u8::from(x != 0.0)),
        Type::Real => x,
        _ => x.round(),
    }
}

/// A delayed signal or one of its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct DelayedSlots {
    /// The slot that holds it.
    pub value: Slot,
    /// The slot of its derivative by time.
    pub rate: Slot,
    /// The slot of the delay, s.
    pub delay: Slot,
}

impl InputSignal {
    /// A signal from the instant `t` on that is not written yet.
    fn new(series: Arc<TimeSeries>, delay: Option<Slot>, t: f64) -> Self {
        let has_breakpoints =
            matches!(series.interpolation(), Interpolation::Hold | Interpolation::Linear);
        let interval = series.interval(t, 0);
        InputSignal {
            series,
            delay,
            interval,
            has_breakpoints,
            is_discrete: false,
            slots: Vec::new(),
        }
    }

    /// The time by which it is delayed, s; 0 while that is not known.
    #[inline]
    fn lag(&self, memory: &[f64]) -> f64 {
        self.delay.map_or(0.0, |slot| memory[slot as usize].max(0.0))
    }

    /// The end of the current interval; infinity for a signal without breakpoints.
    fn next_breakpoint(&self, memory: &[f64]) -> f64 {
        match self.has_breakpoints {
            true => self.series.end_of(self.interval) + self.lag(memory),
            false => f64::INFINITY,
        }
    }

    /// True if a value or rate that the program reads may jump at a breakpoint.
    fn jumps(&self) -> bool {
        // The highest order serves events only.
        let read = self.slots.len().saturating_sub(1);
        self.series.interpolation() == Interpolation::Hold || read > 1
    }
}
