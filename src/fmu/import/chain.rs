//! The states of the instances of an FMU, each named by the chain of messages that leads to it, and the values there.
//!
//! The same messages lead to the same state, and so to the same values: a run that is told the same as an earlier one
//! needs no instance. A fit repeats many runs that tell the FMU the same, for the parameters of a sensor come after it.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::base::index::{FastMap, FastSet};

/// Runs whose instances are kept if nobody says that they have ended; those of the oldest are ended.
const MOST_RUNS: usize = 64;
/// States above which those of runs that have ended are forgotten, if they are also twice as many as were left the last
/// time.
const MOST_STATES: usize = 200_000;
/// Numbers in the newer half of the values that are kept.
const MOST_NUMBERS: usize = 1_000_000;

/// A message to an instance. Reals are held by their bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Message {
    /// A value and its new number.
    Set(usize, u64),
    /// The initialization, at this instant, s.
    Begin(u64),
    /// A step of this size, s.
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

/// A run on a thread. Runs that were told the same are different ones on different threads, which are not at the same
/// state.
struct ThreadRun<L> {
    begin: u64,
    thread: usize,
    live: Arc<L>,
}

/// The states of all instances. `L` is what a run has on its thread. State 0 is that of a new instance.
#[derive(Default)]
pub struct Chains<L> {
    states: FastMap<u64, State>,
    known: FastMap<(u64, Message), u64>,
    last: u64,
    /// The states that were left when some were forgotten last. The begins of runs are never forgotten: where they alone
    /// are many, to look through all after each run would cost a time that grows with the square of the runs.
    left: usize,
    runs: VecDeque<ThreadRun<L>>,
    /// Begins of runs that have ended, the oldest first.
    ended: VecDeque<u64>,
    values: Values,
}

/// Values in states. Those that were used last are kept.
#[derive(Default)]
struct Values {
    newer: FastMap<u64, Box<[f64]>>,
    older: FastMap<u64, Box<[f64]>>,
    /// Numbers in `newer`.
    count: usize,
}

impl Values {
    fn get(&mut self, state: u64) -> Option<&[f64]> {
        if !self.newer.contains_key(&state) {
            let found = self.older.remove(&state)?;
            self.put(state, found);
        }
        self.newer.get(&state).map(|values| &**values)
    }

    fn put(&mut self, state: u64, values: Box<[f64]>) {
        if self.count > MOST_NUMBERS {
            self.older = std::mem::take(&mut self.newer);
            self.count = 0;
        }
        // A state costs some memory even without values.
        self.count += values.len() + 4;
        self.newer.insert(state, values);
    }

    fn retain(&mut self, is_known: impl Fn(u64) -> bool) {
        self.older.retain(|state, _| is_known(*state));
        self.newer.retain(|state, _| is_known(*state));
        self.count = self.newer.values().map(|values| values.len() + 4).sum();
    }
}

impl<L> std::fmt::Debug for Chains<L> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} states of {} runs", self.states.len(), self.runs.len())
    }
}

impl<L: Default> Chains<L> {
    /// The state after a message.
    pub fn after(&mut self, before: u64, message: Message) -> u64 {
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

    /// The state after the begin of the run of a state, if it has begun.
    pub fn run_of(&self, state: u64) -> Option<u64> {
        self.states.get(&state).and_then(|s| s.run)
    }

    /// The state before a run began, and the instant at which it began, s.
    pub fn begin_of(&self, run: u64) -> Option<(u64, f64)> {
        match self.states.get(&run)? {
            State { before, message: Message::Begin(t), .. } => Some((*before, f64::from_bits(*t))),
            _ => None,
        }
    }

    /// What a run has on a thread. Its states are known until it is released.
    pub fn live(&mut self, begin: u64, thread: usize) -> Arc<L> {
        if let Some(run) = self.runs.iter().find(|r| r.begin == begin && r.thread == thread) {
            return Arc::clone(&run.live);
        }
        if self.runs.len() >= MOST_RUNS
            && let Some(run) = self.runs.pop_front()
        {
            self.note_end(run.begin);
        }
        self.ended.retain(|ended| *ended != begin);
        let live = Arc::<L>::default();
        self.runs.push_back(ThreadRun { begin, thread, live: Arc::clone(&live) });
        live
    }

    /// Ends the runs of a thread; what they had.
    pub fn release(&mut self, thread: usize) -> Vec<Arc<L>> {
        let (ended, others): (VecDeque<_>, _) =
            std::mem::take(&mut self.runs).into_iter().partition(|r| r.thread == thread);
        self.runs = others;
        for run in &ended {
            self.note_end(run.begin);
        }
        ended.into_iter().map(|run| run.live).collect()
    }

    /// A run has ended. Where there are many states, those of the runs that ended first are forgotten.
    fn note_end(&mut self, begin: u64) {
        if !self.ended.contains(&begin) && !self.runs.iter().any(|run| run.begin == begin) {
            self.ended.push_back(begin);
        }
        if self.states.len() > MOST_STATES.max(2 * self.left) {
            self.ended.drain(..self.ended.len().div_ceil(2));
            self.forget();
        }
    }

    /// Forgets the states of runs that are not named anywhere.
    fn forget(&mut self) {
        let running = self.runs.iter().map(|r| r.begin);
        let kept: FastSet<u64> = running.chain(self.ended.iter().copied()).collect();
        // The begin of a run stays: it may be part of a compiled program.
        self.states.retain(|state, s| s.run.is_none_or(|run| kept.contains(&run) || run == *state));
        let states = &self.states;
        self.known.retain(|_, state| states.contains_key(&*state));
        self.values.retain(|state| states.contains_key(&state));
        self.left = self.states.len();
    }

    /// The messages from one of two states, the nearer one, to a state; and whether it is the first of them.
    pub fn path(&self, from: [u64; 2], to: u64) -> Option<(bool, Vec<Message>)> {
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

    /// The values in a state, if they are kept.
    pub fn values(&mut self, state: u64) -> Option<&[f64]> {
        self.values.get(state)
    }

    /// Keeps the values in a state.
    pub fn keep(&mut self, state: u64, values: Box<[f64]>) {
        self.values.put(state, values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(chains: &mut Chains<()>, level: u64, steps: u64) -> u64 {
        let set = chains.after(0, Message::Set(0, level));
        let mut state = chains.after(set, Message::Begin(0));
        for step in 0..steps {
            state = chains.after(state, Message::Step(step));
        }
        state
    }

    #[test]
    fn equal_runs_have_equal_states_and_values() {
        let mut chains = Chains::<()>::default();
        let end = run(&mut chains, 1, 3);
        let begin = chains.run_of(end).unwrap();
        chains.live(begin, 7);
        chains.keep(end, [2.5].into());
        assert_eq!(chains.release(7).len(), 1);
        assert_eq!(run(&mut chains, 1, 3), end);
        assert_eq!(chains.values(end), Some(&[2.5][..]));
        assert_ne!(run(&mut chains, 2, 3), end);
        assert_eq!(chains.path([begin, 0], end).unwrap().1.len(), 3);
    }

    #[test]
    fn states_of_runs_that_have_ended_are_bounded() {
        let mut chains = Chains::<()>::default();
        let kept = run(&mut chains, 0, 10);
        let begin = chains.run_of(kept).unwrap();
        chains.live(begin, 1);
        for level in 1..100 {
            let end = run(&mut chains, level, 10_000);
            let begin = chains.run_of(end).unwrap();
            chains.live(begin, 2);
            chains.keep(end, [1.0].into());
            chains.release(2);
            assert!(chains.states.len() <= MOST_STATES + 20_000);
        }
        // A run that goes on keeps its states.
        assert!(chains.path([begin, 0], kept).is_some());
        assert!(chains.values.newer.len() < 50);
    }

    #[test]
    fn values_are_bounded() {
        let mut values = Values::default();
        for state in 0..2_000_000 {
            values.put(state, [0.0].into());
            assert!(values.get(state / 2 * 2).is_some());
        }
        assert!(values.newer.len() + values.older.len() < 2 * MOST_NUMBERS);
    }
}
