//! The term `df/dp` of the variational equations: derivatives of the right side by the inputs at constant states.
//!
//! Where the program has code for the derivatives by the parameters and discrete variables that the inputs move
//! ([`Program::forcing`]), a few products with the derivatives of these give the term. Elsewhere, and where arguments are
//! clamped to the domain of functions, the derivatives are propagated along the right side.

use crate::ir::program::{Program, Slot};
use crate::runtime::machine::{Fault, Machine};
use crate::runtime::tangent::Tangents;
use crate::runtime::tangent::forcing::Forcing;

use super::Input;

/// Computes the term at the stages of steps.
pub struct InputDerivatives {
    count: usize,
    /// The code of the program covers the inputs of this run.
    is_compiled: bool,
    terms: Terms,
    propagated: Option<Box<Forcing>>,
    /// What the derivatives of the memory determine: outdated after they have changed.
    terms_are_stale: bool,
    propagated_is_stale: bool,
}

/// The products whose sums are the term.
#[derive(Default)]
struct Terms(Vec<Term>);

struct Term {
    /// The derivative by a parameter or discrete variable.
    slot: Slot,
    /// The derivative of that by an input.
    factor: f64,
    /// Place in the panel.
    at: usize,
}

impl InputDerivatives {
    /// For a run that is differentiated by these inputs.
    pub fn new(program: &Program, inputs: &[Input]) -> Self {
        let covers = |input: &Input| match input {
            Input::Parameter(v) => program.forcing.iter().any(|f| f.inputs.contains(v)),
            Input::Start(_) => program.forcing.is_some(),
        };
        InputDerivatives {
            count: inputs.len(),
            is_compiled: inputs.iter().all(covers),
            terms: Terms::default(),
            propagated: None,
            terms_are_stale: true,
            propagated_is_stale: true,
        }
    }

    /// The derivatives of the memory have changed.
    pub fn forget(&mut self) {
        (self.terms_are_stale, self.propagated_is_stale) = (true, true);
    }

    /// For each input, whether derivatives by it are not known.
    pub fn hides(&self, input: usize) -> bool {
        self.propagated.as_ref().is_some_and(|p| p.hidden()[input])
    }

    /// Writes the term to a panel of this width, after the right side has been evaluated; `is_differentiated` says that
    /// its Jacobian has been, too. `tangents` are those of the memory.
    pub fn write(
        &mut self,
        machine: &mut Machine<'_>,
        tangents: &Tangents,
        is_differentiated: bool,
        panel: &mut [f64],
        width: usize,
    ) -> Result<(), Fault> {
        let program = machine.program;
        panel.fill(0.0);
        // The code is for what stays constant between events, which delayed signals do not.
        let is_compiled = self.is_compiled && !machine.input_signals.has_delays();
        if let Some(code) = program.forcing.as_ref().filter(|_| is_compiled && is_differentiated) {
            if std::mem::take(&mut self.terms_are_stale) {
                self.terms.prepare(program, tangents, self.count, width);
            }
            machine.run(&code.tape)?;
            for term in &self.terms.0 {
                panel[term.at] += machine.get(term.slot) * term.factor;
            }
            return Ok(());
        }
        let propagated =
            self.propagated.get_or_insert_with(|| Box::new(Forcing::new(program, self.count)));
        if std::mem::take(&mut self.propagated_is_stale) {
            propagated.prepare(program, tangents, &machine.input_signals);
        }
        propagated.delay_signals(machine, tangents);
        propagated.propagate(machine)?;
        for (row, slot) in panel.chunks_exact_mut(width).zip(&program.layout.derivatives) {
            let derivatives = propagated.of(*slot);
            row[..derivatives.len()].copy_from_slice(derivatives);
        }
        Ok(())
    }
}

impl Terms {
    fn prepare(&mut self, program: &Program, tangents: &Tangents, count: usize, width: usize) {
        self.0.clear();
        let Some(code) = &program.forcing else { return };
        for entry in &code.entries {
            let derivatives = &tangents.of(code.seeds[entry.column as usize])[..count];
            let moved = derivatives.iter().enumerate().filter(|(_, factor)| **factor != 0.0);
            let first = entry.row as usize * width;
            self.0.extend(moved.map(|(d, factor)| Term {
                slot: entry.slot,
                factor: *factor,
                at: first + d,
            }));
        }
    }
}
