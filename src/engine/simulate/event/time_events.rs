//! Time events: sample clocks, and comparisons with time.

use crate::ir::program::RelationTrigger;
use crate::runtime::machine::Machine;

/// Distance, in units of rounding, below which instants are simultaneous.
const SIMULTANEOUS: f64 = 4.0;

/// The clocks of a run.
#[derive(Clone, Debug)]
pub struct Clocks {
    /// Number of the next tick of each.
    next: Vec<u64>,
}

impl Clocks {
    /// The clocks before `start`; parameters must have been evaluated.
    pub fn new(machine: &Machine<'_>, start: f64) -> Self {
        let next = machine.program.events.clocks.iter().map(|clock| {
            let (first, interval) = (machine.get(clock.start), machine.get(clock.interval));
            let passed = ((start - first) / interval - 1e-9).ceil();
            if passed > 0.0 { passed as u64 } else { 0 }
        });
        Clocks { next: next.collect() }
    }

    /// The next time event after `t`; infinity if there is none.
    pub fn next_instant(&self, machine: &Machine<'_>, t: f64) -> f64 {
        let relations = machine.program.events.relation_triggers.iter().filter_map(|w| match w {
            RelationTrigger::Time(slot) => Some(machine.get(*slot)),
            _ => None,
        });
        let ticks = (0..self.next.len()).map(|k| self.tick(machine, k));
        relations.chain(ticks).filter(|at| *at > t).fold(f64::INFINITY, f64::min)
    }

    /// Raises the flags of the clocks that tick at `t` and advances them; true if any ticks. A tick that is simultaneous
    /// with one of them belongs to the same event, even if rounding has put `t` itself further away.
    pub fn raise(&mut self, machine: &mut Machine<'_>, t: f64) -> bool {
        let after = |t: f64| t + SIMULTANEOUS * f64::EPSILON * t.abs();
        let mut waiting: Vec<usize> = (0..self.next.len()).collect();
        let mut until = after(t);
        loop {
            let count = waiting.len();
            waiting.retain(|&k| {
                let tick = self.tick(machine, k);
                if tick > until {
                    return true;
                }
                until = until.max(after(tick));
                self.next[k] += 1;
                let flag = machine.program.events.clocks[k].flag;
                machine.set(flag, 1.0);
                false
            });
            if waiting.len() == count {
                return count < self.next.len();
            }
        }
    }

    /// The first clock whose next tick is `near`, with the number of that tick.
    pub fn ticking(
        &self,
        machine: &Machine<'_>,
        near: impl Fn(f64) -> bool,
    ) -> Option<(usize, f64)> {
        let k = (0..self.next.len()).find(|k| near(self.tick(machine, *k)))?;
        Some((k, self.next[k] as f64))
    }

    /// Lowers all flags.
    pub fn lower(&self, machine: &mut Machine<'_>) {
        for k in 0..self.next.len() {
            let flag = machine.program.events.clocks[k].flag;
            machine.set(flag, 0.0);
        }
    }

    fn tick(&self, machine: &Machine<'_>, k: usize) -> f64 {
        let clock = &machine.program.events.clocks[k];
        machine.get(clock.start) + self.next[k] as f64 * machine.get(clock.interval)
    }
}

crate::base::wire::wire_struct!(Clocks { next });
