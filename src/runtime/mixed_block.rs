//! Mixed blocks: relations and equations that are solved together by repetition, and where that goes
//! round in circles or meets equations without solution, by a search for values of the relations that
//! the equations confirm.

use crate::ir::program::{Program, Slot, Watched};
use crate::numeric::combinations::Combinations;
use crate::numeric::cycle_detection::CycleDetector;

use super::machine::{Fault, Instance};

/// Repetitions of a mixed block before it is given up.
pub const LOOP_LIMIT: u32 = 100;

/// What a run needs for one mixed block.
pub struct MixedWork {
    /// The cells that must rest.
    watched: Vec<Slot>,
    /// Those of them that hold relations.
    relations: Vec<Slot>,
    /// What the watched cells held before the last repetition.
    held: Vec<f64>,
    circle: CycleDetector,
    /// The whole memory before the first repetition, if there are relations to search.
    begun: Vec<f64>,
}

impl MixedWork {
    /// For the mixed block `k`.
    pub fn new(program: &Program, k: usize) -> Self {
        let all = &program.loops[k].watched;
        let is_relation = |w: &&Watched| matches!(w, Watched::Relation(..));
        let watched: Vec<Slot> = all.iter().map(|w| watched_slot(*w)).collect();
        let relations: Vec<Slot> =
            all.iter().filter(is_relation).map(|w| watched_slot(*w)).collect();
        let kept = if relations.is_empty() { 0 } else { program.image.len() };
        MixedWork {
            held: vec![0.0; watched.len()],
            watched,
            relations,
            circle: CycleDetector::default(),
            begun: vec![0.0; kept],
        }
    }

    /// Runs the block until what is discrete in it rests.
    pub fn repeat(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        if !self.begun.is_empty() {
            self.begun.copy_from_slice(&instance.memory);
        }
        let mut outcome = self.rest(instance, k);
        if let Err(fault) = outcome
            && !self.begun.is_empty()
            && matches!(fault, Fault::Restless { .. } | Fault::Singular { .. })
        {
            let told = instance.told();
            if self.search(instance, k) {
                instance.forget(told);
                outcome = Ok(());
            } else {
                instance.tell(told);
            }
        }
        match outcome {
            Err(Fault::Restless { .. }) if instance.relaxed => {
                instance.moved = true;
                Ok(())
            }
            outcome => outcome,
        }
    }

    /// Repeats the block until nothing changes, or a state comes again.
    fn rest(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        let mixed = &instance.program.loops[k];
        let mut watched = 0;
        self.circle.restart();
        for _ in 0..LOOP_LIMIT {
            self.hold(instance);
            if self.circle.repeats(&self.held) {
                break;
            }
            instance.run(&mixed.tape)?;
            match self.moved(instance) {
                Some(moved) => watched = moved,
                None => return Ok(()),
            }
        }
        Err(instance.fail(Fault::Restless { mixed: k, watched }))
    }

    fn hold(&mut self, instance: &Instance<'_>) {
        for (held, slot) in self.held.iter_mut().zip(&self.watched) {
            *held = instance.get(*slot);
        }
    }

    /// The first watched cell that is not as it was held.
    fn moved(&self, instance: &Instance<'_>) -> Option<usize> {
        let mut pairs = self.watched.iter().zip(&self.held);
        pairs.position(|(slot, held)| instance.get(*slot).to_bits() != held.to_bits())
    }

    /// Looks for values of the relations that the equations confirm, those first that differ least from
    /// the ones before; true if there are some.
    fn search(&mut self, instance: &mut Instance<'_>, k: usize) -> bool {
        let mut choices = Combinations::new(self.relations.len());
        while let Some(turned) = choices.next_subset() {
            if self.is_confirmed(instance, k, turned) {
                return true;
            }
        }
        false
    }

    /// Whether the block rests with some of its relations turned.
    fn is_confirmed(&mut self, instance: &mut Instance<'_>, k: usize, turned: &[usize]) -> bool {
        let mixed = &instance.program.loops[k];
        instance.memory.copy_from_slice(&self.begun);
        let was_relaxed = std::mem::replace(&mut instance.relaxed, true);
        // The discrete variables follow the relations before the equations follow them.
        let followed = (0..2).all(|_| {
            self.turn(instance, turned);
            instance.run(&mixed.tape).is_ok()
        });
        instance.relaxed = was_relaxed;
        if !followed {
            return false;
        }
        self.turn(instance, turned);
        self.hold(instance);
        instance.run(&mixed.tape).is_ok() && self.moved(instance).is_none()
    }

    /// Gives the relations the values that they had at the beginning, but turns some.
    fn turn(&self, instance: &mut Instance<'_>, turned: &[usize]) {
        for (i, slot) in self.relations.iter().enumerate() {
            let before = self.begun[*slot as usize] != 0.0;
            instance.set(*slot, f64::from(before != turned.contains(&i)));
        }
    }
}

/// The cell of something watched.
pub fn watched_slot(w: Watched) -> Slot {
    match w {
        Watched::Variable(_, slot) | Watched::Relation(_, slot) => slot,
    }
}
