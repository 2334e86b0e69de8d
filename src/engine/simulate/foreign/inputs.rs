//! The inputs of a foreign model that signals drive.

use crate::ir::foreign::ForeignSignal;
use crate::runtime::input_signals::InputSignals;

use super::integration::Surroundings;

/// The signals of a run and their values at an instant.
pub(super) struct Inputs {
    signals: InputSignals,
    memory: Vec<f64>,
    /// Numbers of the values, and the positions in `memory`.
    places: Vec<(usize, usize)>,
}

impl Inputs {
    /// The signals from the instant `t`, s, on.
    pub fn new(signals: &[ForeignSignal], t: f64) -> Self {
        let mut next = 0;
        let place = |signal: &ForeignSignal| {
            let own = (signal.value, next);
            next += signal.orders;
            own
        };
        let places = signals.iter().map(place).collect();
        Inputs { signals: InputSignals::foreign(signals, t), memory: vec![0.0; next], places }
    }

    /// The typical distance of two samples, s; infinity without signals.
    pub fn spacing(&self) -> f64 {
        self.signals.spacing()
    }

    /// The next instant at which a signal may have a corner or a jump, s.
    pub fn next_breakpoint(&self) -> f64 {
        self.signals.next_breakpoint(&self.memory)
    }

    /// Passes the breakpoints up to `t`, s; true if a value may jump there.
    pub fn advance_past(&mut self, t: f64) -> bool {
        self.signals.advance_past(t, &self.memory)
    }
}

impl Surroundings for Inputs {
    fn inputs_at(&mut self, t: f64, out: &mut Vec<(usize, f64)>) {
        self.signals.write_slots(t, &mut self.memory);
        out.extend(self.places.iter().map(|(value, place)| (*value, self.memory[*place])));
    }
}
