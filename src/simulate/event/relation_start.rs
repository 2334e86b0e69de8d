//! The values with which relations begin at the start: those at the start values of their operands.

use crate::runtime::machine::Machine;

/// Evaluates the relations that need a value before the initial sequence runs; whether one is true. Those that cannot be
/// evaluated are false.
pub fn evaluate(machine: &mut Machine<'_>) -> bool {
    let program = machine.program;
    let starts = &program.events.relation_starts;
    if starts.is_empty() {
        return false;
    }
    let (tangents, saved) = (machine.tangents.take(), machine.save_fault());
    let mut values = Vec::with_capacity(starts.len());
    for start in starts {
        let slot = program.layout.relations + start.relation;
        if machine.run(&start.tape).is_err() {
            machine.set(slot, 0.0);
        }
        values.push((slot, machine.get(slot)));
    }
    machine.restore_fault(saved);
    machine.tangents = tangents;
    for (slot, value) in &values {
        machine.set(*slot, *value);
    }
    values.iter().any(|(_, value)| *value != 0.0)
}

/// Makes all of them false.
pub fn clear(machine: &mut Machine<'_>) {
    let first = machine.program.layout.relations;
    for start in &machine.program.events.relation_starts {
        machine.set(first + start.relation, 0.0);
    }
}
