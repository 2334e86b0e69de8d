//! An FMU as a component of a model, which steps from one communication point to the next: one child process for each
//! run.
//!
//! In: what a run tells an instance, as a chain of messages. Out: the values that it computes.
//! Messages are only noted ([`chain`](super::chain)); an instance executes them when a value of the state after them is
//! read that no earlier run has read. It goes on from where it is, or starts again if the state is not ahead of it, so
//! that values are functions of the chain alone.

use std::cell::RefCell;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::chain::{Chains, Message};
use super::model::{self, Fmu, Integrating};
use super::remote::Remote;
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::external::component::Component;
use crate::fmu::cause::FmuCause;
use crate::ir::foreign::{ForeignFault, ForeignModel, ForeignRole};

/// The tolerance of a Co-Simulation whose FMU asks for none.
const TOLERANCE: f64 = 1e-6;

thread_local! {
    /// The last failure on this thread.
    static FAILURE: RefCell<Option<Box<Diagnostic>>> = const { RefCell::new(None) };
}

/// The instance of a run.
#[derive(Default)]
struct Live {
    instance: Option<Remote>,
    /// The state in which it is.
    at: u64,
    /// The instant, s.
    t: f64,
}

/// A number that differs between threads that run at the same time.
fn thread_number() -> usize {
    FAILURE.with(|own| std::ptr::from_ref(own) as usize)
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "an instance at {} s", self.t)
    }
}

/// An FMU from which a component of a model is made.
#[derive(Debug)]
pub struct FmuComponent {
    fmu: Arc<Fmu>,
    numbers: FastMap<String, usize>,
    /// The values that may be read.
    watched: Vec<usize>,
    /// The position of each in `watched`.
    positions: FastMap<usize, usize>,
    chains: Mutex<Chains<Mutex<Live>>>,
}

/// Opens an FMU for the component of a model that was imported from the one with this token.
pub fn open(file: &Path, token: &str) -> Result<FmuComponent, String> {
    let fmu = model::open_shared(file, Integrating::RatherThere).map_err(|d| d.message.clone())?;
    if fmu.token() != token {
        return Err("it is another FMU than the one that was imported; import it again".to_owned());
    }
    let variables = &fmu.interface().variables;
    let numbers = variables.iter().map(|v| (v.name.clone(), v.value)).collect();
    let is_read = |role: ForeignRole| matches!(role, ForeignRole::Output | ForeignRole::Computed);
    let mut watched: Vec<usize> =
        variables.iter().filter(|v| is_read(v.role)).map(|v| v.value).collect();
    watched.sort_unstable();
    watched.dedup();
    let positions = watched.iter().enumerate().map(|(k, value)| (*value, k)).collect();
    Ok(FmuComponent { fmu, numbers, watched, positions, chains: Mutex::default() })
}

/// Locks, even after a panic of another thread.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl FmuComponent {
    fn after(&self, state: f64, message: Message) -> f64 {
        locked(&self.chains).after(state as u64, message) as f64
    }

    /// Brings the instance of a run to a state.
    fn reach(&self, live: &mut Live, run: u64, state: u64) -> Result<(), ForeignFault> {
        let (goes_on, messages) = {
            let chains = locked(&self.chains);
            let at = if live.instance.is_some() { live.at } else { run };
            let lost = || self.fault("its state at this instant is no longer known");
            chains.path([at, run], state).ok_or_else(lost)?
        };
        if !goes_on || live.instance.is_none() {
            self.start(live, run)?;
        }
        let Live { instance, t, .. } = live;
        let instance = instance.as_mut().ok_or_else(|| self.fault("it has no instance"))?;
        let mut inputs = Vec::new();
        for message in messages {
            match message {
                Message::Set(value, to) => inputs.push((value, f64::from_bits(to))),
                Message::Begin(_) => {}
                Message::Step(size) => {
                    let end = *t + f64::from_bits(size);
                    inputs.sort_by_key(|(value, _)| *value);
                    while *t < end {
                        let step = instance.step(*t, end - *t, &inputs)?;
                        if step.ends {
                            return Err(self.fault(&format!("it ends the run at time {t} s")));
                        }
                        if step.reached <= *t {
                            return Err(self.fault(&format!("it makes no step at time {t} s")));
                        }
                        *t = step.reached.min(end);
                    }
                    inputs.clear();
                }
            }
        }
        live.at = state;
        Ok(())
    }

    /// A new instance at the begin of a run.
    fn start(&self, live: &mut Live, run: u64) -> Result<(), ForeignFault> {
        live.instance = None;
        let (start, mut values) = {
            let chains = locked(&self.chains);
            let begin = chains.begin_of(run);
            let (before, start) = begin.ok_or_else(|| self.fault("its run has not begun"))?;
            let (_, messages) = chains.path([0, 0], before).unwrap_or_default();
            let value = |m: &Message| match m {
                Message::Set(value, to) => Some((*value, f64::from_bits(*to))),
                _ => None,
            };
            (start, messages.iter().filter_map(value).collect::<Vec<_>>())
        };
        values.sort_by_key(|(value, _)| *value);
        let mut instance = self.fmu.lend(&self.watched)?;
        // The end is not known; a run may last longer than the default experiment of the FMU.
        let stop = f64::INFINITY;
        let tolerance = self.fmu.interface().experiment[3];
        instance.begin([start, stop], tolerance.unwrap_or(TOLERANCE), &values)?;
        (live.instance, live.at, live.t) = (Some(instance), run, start);
        Ok(())
    }

    /// A value in a state of a run.
    fn read(&self, run: u64, state: u64, position: usize) -> Result<f64, ForeignFault> {
        let live = {
            let mut chains = locked(&self.chains);
            let live = chains.live(run, thread_number());
            if let Some(values) = chains.values(state) {
                return Ok(values[position]);
            }
            live
        };
        let mut live = locked(&live);
        let reached = self.reach(&mut live, run, state).and_then(|()| {
            let values = live.instance.as_ref().map_or(&[][..], Remote::values);
            match values.len() == self.watched.len() {
                true => Ok(values.to_vec()),
                false => Err(self.fault("its values are not known")),
            }
        });
        let values = match reached {
            Ok(values) => values,
            Err(fault) => {
                // What has failed is not asked again.
                live.instance = None;
                return Err(fault);
            }
        };
        let value = values[position];
        locked(&self.chains).keep(state, values.into());
        Ok(value)
    }

    fn fault(&self, what: &str) -> ForeignFault {
        let cause =
            FmuCause::ComponentFailed { path: self.fmu.file().to_owned(), what: what.to_owned() };
        ForeignFault {
            kind: crate::ir::foreign::ForeignFaultKind::Final,
            diagnostic: Box::new(Diagnostic::new(cause, Span::NONE)),
        }
    }
}

impl Component for FmuComponent {
    fn value(&self, name: &str) -> Option<usize> {
        self.numbers.get(name).copied()
    }

    fn set(&self, state: f64, value: usize, to: f64) -> f64 {
        self.after(state, Message::Set(value, to.to_bits()))
    }

    fn begin(&self, state: f64, start: f64) -> f64 {
        self.after(state, Message::Begin(start.to_bits()))
    }

    fn step(&self, state: f64, size: f64) -> f64 {
        self.after(state, Message::Step(size.to_bits()))
    }

    fn get(&self, state: f64, value: usize) -> f64 {
        let state = state as u64;
        let run = locked(&self.chains).run_of(state);
        // Before initialization there are no values yet.
        let (Some(run), Some(position)) = (run, self.positions.get(&value)) else { return 0.0 };
        match self.read(run, state, *position) {
            Ok(value) => value,
            Err(fault) => {
                FAILURE.with_borrow_mut(|failure| *failure = Some(fault.diagnostic));
                f64::NAN
            }
        }
    }

    fn release(&self) {
        let ended = locked(&self.chains).release(thread_number());
        let instances = ended.iter().filter_map(|live| locked(live).instance.take());
        self.fmu.give_back(instances.collect());
    }

    fn take_failure(&self) -> Option<Box<Diagnostic>> {
        FAILURE.with_borrow_mut(Option::take)
    }
}
