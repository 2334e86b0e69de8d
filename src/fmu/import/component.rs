//! An FMU as a component of a model, which steps from one communication point to the next: one child process for each
//! run.
//!
//! In: what a run tells an instance, as a chain of messages. Out: the values that it computes.
//! Messages are only noted; an instance executes them when a value of the state after them is read. It goes on from
//! where it is, or starts again if the state is not ahead of it, so that values are functions of the chain alone.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::model::{self, Fmu, Integrating};
use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::external::component::Component;
use crate::fmu::cause::FmuCause;
use crate::ir::foreign::{ForeignFault, ForeignModel, ForeignRole, SteppingInstance};

/// Runs whose instances are kept if nobody says that they have ended; those of the oldest are ended.
const MOST_RUNS: usize = 64;
/// States of a run whose values are kept.
const KEPT_STATES: usize = 8;
/// The tolerance of a Co-Simulation whose FMU asks for none.
const TOLERANCE: f64 = 1e-6;

thread_local! {
    /// The last failure on this thread.
    static FAILURE: RefCell<Option<Box<Diagnostic>>> = const { RefCell::new(None) };
}

/// A message to an instance. Reals are held by their bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
enum Message {
    Set(usize, u64),
    Begin(u64),
    Step(u64),
}

/// A state of an instance: the message after which it is, and the state before.
#[derive(Clone, Copy, Debug)]
struct State {
    before: u64,
    message: Message,
    /// The state after the begin of its run, if it has begun.
    run: Option<u64>,
}

/// The states of all instances.
#[derive(Default)]
struct Store {
    states: FastMap<u64, State>,
    known: FastMap<(u64, Message), u64>,
    last: u64,
    runs: VecDeque<ThreadRun>,
}

/// A run on a thread. Runs that were told the same are different ones on different threads, which are not at the same
/// state.
#[derive(Debug)]
struct ThreadRun {
    begin: u64,
    thread: usize,
    live: Arc<Mutex<Live>>,
}

/// A number that differs between threads that run at the same time.
fn thread_number() -> usize {
    FAILURE.with(|own| std::ptr::from_ref(own) as usize)
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} states of {} runs", self.states.len(), self.runs.len())
    }
}

/// The instance of a run.
#[derive(Default)]
struct Live {
    instance: Option<Box<dyn SteppingInstance + Send>>,
    /// The state in which it is.
    at: u64,
    /// The instant, s.
    t: f64,
    values: VecDeque<(u64, Vec<f64>)>,
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
    store: Mutex<Store>,
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
    Ok(FmuComponent { fmu, numbers, watched, positions, store: Mutex::default() })
}

/// Locks, even after a panic of another thread.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Store {
    /// The state after a message.
    fn after(&mut self, before: u64, message: Message) -> u64 {
        if let Some(known) = self.known.get(&(before, message)) {
            return *known;
        }
        self.last += 1;
        let state = self.last;
        let run = match message {
            Message::Begin(_) => Some(state),
            _ => self.states.get(&before).and_then(|s| s.run),
        };
        self.states.insert(state, State { before, message, run });
        self.known.insert((before, message), state);
        state
    }

    /// The instance of a run on this thread.
    fn live(&mut self, begin: u64) -> Arc<Mutex<Live>> {
        let thread = thread_number();
        if let Some(run) = self.runs.iter().find(|r| r.begin == begin && r.thread == thread) {
            return Arc::clone(&run.live);
        }
        if self.runs.len() >= MOST_RUNS {
            self.runs.pop_front();
            self.forget();
        }
        let live = Arc::<Mutex<Live>>::default();
        self.runs.push_back(ThreadRun { begin, thread, live: Arc::clone(&live) });
        live
    }

    /// Forgets the states of runs that have ended.
    fn forget(&mut self) {
        let running: FastSet<u64> = self.runs.iter().map(|r| r.begin).collect();
        // The begin of a run stays: it may be part of a compiled program.
        self.states
            .retain(|state, s| s.run.is_none_or(|run| running.contains(&run) || run == *state));
        let states = &self.states;
        self.known.retain(|_, state| states.contains_key(&*state));
    }

    /// Ends the runs of this thread; their instances.
    fn release(&mut self) -> Vec<Box<dyn SteppingInstance + Send>> {
        let thread = thread_number();
        let (ended, others): (VecDeque<_>, _) =
            std::mem::take(&mut self.runs).into_iter().partition(|r| r.thread == thread);
        self.runs = others;
        if !ended.is_empty() {
            self.forget();
        }
        ended.iter().filter_map(|run| locked(&run.live).instance.take()).collect()
    }

    /// The messages from one of two states, the nearer one, to a state; and whether it is the first of them.
    fn path(&self, from: [u64; 2], to: u64) -> Option<(bool, Vec<Message>)> {
        let mut messages = Vec::new();
        let mut state = to;
        while !from.contains(&state) {
            let s = self.states.get(&state)?;
            messages.push(s.message);
            state = s.before;
        }
        messages.reverse();
        Some((state == from[0], messages))
    }
}

impl FmuComponent {
    fn after(&self, state: f64, message: Message) -> f64 {
        locked(&self.store).after(state as u64, message) as f64
    }

    /// Brings the instance of a run to a state.
    fn reach(&self, live: &mut Live, run: u64, state: u64) -> Result<(), ForeignFault> {
        let (goes_on, messages) = {
            let store = locked(&self.store);
            let at = if live.instance.is_some() { live.at } else { run };
            let lost = || self.fault("its state at this instant is no longer known");
            store.path([at, run], state).ok_or_else(lost)?
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
            let store = locked(&self.store);
            let begin = store.states.get(&run);
            let (before, start) = match begin {
                Some(State { before, message: Message::Begin(t), .. }) => (*before, *t),
                _ => return Err(self.fault("its run has not begun")),
            };
            let (_, messages) = store.path([0, 0], before).unwrap_or_default();
            let value = |m: &Message| match m {
                Message::Set(value, to) => Some((*value, f64::from_bits(*to))),
                _ => None,
            };
            (f64::from_bits(start), messages.iter().filter_map(value).collect::<Vec<_>>())
        };
        values.sort_by_key(|(value, _)| *value);
        let mut instance = self.fmu.start_stepping(&self.watched)?;
        // The end is not known; a run may last longer than the default experiment of the FMU.
        let stop = f64::INFINITY;
        let tolerance = self.fmu.interface().experiment[3];
        instance.initialise([start, stop], tolerance.unwrap_or(TOLERANCE), &values)?;
        (live.instance, live.at, live.t) = (Some(instance), run, start);
        Ok(())
    }

    /// A value in a state of a run.
    fn read(&self, run: u64, state: u64, position: usize) -> Result<f64, ForeignFault> {
        let live = locked(&self.store).live(run);
        let mut live = locked(&live);
        if let Some((_, values)) = live.values.iter().find(|(s, _)| *s == state) {
            return Ok(values[position]);
        }
        let reached = self.reach(&mut live, run, state).and_then(|()| {
            let mut values = vec![0.0; self.watched.len()];
            if let Some(instance) = &mut live.instance {
                instance.values(&mut values)?;
            }
            Ok(values)
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
        if live.values.len() >= KEPT_STATES {
            live.values.pop_front();
        }
        live.values.push_back((state, values));
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
        let run = locked(&self.store).states.get(&state).and_then(|s| s.run);
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
        let ended = locked(&self.store).release();
        self.fmu.give_back(ended);
    }

    fn take_failure(&self) -> Option<Box<Diagnostic>> {
        FAILURE.with_borrow_mut(Option::take)
    }
}
