//! The state of an instance, which can be saved, restored and written as bytes.

use crate::base::wire::{Reader, Wire};
use crate::fmu::exchange::Exchange;
use crate::ir::expr::VarId;
use crate::simulate::settings::Settings;
use crate::simulate::stepping::{Snapshot, Stepping};

use super::{Instance, Outcome, Phase, Refusal, fatal};

/// The saved state of an instance.
#[derive(Clone)]
pub struct Saved {
    phase: u8,
    parameters: Vec<(VarId, f64)>,
    starts: Vec<(VarId, f64)>,
    limits: [f64; 3],
    inputs: Vec<Option<f64>>,
    stepping: Option<Snapshot>,
    exchange: Option<(Snapshot, Vec<f64>, Vec<f64>)>,
}

crate::base::wire::wire_struct!(Saved {
    phase,
    parameters,
    starts,
    limits,
    inputs,
    stepping,
    exchange
});

const PHASES: [Phase; 6] = [
    Phase::Instantiated,
    Phase::Initializing,
    Phase::Event,
    Phase::Continuous,
    Phase::Step,
    Phase::Terminated,
];

impl Instance<'_> {
    /// The state of the instance.
    pub fn save(&mut self) -> Outcome<Saved> {
        let phase = PHASES.iter().position(|p| *p == self.phase).unwrap_or_default() as u8;
        let Settings { start, stop, tolerance, .. } = self.settings;
        Ok(Saved {
            phase,
            parameters: self.settings.parameters.clone(),
            starts: self.settings.starts.clone(),
            limits: [start, stop, tolerance],
            inputs: self.inputs.iter().map(|input| input.value).collect(),
            stepping: self.stepping.as_mut().map(Stepping::save).transpose()?,
            exchange: self.exchange.as_ref().map(Exchange::save),
        })
    }

    /// Restores a saved state.
    pub fn restore(&mut self, saved: &Saved) -> Outcome<()> {
        let fits = |s: &Snapshot| {
            s.memory.len() == self.program.image.len() && s.y.len() >= self.program.order()
        };
        let all = saved.stepping.iter().chain(saved.exchange.iter().map(|(s, ..)| s));
        if !all.into_iter().all(fits) || saved.inputs.len() != self.inputs.len() {
            return Err(Refusal::of("the state belongs to another model"));
        }
        self.settings.parameters.clone_from(&saved.parameters);
        self.settings.starts.clone_from(&saved.starts);
        let [start, stop, tolerance] = saved.limits;
        (self.settings.start, self.settings.stop) = (start, stop);
        self.settings.tolerance = tolerance;
        for (input, value) in self.inputs.iter_mut().zip(&saved.inputs) {
            input.value = *value;
        }
        self.phase = *PHASES.get(usize::from(saved.phase)).unwrap_or(&Phase::Instantiated);
        match &saved.exchange {
            Some(state) => self.initialized()?.restore(state),
            None => self.exchange = None,
        }
        match &saved.stepping {
            Some(state) => {
                if self.stepping.is_none() {
                    let settings = self.settings_with_inputs();
                    let ahead = self.inputs.is_empty();
                    let begun = Stepping::begin(self.program, &settings, ahead);
                    self.stepping = Some(begun.map_err(fatal)?);
                }
                if let Some(stepping) = &mut self.stepping {
                    stepping.restore(state)?;
                }
            }
            None => self.stepping = None,
        }
        self.is_evaluated = false;
        self.inputs_changed = false;
        Ok(())
    }
}

impl Saved {
    /// The state as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write(&mut bytes);
        bytes
    }

    /// The state from its bytes.
    pub fn from_bytes(bytes: &[u8]) -> Outcome<Self> {
        let mut reader = Reader::new(bytes);
        Saved::read(&mut reader).map_err(|why| Refusal::of(format!("not a saved state: {why}")))
    }
}
