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

/// Evaluates them again after a pass that failed, which computed some operands; whether one has another value.
pub fn evaluate_again(machine: &mut Machine<'_>) -> bool {
    let before = values(machine);
    if let Some(k) = machine.failed_block.take() {
        // Its explicit variables are those of a trial point.
        let program = machine.program;
        let (tangents, saved) = (machine.tangents.take(), machine.save_fault());
        let is_evaluated = machine.run(&program.routines.torn_blocks[k].residual_tape).is_ok();
        let evaluated = is_evaluated.then(|| machine.memory.clone());
        machine.restore_fault(saved);
        machine.tangents = tangents;
        if let Some(evaluated) = evaluated {
            machine.restore_from(&evaluated);
        }
    }
    evaluate(machine);
    before != values(machine)
}

fn values(machine: &Machine<'_>) -> Vec<f64> {
    let first = machine.program.layout.relations;
    let starts = machine.program.events.relation_starts.iter();
    starts.map(|start| machine.get(first + start.relation)).collect()
}

/// Makes all of them false.
pub fn clear(machine: &mut Machine<'_>) {
    let first = machine.program.layout.relations;
    for start in &machine.program.events.relation_starts {
        machine.set(first + start.relation, 0.0);
    }
}
