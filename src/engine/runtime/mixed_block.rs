//! Mixed blocks: relations and equations that must be solved together. They are iterated to a fixed
//! point; if the iteration cycles or meets equations without a solution, values of the relations
//! that are consistent with the equations are searched for.
//!
//! There may be several fixed points. The discrete variables count, not the relations: at first these are evaluated for the
//! present values of the discrete variables, see `simulate::event::iterate`.

use crate::ir::program::{DiscreteUnknown, Program, Slot};
use crate::numeric::combinations::Combinations;
use crate::numeric::cycle_detection::CycleDetector;

use super::machine::{Fault, Machine};

/// Maximum number of iterations of a mixed block.
pub const ITERATION_LIMIT: u32 = 100;

/// Working memory for one mixed block.
pub struct MixedBlockSolver {
    /// The slots of the discrete unknowns.
    discrete_slots: Vec<Slot>,
    /// Those that hold relations.
    relations: Vec<Slot>,
    /// The discrete unknowns before the last iteration.
    previous: Vec<f64>,
    cycle: CycleDetector,
    /// The memory before the first iteration, if there are relations to search.
    entry_memory: Vec<f64>,
}

impl MixedBlockSolver {
    /// Working memory for mixed block `k`.
    pub fn new(program: &Program, k: usize) -> Self {
        let all = &program.routines.mixed_blocks[k].discrete_unknowns;
        let is_relation = |w: &&DiscreteUnknown| matches!(w, DiscreteUnknown::Relation(..));
        let discrete_slots: Vec<Slot> = all.iter().map(|w| discrete_slot(*w)).collect();
        let relations: Vec<Slot> =
            all.iter().filter(is_relation).map(|w| discrete_slot(*w)).collect();
        let kept = if relations.is_empty() { 0 } else { program.image.len() };
        MixedBlockSolver {
            previous: vec![0.0; discrete_slots.len()],
            discrete_slots,
            relations,
            cycle: CycleDetector::default(),
            entry_memory: vec![0.0; kept],
        }
    }

    /// Solves the block: iterates until its discrete unknowns stop changing, or searches.
    pub fn iterate_block(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        if !self.entry_memory.is_empty() {
            machine.save_to(&mut self.entry_memory);
        }
        self.evaluate_relations(machine, k);
        let mut outcome = self.iterate(machine, k);
        if let Err(fault) = outcome
            && !self.entry_memory.is_empty()
            && matches!(fault, Fault::NotConverged { .. } | Fault::Singular { .. })
        {
            let saved = machine.save_fault();
            if self.search(machine, k) {
                machine.discard_fault(saved);
                outcome = Ok(());
            } else {
                machine.restore_fault(saved);
            }
        }
        match outcome {
            Err(Fault::NotConverged { .. }) if machine.relaxed && !self.needs_now(machine, k) => {
                machine.still_changing = true;
                Ok(())
            }
            outcome => outcome,
        }
    }

    /// Evaluates the relations for the present values of the discrete variables. Where these have no solution, the relations
    /// stay.
    fn evaluate_relations(&mut self, machine: &mut Machine<'_>, k: usize) {
        let mixed = &machine.program.routines.mixed_blocks[k];
        if self.entry_memory.is_empty() || mixed.decisions.is_empty() {
            return;
        }
        if machine.run(&mixed.tape).is_err() {
            machine.fault = None;
            machine.restore_from(&self.entry_memory);
        }
    }

    /// Whether equations of a when-clause that is active have no solution here. No later pass would see
    /// them: the clause is active in this one only. (Relations may have other values in a later pass.)
    fn needs_now(&self, machine: &Machine<'_>, k: usize) -> bool {
        let edges = &machine.program.routines.mixed_blocks[k].edges;
        let is_active =
            |&(now, before): &(Slot, Slot)| machine.get(now) != 0.0 && machine.get(before) == 0.0;
        self.relations.is_empty() && edges.iter().any(is_active)
    }

    /// Iterates the block until nothing changes or a state recurs.
    fn iterate(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        let mixed = &machine.program.routines.mixed_blocks[k];
        let mut unknown = 0;
        let mut recurred = false;
        self.cycle.restart();
        for _ in 0..ITERATION_LIMIT {
            self.record_values(machine);
            if self.cycle.repeats(&self.previous) {
                // Unknowns that nothing determines now start from where they are.
                if recurred || machine.undetermined.is_none() {
                    break;
                }
                recurred = true;
                self.cycle.restart();
            }
            machine.run(&mixed.decisions)?;
            machine.run(&mixed.tape)?;
            match self.first_change(machine) {
                Some(changed) => unknown = changed,
                None => return Ok(()),
            }
        }
        Err(machine.fail(Fault::NotConverged { mixed_block: k, unknown }))
    }

    fn record_values(&mut self, machine: &Machine<'_>) {
        for (previous, slot) in self.previous.iter_mut().zip(&self.discrete_slots) {
            *previous = machine.get(*slot);
        }
    }

    /// Position of the first discrete unknown that changed in the last iteration.
    fn first_change(&self, machine: &Machine<'_>) -> Option<usize> {
        let mut pairs = self.discrete_slots.iter().zip(&self.previous);
        pairs.position(|(slot, previous)| machine.get(*slot).to_bits() != previous.to_bits())
    }

    /// Searches for values of the relations that are consistent with the equations, in order of the
    /// number of relations that differ from their previous value; true if there are any.
    fn search(&mut self, machine: &mut Machine<'_>, k: usize) -> bool {
        let mut choices = Combinations::new(self.relations.len());
        while let Some(flipped) = choices.next_subset() {
            if self.is_confirmed(machine, k, flipped) {
                return true;
            }
        }
        false
    }

    /// True if the block is consistent with some of its relations flipped.
    fn is_confirmed(&mut self, machine: &mut Machine<'_>, k: usize, flipped: &[usize]) -> bool {
        let mixed = &machine.program.routines.mixed_blocks[k];
        machine.restore_from(&self.entry_memory);
        let was_relaxed = std::mem::replace(&mut machine.relaxed, true);
        // The first pass updates the discrete variables, the second one the equations that read
        // them.
        let followed = (0..2).all(|_| {
            self.set_relations(machine, flipped);
            machine.run(&mixed.decisions).is_ok() && machine.run(&mixed.tape).is_ok()
        });
        machine.relaxed = was_relaxed;
        if !followed {
            return false;
        }
        self.set_relations(machine, flipped);
        self.record_values(machine);
        let followed = machine.run(&mixed.decisions).is_ok() && machine.run(&mixed.tape).is_ok();
        followed && self.first_change(machine).is_none()
    }

    /// Sets the relations to their values on entry, with some of them flipped.
    fn set_relations(&self, machine: &mut Machine<'_>, flipped: &[usize]) {
        for (i, slot) in self.relations.iter().enumerate() {
            let before = self.entry_memory[*slot as usize] != 0.0;
            machine.set(*slot, f64::from(before != flipped.contains(&i)));
        }
    }
}

/// The slot of a discrete unknown.
pub fn discrete_slot(w: DiscreteUnknown) -> Slot {
    match w {
        DiscreteUnknown::Variable(_, slot) | DiscreteUnknown::Relation(_, slot) => slot,
    }
}
