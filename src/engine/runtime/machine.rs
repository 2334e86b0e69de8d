//! A virtual machine: the memory of one run of a program, and the reference interpreter.
//!
//! Straight-line code runs as machine code as soon as it is available, and is interpreted
//! otherwise.

use std::sync::Arc;

use crate::base::index::Id;
use crate::ir::expr::{Unary, VarId};
use crate::ir::external::Externals;
use crate::ir::program::{CallSite, Instr, Op, Program, Slot, Tape};
use crate::numeric::time_series::TimeSeries;
use crate::symbolic::eval;

use super::delay::DelayBuffers;
use super::frame::Frames;
use super::input_signals::InputSignals;
use super::jit::tiering::{Execution, Tier};
use super::mixed_block::MixedBlockSolver;
use super::spatial_distribution::TransportLines;
use super::tangent::Tangents;
use super::torn_block::{BlockDerivativeSolver, TornBlockSolver};

/// Maximum number of jumps within one function call: a tenth of a second.
pub const JUMP_LIMIT: u32 = 10_000_000;

/// Relative step of the central differences that differentiate functions: the cube root of the
/// rounding unit balances the truncation error (h^2) against the rounding error (eps / h).
pub const DIFFERENCE: f64 = 6.055454452393343e-6;

/// Why the execution of a tape failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fault {
    /// The matrix of a torn block is singular.
    Singular {
        /// The block.
        torn_block: usize,
        /// Position of the undetermined unknown.
        unknown: usize,
    },
    /// The Newton iteration of a torn block does not converge.
    Diverged {
        /// The block.
        torn_block: usize,
        /// Position of the unknown with the largest correction.
        unknown: usize,
    },
    /// A residual of a torn block is not finite.
    NotFinite {
        /// The block.
        torn_block: usize,
        /// Position of the residual.
        residual: usize,
    },
    /// The iteration of a mixed block does not converge.
    NotConverged {
        /// The block.
        mixed_block: usize,
        /// Position of a discrete unknown that still changes.
        unknown: usize,
    },
    /// An assertion in a function failed.
    Assertion {
        /// The function.
        function: usize,
        /// Position of its message.
        message: usize,
    },
    /// A function does not return.
    NonTerminating {
        /// The function.
        function: usize,
    },
    /// A derivative is not finite.
    Derivative {
        /// Position of the state.
        state: usize,
    },
    /// The distance to the border of a relation changes at the same rate on both sides, so that the motion along it is not
    /// determined.
    Sliding {
        /// The relation.
        relation: u32,
    },
}

/// One run of a program. Allocates nothing after `new`, except frames of recursive functions.
pub struct Machine<'p> {
    /// The program being executed.
    pub program: &'p Program,
    /// All values, by slot.
    pub memory: Vec<f64>,
    /// The memory at the last fault.
    pub fault_memory: Vec<f64>,
    /// The last fault.
    pub fault: Option<Fault>,
    /// The last torn block that was not solved. Cleared by the reader.
    pub failed_block: Option<usize>,
    /// How often a function did not return.
    pub endless_calls: u32,
    /// Instructions that functions have executed since the last tape.
    executed_in_functions: usize,
    /// Allows nonlinear blocks to switch to another solution branch at a fold. The integrator first
    /// tries whether a shorter step stays on the current branch.
    pub branch_switch: bool,
    /// Starts by the initial sequence whose loops are torn at states.
    pub starts_by_states: bool,
    /// Clamps the arguments of functions to their domain.
    pub clamp_domain: bool,
    /// Executes mixed blocks once instead of iterating them, solves inconsistent linear equations in
    /// the least-squares sense, and leaves nonlinear ones at their start where they are singular:
    /// intermediate steps of a search for consistent values.
    pub relaxed: bool,
    /// The last relaxed execution has not converged yet.
    pub still_changing: bool,
    /// The last relaxed execution left a nonlinear block unsolved.
    pub is_unsolved: bool,
    tier: Tier,
    /// If present, the derivatives of every executed tape are propagated.
    pub tangents: Option<Box<Tangents>>,
    /// A linear block that was solved although it leaves an unknown undetermined, and the position
    /// of the unknown. Cleared by the reader.
    pub undetermined: Option<(usize, usize)>,
    /// Messages of violated when-clause assertions that are not errors, with the position of the
    /// assertion. Cleared by the reader.
    pub assertion_messages: Vec<(usize, String)>,
    /// Recorded inputs.
    pub input_signals: InputSignals,
    /// Histories of delayed variables.
    pub delays: DelayBuffers,
    /// Profiles of transport lines.
    pub transports: TransportLines,
    /// Consistent values of the lagged relations found by previous searches, most recent first.
    pub relation_solutions: Vec<Vec<f64>>,
    torn_solvers: Vec<Option<Box<TornBlockSolver>>>,
    derivative_solvers: Vec<Option<Box<BlockDerivativeSolver>>>,
    mixed_solvers: Vec<Option<Box<MixedBlockSolver>>>,
    free_buffers: Vec<Vec<f64>>,
    /// Frames of recursive calls.
    pub(crate) frames: Frames,
}

/// Copies a memory but for the parameters.
fn copy_but_parameters(program: &Program, to: &mut [f64], from: &[f64]) {
    let (first, end) = program.layout.parameters;
    let (first, end) = (first as usize, end as usize);
    to[..first].copy_from_slice(&from[..first]);
    to[end..].copy_from_slice(&from[end..]);
}

/// Memory and fault of a failed attempt.
pub struct FaultSnapshot {
    memory: Vec<f64>,
    fault_memory: Vec<f64>,
    fault: Option<Fault>,
}

impl<'p> Machine<'p> {
    /// A machine in its initial state that interprets its program.
    pub fn new(program: &'p Program) -> Self {
        Machine {
            program,
            memory: program.image.clone(),
            fault_memory: program.image.clone(),
            fault: None,
            failed_block: None,
            endless_calls: 0,
            executed_in_functions: 0,
            branch_switch: true,
            starts_by_states: false,
            clamp_domain: false,
            relaxed: false,
            still_changing: false,
            is_unsolved: false,
            undetermined: None,
            tier: Tier::Interpreted,
            tangents: None,
            assertion_messages: Vec::new(),
            input_signals: InputSignals::default(),
            delays: DelayBuffers::new(&program.layout),
            transports: TransportLines::new(&program.layout),
            torn_solvers: program
                .routines
                .torn_blocks
                .iter()
                .map(|s| Some(Box::new(TornBlockSolver::new(s))))
                .collect(),
            derivative_solvers: program
                .routines
                .block_derivatives
                .iter()
                .map(|s| Some(Box::new(BlockDerivativeSolver::new(s))))
                .collect(),
            mixed_solvers: (0..program.routines.mixed_blocks.len())
                .map(|k| Some(Box::new(MixedBlockSolver::new(program, k))))
                .collect(),
            relation_solutions: Vec::new(),
            free_buffers: Vec::new(),
            frames: Frames::default(),
        }
    }

    /// Selects the execution mode.
    pub fn set_execution(&mut self, execution: &Execution) {
        self.tier = Tier::of(self.program, execution);
    }

    /// True once tapes run as machine code.
    pub fn runs_machine_code(&self) -> bool {
        matches!(self.tier, Tier::Compiled(..))
    }

    /// Overrides a parameter; false if it is not an input of the program.
    pub fn set_parameter(&mut self, v: VarId, value: f64) -> bool {
        let inputs = &self.program.layout.parameter_inputs;
        let Some(&(_, slot)) = inputs.iter().find(|(p, _)| *p == v) else { return false };
        self.memory[slot as usize] = value;
        self.free_buffers.clear();
        true
    }

    /// Overrides a start value; false if it is not an input of the program.
    pub fn set_start(&mut self, v: VarId, value: f64) -> bool {
        let starts = &self.program.layout.starts;
        let Some(&(_, slot, _)) = starts.iter().find(|(s, ..)| *s == v) else { return false };
        self.memory[slot as usize] = value;
        true
    }

    /// The value in a slot.
    #[inline]
    pub fn get(&self, slot: Slot) -> f64 {
        self.memory[slot as usize]
    }

    /// Sets a slot.
    #[inline]
    pub fn set(&mut self, slot: Slot, value: f64) {
        self.memory[slot as usize] = value;
    }

    /// Copies a slot, and its derivatives if they are propagated.
    #[inline]
    pub fn copy(&mut self, to: Slot, from: Slot) {
        self.memory[to as usize] = self.memory[from as usize];
        if let Some(tangents) = &mut self.tangents {
            tangents.copy(to, from);
        }
    }

    /// The value of a variable.
    pub fn value(&self, v: VarId) -> f64 {
        self.memory[self.program.layout.variables[v.idx()] as usize]
    }

    /// Sets time and states, and the signals that depend on them.
    pub fn set_point(&mut self, t: f64, states: &[f64]) {
        let layout = &self.program.layout;
        self.memory[layout.time as usize] = t;
        self.input_signals.write_slots(t, &mut self.memory);
        self.delays.write_slots(t, &mut self.memory);
        self.transports.write_slots(&mut self.memory);
        let first = layout.states as usize;
        self.memory[first..first + states.len()].copy_from_slice(states);
    }

    /// Drives inputs by recorded signals from the instant `t` on.
    pub fn set_input_signals(&mut self, signals: &[(VarId, Arc<TimeSeries>)], t: f64) {
        self.input_signals = InputSignals::new(self.program, signals, t);
        self.delays.leave_inputs(|input| signals.iter().any(|(v, _)| *v == input));
        self.input_signals.write_slots(t, &mut self.memory);
        self.delays.write_slots(t, &mut self.memory);
    }

    /// True if the model reads past values.
    pub fn has_history(&self) -> bool {
        !(self.delays.is_empty() && self.transports.is_empty())
    }

    /// True if values between events must be recorded in a history.
    pub fn records_history(&self) -> bool {
        self.delays.moves() || !self.transports.is_empty()
    }

    /// The states.
    pub fn states(&self) -> &[f64] {
        let first = self.program.layout.states as usize;
        &self.memory[first..first + self.program.order()]
    }

    /// Derivatives at `(t, states)`.
    pub fn derivatives(&mut self, t: f64, states: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        self.set_point(t, states);
        self.run(&self.program.tapes.rhs)?;
        let slots = &self.program.layout.derivatives;
        for (state, (d, slot)) in out.iter_mut().zip(slots).enumerate() {
            *d = self.memory[*slot as usize];
            if !d.is_finite() {
                return Err(self.fail(Fault::Derivative { state }));
            }
        }
        Ok(())
    }

    /// Records a fault with the current memory, for the message.
    pub fn fail(&mut self, fault: Fault) -> Fault {
        self.fault_memory.copy_from_slice(&self.memory);
        self.fault = Some(fault);
        self.endless_calls += u32::from(matches!(fault, Fault::NonTerminating { .. }));
        fault
    }

    /// Executes a tape, then propagates its derivatives if requested.
    pub fn run(&mut self, tape: &'p Tape) -> Result<(), Fault> {
        if let Some(mut tangents) = self.tangents.take() {
            let outcome = self.run(tape).and_then(|()| tangents.propagate_tape(self, tape));
            self.tangents = Some(tangents);
            return outcome;
        }
        if std::ptr::eq(tape, &self.program.tapes.parameters) {
            self.free_buffers.clear();
        }
        if self.clamp_domain {
            return self.interpret::<true>(tape);
        }
        match tape.number {
            Some(number) if self.is_compiled(tape.len()) => self.run_machine_code(number),
            _ => self.interpret::<false>(tape),
        }
    }

    /// True if machine code is available; the instructions that functions have executed since the
    /// last tape count as interpreted too.
    #[inline]
    fn is_compiled(&mut self, instructions: usize) -> bool {
        let inside = std::mem::take(&mut self.executed_in_functions);
        self.tier.is_compiled(self.program, instructions + inside)
    }

    /// Executes the machine code of a tape, and interprets the instructions between its fragments.
    fn run_machine_code(&mut self, number: u32) -> Result<(), Fault> {
        let mut at = 0;
        while let Tier::Compiled(code, memo) = &mut self.tier {
            match code.run(number, at, &mut self.memory, memo) {
                Ok(None) => break,
                Ok(Some((instruction, next))) => {
                    at = next;
                    self.execute::<false>(&instruction)?;
                }
                Err(fault) => return Err(self.fail(fault)),
            }
        }
        Ok(())
    }

    fn interpret<const CLAMP: bool>(&mut self, tape: &'p [Instr]) -> Result<(), Fault> {
        let mut rest = tape;
        if !CLAMP {
            rest = compute_first(&mut self.memory, rest, self.program.externals());
        }
        while let Some((i, next)) = rest.split_first() {
            self.execute::<CLAMP>(i)?;
            rest = match CLAMP {
                true => next,
                false => compute_first(&mut self.memory, next, self.program.externals()),
            };
        }
        Ok(())
    }

    #[inline(always)]
    fn execute<const CLAMP: bool>(&mut self, i: &Instr) -> Result<(), Fault> {
        match i.op {
            Op::Solve => self.solve(i.a as usize),
            Op::Differentiate => self.differentiate(i.a as usize),
            Op::Iterate => self.iterate(i.a as usize),
            Op::Call => self.call(i.a as usize),
            Op::Unary(Unary::Carried(what)) => {
                let place = self.memory[i.a as usize];
                self.memory[i.dst as usize] = self.transports.read(what, place);
                Ok(())
            }
            _ => {
                compute::<CLAMP>(&mut self.memory, i, self.program.externals());
                Ok(())
            }
        }
    }

    fn solve(&mut self, k: usize) -> Result<(), Fault> {
        let Some(mut work) = self.torn_solvers[k].take() else { return Ok(()) };
        let outcome = work.solve(self, k).map_err(|fault| self.fail(fault));
        if outcome.is_err() {
            work.restore(&self.program.routines.torn_blocks[k], &mut self.memory);
            self.failed_block = Some(k);
        }
        self.torn_solvers[k] = Some(work);
        outcome
    }

    fn differentiate(&mut self, k: usize) -> Result<(), Fault> {
        let Some(mut work) = self.derivative_solvers[k].take() else { return Ok(()) };
        let outcome =
            work.differentiate(&self.program.routines.block_derivatives[k], &mut self.memory);
        self.derivative_solvers[k] = Some(work);
        outcome.map_err(|fault| self.fail(fault))
    }

    fn iterate(&mut self, k: usize) -> Result<(), Fault> {
        let Some(mut work) = self.mixed_solvers[k].take() else { return Ok(()) };
        let outcome = work.iterate_block(self, k);
        self.mixed_solvers[k] = Some(work);
        outcome
    }

    /// Saves memory and fault of a failed attempt in case the next one fails too. Pass the result
    /// to [`Machine::restore_fault`] or [`Machine::discard_fault`].
    pub fn save_fault(&mut self) -> FaultSnapshot {
        let memory = self.snapshot();
        let fault_memory = self.fault_memory.clone();
        FaultSnapshot { memory, fault_memory, fault: self.fault }
    }

    /// Restores memory and fault of a failed attempt.
    pub fn restore_fault(&mut self, mut saved: FaultSnapshot) {
        std::mem::swap(&mut self.memory, &mut saved.memory);
        std::mem::swap(&mut self.fault_memory, &mut saved.fault_memory);
        self.fault = saved.fault;
        self.recycle(saved.memory);
    }

    /// Discards a failed attempt after another one has succeeded.
    pub fn discard_fault(&mut self, saved: FaultSnapshot) {
        self.fault = None;
        self.recycle(saved.memory);
    }

    /// A copy of the memory; return its buffer by [`Machine::recycle`].
    pub fn snapshot(&mut self) -> Vec<f64> {
        match self.free_buffers.pop() {
            // It has the parameters already.
            Some(mut copy) => {
                self.save_to(&mut copy);
                copy
            }
            None => self.memory.clone(),
        }
    }

    /// Copies the memory without the parameters, which do not change during a run.
    pub fn save_to(&self, copy: &mut [f64]) {
        copy_but_parameters(self.program, copy, &self.memory);
    }

    /// Restores a copy of the memory that was made in the same run.
    pub fn restore_from(&mut self, copy: &[f64]) {
        copy_but_parameters(self.program, &mut self.memory, copy);
    }

    /// Returns the buffer of a snapshot for reuse.
    pub fn recycle(&mut self, copy: Vec<f64>) {
        if copy.len() == self.memory.len() {
            self.free_buffers.push(copy);
        }
    }

    fn call(&mut self, k: usize) -> Result<(), Fault> {
        let program = self.program;
        let site = &program.routines.calls[k];
        if !self.is_needed(site) || self.is_memoized(site) {
            return Ok(());
        }
        match site.partial {
            None => {
                self.enter(site, None)?;
                let outputs = &program.routines.functions[site.function].outputs;
                for (to, from) in site.results.iter().zip(outputs) {
                    self.memory[*to as usize] = self.memory[*from as usize];
                }
            }
            Some((output, arg)) => {
                let out = program.routines.functions[site.function].outputs[output] as usize;
                let x = self.memory[site.args[arg] as usize];
                let h = DIFFERENCE * if x == 0.0 { 1.0 } else { x.abs() };
                self.enter(site, Some((arg, x + h)))?;
                let above = self.memory[out];
                self.enter(site, Some((arg, x - h)))?;
                let below = self.memory[out];
                self.memory[site.results[0] as usize] = (above - below) / ((x + h) - (x - h));
            }
        }
        self.memoize(site);
        Ok(())
    }

    /// True if the condition of a call holds.
    pub fn is_needed(&self, site: &CallSite) -> bool {
        site.condition.is_none_or(|guard| self.get(guard) != 0.0)
    }

    /// True if the last call had the same arguments, so its results are still valid.
    fn is_memoized(&self, site: &CallSite) -> bool {
        let Some(last) = site.memo.filter(|_| !self.clamp_domain) else { return false };
        let copy = &self.memory[last as usize..][..site.args.len()];
        copy.iter().zip(&site.args).all(|(k, a)| k.to_bits() == self.memory[*a as usize].to_bits())
    }

    fn memoize(&mut self, site: &CallSite) {
        let Some(last) = site.memo else { return };
        for (k, arg) in site.args.iter().enumerate() {
            self.memory[last as usize + k] = self.memory[*arg as usize];
        }
        if self.clamp_domain {
            // Results of clamped arguments must not be reused.
            self.memory[last as usize] = f64::NAN;
        }
    }

    /// Executes the body of a function, optionally with one argument replaced.
    fn enter(&mut self, site: &CallSite, replaced: Option<(usize, f64)>) -> Result<(), Fault> {
        let function = &self.program.routines.functions[site.function];
        for local in &function.locals {
            self.memory[*local as usize] = 0.0;
        }
        for (i, (to, from)) in function.inputs.iter().zip(&site.args).enumerate() {
            self.memory[*to as usize] = match replaced {
                Some((arg, value)) if arg == i => value,
                _ => self.memory[*from as usize],
            };
        }
        let depth = self.frames.depth();
        self.run_body(site.function, depth).inspect_err(|_| self.frames.unwind(depth))
    }

    /// Executes a function whose inputs are set, and its recursive calls; `depth` frames are open
    /// on entry.
    fn run_body(&mut self, mut function: usize, depth: usize) -> Result<(), Fault> {
        let program = self.program;
        let mut tape = &program.routines.functions[function].tape;
        let (mut at, mut jumps, mut executed) = (0, 0, 0);
        loop {
            let Some(i) = tape.get(at) else {
                if self.frames.depth() == depth {
                    self.executed_in_functions += executed;
                    return Ok(());
                }
                let back = self.frames.pop(program, &mut self.memory, 1);
                (function, at) = back.unwrap_or((function, at));
                tape = &program.routines.functions[function].tape;
                continue;
            };
            at += 1;
            executed += 1;
            match i.op {
                Op::Jump => {
                    at = i.a as usize;
                    jumps += 1;
                }
                Op::JumpUnless if self.memory[i.a as usize] == 0.0 => at = i.b as usize,
                Op::JumpUnless => {}
                Op::Assert => {
                    if self.memory[i.a as usize] == 0.0 {
                        let message = i.b as usize;
                        return Err(self.fail(Fault::Assertion { function, message }));
                    }
                }
                Op::Call if program.is_recursive_call(i.a as usize) => {
                    let back = (function, at);
                    if !self.frames.push(program, i.a as usize, back, &mut self.memory, 1) {
                        return Err(self.fail(Fault::NonTerminating { function }));
                    }
                    (function, at) = (program.routines.calls[i.a as usize].function, 0);
                    tape = &program.routines.functions[function].tape;
                    jumps += 1;
                }
                Op::Call => self.call(i.a as usize)?,
                _ if self.clamp_domain => compute::<true>(&mut self.memory, i, program.externals()),
                _ => compute::<false>(&mut self.memory, i, program.externals()),
            }
            if jumps > JUMP_LIMIT {
                return Err(self.fail(Fault::NonTerminating { function }));
            }
        }
    }
}

/// Executes the instructions before the first that needs the machine, and returns the others. Most of the time of an
/// interpreted run passes here: an instruction is one jump.
fn compute_first<'a>(memory: &mut [f64], tape: &'a [Instr], externals: &Externals) -> &'a [Instr] {
    for (k, i) in tape.iter().enumerate() {
        // The number of a block or a call need not be that of a slot.
        let (Some(&a), Some(&b)) = (memory.get(i.a as usize), memory.get(i.b as usize)) else {
            return &tape[k..];
        };
        memory[i.dst as usize] = match i.op {
            Op::Copy => a,
            Op::CopyIf if a == 0.0 => continue,
            Op::CopyIf => b,
            Op::Add => a + b,
            Op::Sub => a - b,
            Op::Mul => a * b,
            Op::Div => a / b,
            Op::Neg => -a,
            Op::Unary(Unary::Carried(_)) => return &tape[k..],
            Op::Unary(op) => eval::unary_inlined(op, a, externals),
            Op::Binary(op) => eval::binary_inlined(op, a, b, externals),
            Op::Input if b.is_nan() => a,
            Op::Input => b,
            Op::Solve | Op::Differentiate | Op::Iterate | Op::Call => return &tape[k..],
            Op::Jump | Op::JumpUnless | Op::Assert => return &tape[k..],
        };
    }
    &[]
}

/// Executes an instruction without control flow or calls.
#[inline(always)]
pub fn compute<const CLAMP: bool>(memory: &mut [f64], i: &Instr, externals: &Externals) {
    let (a, b) = (memory[i.a as usize], memory[i.b as usize]);
    memory[i.dst as usize] = match i.op {
        Op::Copy => a,
        Op::CopyIf => {
            if a != 0.0 {
                b
            } else {
                return;
            }
        }
        Op::Input => {
            if b.is_nan() {
                a
            } else {
                b
            }
        }
        Op::Add => a + b,
        Op::Sub => a - b,
        Op::Mul => a * b,
        // With clamped arguments a quotient may become 0 / 0.
        Op::Div if CLAMP && a == 0.0 && b == 0.0 => 0.0,
        Op::Div => a / b,
        Op::Neg => -a,
        Op::Unary(op) if CLAMP => eval::unary_inside(op, a, externals),
        Op::Binary(op) if CLAMP => eval::binary_inside(op, a, b, externals),
        Op::Unary(op) => eval::unary(op, a, externals),
        Op::Binary(op) => eval::binary(op, a, b, externals),
        // Executed by the callers.
        Op::Solve | Op::Differentiate | Op::Iterate | Op::Call => return,
        Op::Jump | Op::JumpUnless | Op::Assert => return,
    };
}
