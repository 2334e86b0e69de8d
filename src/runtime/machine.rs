//! One run of a program in its own memory, and the reference interpreter.
//!
//! Where there is machine code it does what is straight; the interpreter does it otherwise.

use std::sync::Arc;

use crate::base::index::Id;
use crate::ir::expr::{Unary, VarId};
use crate::ir::program::{CallSite, Instr, Op, Program, Slot, Tape};
use crate::numeric::time_series::TimeSeries;
use crate::symbolic::eval;

use super::delay::Delayed;
use super::frame::Frames;
use super::input_signals::Played;
use super::jit::tiering::{Code, Execution};
use super::mixed_block::MixedWork;
use super::spatial_distribution::Transports;
use super::tangent::Tangents;
use super::torn_block::{ImplicitWork, SolverWork};

/// Jumps within one call of a function before it is given up.
pub const JUMP_LIMIT: u32 = 100_000_000;

/// Displacement of an argument, relative to its size, by which a function is differentiated: the
/// cube root of the rounding unit balances truncation (h^2) against rounding (eps / h).
pub const DIFFERENCE: f64 = 6.055454452393343e-6;

/// Why a tape could not be run to its end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fault {
    /// The matrix of a torn block is singular.
    Singular {
        /// The block.
        solver: usize,
        /// Position of the unknown that is not determined.
        unknown: usize,
    },
    /// The Newton iteration of a torn block does not converge.
    Diverged {
        /// The block.
        solver: usize,
        /// Position of the unknown that changes most.
        unknown: usize,
    },
    /// A residual of a torn block is not finite.
    NotFinite {
        /// The block.
        solver: usize,
        /// Position of the residual.
        residual: usize,
    },
    /// A mixed block does not come to rest.
    Restless {
        /// The block.
        mixed: usize,
        /// Position of what changes still.
        watched: usize,
    },
    /// An assertion in a function failed.
    Assertion {
        /// The function.
        function: usize,
        /// Position of its message.
        message: usize,
    },
    /// A function does not return.
    Endless {
        /// The function.
        function: usize,
    },
    /// A derivative is not finite.
    Derivative {
        /// Position of the state.
        state: usize,
    },
}

/// One run of a program. Nothing is allocated after `new`, but for functions that call themselves.
pub struct Instance<'p> {
    /// What runs.
    pub program: &'p Program,
    /// All values, by cell.
    pub memory: Vec<f64>,
    /// The values when the last fault happened.
    pub fault_memory: Vec<f64>,
    /// The last fault.
    pub fault: Option<Fault>,
    /// Where the branch of a solution has come to its end, another one may be taken. An integrator first
    /// tries whether a shorter step stays on the branch.
    pub leaps: bool,
    /// Arguments outside of the domain of a function are moved to its border.
    pub inside: bool,
    /// Mixed blocks are run once and not until they rest, and equations that contradict each other are
    /// fulfilled as well as can be: on the way to values with which they do not.
    pub relaxed: bool,
    /// What was run while relaxed does not rest yet.
    pub moved: bool,
    code: Code,
    /// While it is here, every tape that runs is followed by its derivatives.
    pub tangents: Option<Box<Tangents>>,
    /// A linear block, and the position of an unknown in it, that was solved though it does not determine
    /// that unknown. Cleared by whoever takes note of it.
    pub undetermined: Option<(usize, usize)>,
    /// What assertions of when-clauses say without a failure, by their position, since whoever runs this has
    /// taken note of it.
    pub said: Vec<(usize, String)>,
    /// What recordings say about inputs.
    pub played: Played,
    /// What expressions were some time ago.
    pub delayed: Delayed,
    /// What is carried along lines.
    pub transports: Transports,
    /// Values of the relations that the event sequence reads too early, as they were found by a search,
    /// the last ones first.
    pub confirmed: Vec<Vec<f64>>,
    solvers: Vec<Option<Box<SolverWork>>>,
    implicits: Vec<Option<Box<ImplicitWork>>>,
    mixed: Vec<Option<Box<MixedWork>>>,
    spare: Vec<Vec<f64>>,
    /// Calls in which a function has called itself.
    pub(crate) frames: Frames,
}

/// What a failed attempt left.
pub struct Told {
    memory: Vec<f64>,
    fault_memory: Vec<f64>,
    fault: Option<Fault>,
}

impl<'p> Instance<'p> {
    /// A run that has not begun, and will be interpreted.
    pub fn new(program: &'p Program) -> Self {
        Instance {
            program,
            memory: program.image.clone(),
            fault_memory: program.image.clone(),
            fault: None,
            leaps: true,
            inside: false,
            relaxed: false,
            moved: false,
            undetermined: None,
            code: Code::Interpreted,
            tangents: None,
            said: Vec::new(),
            played: Played::default(),
            delayed: Delayed::new(&program.layout),
            transports: Transports::new(&program.layout),
            solvers: program.solvers.iter().map(|s| Some(Box::new(SolverWork::new(s)))).collect(),
            implicits: program
                .implicits
                .iter()
                .map(|s| Some(Box::new(ImplicitWork::new(s))))
                .collect(),
            mixed: (0..program.loops.len())
                .map(|k| Some(Box::new(MixedWork::new(program, k))))
                .collect(),
            confirmed: Vec::new(),
            spare: Vec::new(),
            frames: Frames::default(),
        }
    }

    /// Computes in this way from now on.
    pub fn execute(&mut self, execution: &Execution) {
        self.code = Code::of(self.program, execution);
    }

    /// True once tapes run as machine code.
    pub fn runs_machine_code(&self) -> bool {
        matches!(self.code, Code::Machine(..))
    }

    /// Gives a parameter another value than its own; false if it is not an input of the program.
    pub fn set_parameter(&mut self, v: VarId, value: f64) -> bool {
        let inputs = &self.program.layout.parameter_inputs;
        let Some(&(_, cell)) = inputs.iter().find(|(p, _)| *p == v) else { return false };
        self.memory[cell as usize] = value;
        true
    }

    /// Gives a variable another start value than its own; false if it is not an input.
    pub fn set_start(&mut self, v: VarId, value: f64) -> bool {
        let starts = &self.program.layout.starts;
        let Some(&(_, cell, _)) = starts.iter().find(|(s, ..)| *s == v) else { return false };
        self.memory[cell as usize] = value;
        true
    }

    /// The value in a cell.
    #[inline]
    pub fn get(&self, slot: Slot) -> f64 {
        self.memory[slot as usize]
    }

    /// Sets a cell.
    #[inline]
    pub fn set(&mut self, slot: Slot, value: f64) {
        self.memory[slot as usize] = value;
    }

    /// Copies a cell, and its derivatives if they are followed.
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

    /// Sets time and states.
    pub fn place(&mut self, t: f64, states: &[f64]) {
        let layout = &self.program.layout;
        self.memory[layout.time as usize] = t;
        self.played.place(t, &mut self.memory);
        self.delayed.place(t, &mut self.memory);
        self.transports.place(&mut self.memory);
        let first = layout.states as usize;
        self.memory[first..first + states.len()].copy_from_slice(states);
    }

    /// Gives inputs the courses of recordings, from the instant `t` on.
    pub fn play(&mut self, courses: &[(VarId, Arc<TimeSeries>)], t: f64) {
        self.played = Played::new(&self.program.layout, courses, t);
        self.played.place(t, &mut self.memory);
        self.delayed.place(t, &mut self.memory);
    }

    /// True if something is read of the past.
    pub fn looks_back(&self) -> bool {
        !(self.delayed.is_empty() && self.transports.is_empty())
    }

    /// True if the course between events is read later.
    pub fn keeps_courses(&self) -> bool {
        self.delayed.moves() || !self.transports.is_empty()
    }

    /// The states.
    pub fn states(&self) -> &[f64] {
        let first = self.program.layout.states as usize;
        &self.memory[first..first + self.program.order()]
    }

    /// Derivatives at `(t, states)`.
    pub fn derivatives(&mut self, t: f64, states: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        self.place(t, states);
        self.run(&self.program.rhs)?;
        let slots = &self.program.layout.derivatives;
        for (state, (d, slot)) in out.iter_mut().zip(slots).enumerate() {
            *d = self.memory[*slot as usize];
            if !d.is_finite() {
                return Err(self.fail(Fault::Derivative { state }));
            }
        }
        Ok(())
    }

    /// Keeps the memory as it is at a fault, for the message.
    pub fn fail(&mut self, fault: Fault) -> Fault {
        self.fault_memory.copy_from_slice(&self.memory);
        self.fault = Some(fault);
        fault
    }

    /// Runs a tape, and after it its derivatives if they are followed.
    pub fn run(&mut self, tape: &'p Tape) -> Result<(), Fault> {
        if let Some(mut tangents) = self.tangents.take() {
            let outcome = self.run(tape).and_then(|()| tangents.follow(self, tape));
            self.tangents = Some(tangents);
            return outcome;
        }
        if self.inside {
            return self.run_in::<true>(tape);
        }
        match tape.number {
            Some(number) if self.code.is_there(self.program, tape.len()) => {
                self.run_machine_code(number)
            }
            _ => self.run_in::<false>(tape),
        }
    }

    /// Runs the machine code of a tape, if there is any, and what stands between its pieces.
    fn run_machine_code(&mut self, number: u32) -> Result<(), Fault> {
        let mut at = 0;
        while let Code::Machine(code, memo) = &mut self.code {
            match code.run(number, at, &mut self.memory, memo) {
                Ok(None) => break,
                Ok(Some((between, next))) => {
                    at = next;
                    self.perform::<false>(&between)?;
                }
                Err(fault) => return Err(self.fail(fault)),
            }
        }
        Ok(())
    }

    fn run_in<const INSIDE: bool>(&mut self, tape: &'p [Instr]) -> Result<(), Fault> {
        for i in tape {
            self.perform::<INSIDE>(i)?;
        }
        Ok(())
    }

    #[inline(always)]
    fn perform<const INSIDE: bool>(&mut self, i: &Instr) -> Result<(), Fault> {
        match i.op {
            Op::Solve => self.solve(i.a as usize),
            Op::Implicit => self.differentiate(i.a as usize),
            Op::Repeat => self.repeat(i.a as usize),
            Op::Call => self.call(i.a as usize),
            Op::Unary(Unary::Carried(what)) => {
                let place = self.memory[i.a as usize];
                self.memory[i.dst as usize] = self.transports.read(what, place);
                Ok(())
            }
            _ => {
                step::<INSIDE>(&mut self.memory, i);
                Ok(())
            }
        }
    }

    fn solve(&mut self, k: usize) -> Result<(), Fault> {
        let Some(mut work) = self.solvers[k].take() else { return Ok(()) };
        let outcome = work.solve(self, k).map_err(|fault| self.fail(fault));
        if outcome.is_err() {
            work.restore(&self.program.solvers[k], &mut self.memory);
        }
        self.solvers[k] = Some(work);
        outcome
    }

    fn differentiate(&mut self, k: usize) -> Result<(), Fault> {
        let Some(mut work) = self.implicits[k].take() else { return Ok(()) };
        let outcome = work.differentiate(&self.program.implicits[k], &mut self.memory);
        self.implicits[k] = Some(work);
        outcome.map_err(|fault| self.fail(fault))
    }

    fn repeat(&mut self, k: usize) -> Result<(), Fault> {
        let Some(mut work) = self.mixed[k].take() else { return Ok(()) };
        let outcome = work.repeat(self, k);
        self.mixed[k] = Some(work);
        outcome
    }

    /// What a failed attempt left, for when a further one fails too: to be given to [`Instance::tell`] or
    /// [`Instance::forget`].
    pub fn told(&mut self) -> Told {
        let memory = self.keep();
        let mut fault_memory = self.spare.pop().unwrap_or_default();
        fault_memory.clone_from(&self.fault_memory);
        Told { memory, fault_memory, fault: self.fault }
    }

    /// Takes back what an attempt left.
    pub fn tell(&mut self, mut told: Told) {
        std::mem::swap(&mut self.memory, &mut told.memory);
        std::mem::swap(&mut self.fault_memory, &mut told.fault_memory);
        self.fault = told.fault;
        self.release(told.memory);
        self.release(told.fault_memory);
    }

    /// Another attempt came to its end.
    pub fn forget(&mut self, told: Told) {
        self.fault = None;
        self.release(told.memory);
        self.release(told.fault_memory);
    }

    /// The values of all cells as they are, to be given back by [`Instance::release`].
    pub fn keep(&mut self) -> Vec<f64> {
        let mut kept = self.spare.pop().unwrap_or_default();
        kept.clear();
        kept.extend_from_slice(&self.memory);
        kept
    }

    /// Gives back what was kept, whose room is used again.
    pub fn release(&mut self, kept: Vec<f64>) {
        self.spare.push(kept);
    }

    fn call(&mut self, k: usize) -> Result<(), Fault> {
        let program = self.program;
        let site = &program.calls[k];
        if !self.needs(site) || self.remembers(site) {
            return Ok(());
        }
        match site.partial {
            None => {
                self.enter(site, None)?;
                let outputs = &program.functions[site.function].outputs;
                for (to, from) in site.results.iter().zip(outputs) {
                    self.memory[*to as usize] = self.memory[*from as usize];
                }
            }
            Some((output, arg)) => {
                let out = program.functions[site.function].outputs[output] as usize;
                let x = self.memory[site.args[arg] as usize];
                let h = DIFFERENCE * if x == 0.0 { 1.0 } else { x.abs() };
                self.enter(site, Some((arg, x + h)))?;
                let above = self.memory[out];
                self.enter(site, Some((arg, x - h)))?;
                let below = self.memory[out];
                self.memory[site.results[0] as usize] = (above - below) / ((x + h) - (x - h));
            }
        }
        self.remember(site);
        Ok(())
    }

    /// True if the results of a call are read.
    pub fn needs(&self, site: &CallSite) -> bool {
        site.guard.is_none_or(|guard| self.get(guard) != 0.0)
    }

    /// True if the results of a call are there from the last one, which had the same arguments.
    fn remembers(&self, site: &CallSite) -> bool {
        let Some(last) = site.last.filter(|_| !self.inside) else { return false };
        let kept = &self.memory[last as usize..][..site.args.len()];
        kept.iter().zip(&site.args).all(|(k, a)| k.to_bits() == self.memory[*a as usize].to_bits())
    }

    fn remember(&mut self, site: &CallSite) {
        let Some(last) = site.last else { return };
        for (k, arg) in site.args.iter().enumerate() {
            self.memory[last as usize + k] = self.memory[*arg as usize];
        }
        if self.inside {
            // Results from the border of a domain.
            self.memory[last as usize] = f64::NAN;
        }
    }

    /// Runs the body of a function, perhaps with another value for one argument.
    fn enter(&mut self, site: &CallSite, moved: Option<(usize, f64)>) -> Result<(), Fault> {
        let function = &self.program.functions[site.function];
        for local in &function.locals {
            self.memory[*local as usize] = 0.0;
        }
        for (i, (to, from)) in function.inputs.iter().zip(&site.args).enumerate() {
            self.memory[*to as usize] = match moved {
                Some((arg, value)) if arg == i => value,
                _ => self.memory[*from as usize],
            };
        }
        let depth = self.frames.depth();
        self.body(site.function, depth).inspect_err(|_| self.frames.give_up(depth))
    }

    /// Runs a function whose inputs have their values, and calls that it makes of itself: `depth` are open
    /// before.
    fn body(&mut self, mut function: usize, depth: usize) -> Result<(), Fault> {
        let program = self.program;
        let mut tape = &program.functions[function].tape;
        let (mut at, mut jumps) = (0, 0);
        loop {
            let Some(i) = tape.get(at) else {
                if self.frames.depth() == depth {
                    return Ok(());
                }
                let back = self.frames.leave(program, &mut self.memory, 1);
                (function, at) = back.unwrap_or((function, at));
                tape = &program.functions[function].tape;
                continue;
            };
            at += 1;
            match i.op {
                Op::Jump => at = i.a as usize,
                Op::JumpUnless if self.memory[i.a as usize] == 0.0 => at = i.b as usize,
                Op::JumpUnless => {}
                Op::Assert => {
                    if self.memory[i.a as usize] == 0.0 {
                        let message = i.b as usize;
                        return Err(self.fail(Fault::Assertion { function, message }));
                    }
                }
                Op::Call if program.calls_itself(i.a as usize) => {
                    let back = (function, at);
                    if !self.frames.enter(program, i.a as usize, back, &mut self.memory, 1) {
                        return Err(self.fail(Fault::Endless { function }));
                    }
                    (function, at) = (program.calls[i.a as usize].function, 0);
                    tape = &program.functions[function].tape;
                    jumps += 1;
                }
                Op::Call => self.call(i.a as usize)?,
                _ if self.inside => step::<true>(&mut self.memory, i),
                _ => step::<false>(&mut self.memory, i),
            }
            jumps += u32::from(i.op == Op::Jump);
            if jumps > JUMP_LIMIT {
                return Err(self.fail(Fault::Endless { function }));
            }
        }
    }
}

/// An instruction that only computes.
#[inline(always)]
pub fn step<const INSIDE: bool>(memory: &mut [f64], i: &Instr) {
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
        // At the border of a domain a quotient may vanish above and below.
        Op::Div if INSIDE && a == 0.0 && b == 0.0 => 0.0,
        Op::Div => a / b,
        Op::Neg => -a,
        Op::Unary(op) if INSIDE => eval::unary_inside(op, a),
        Op::Binary(op) if INSIDE => eval::binary_inside(op, a, b),
        Op::Unary(op) => eval::unary(op, a),
        Op::Binary(op) => eval::binary(op, a, b),
        // Handled by the callers.
        Op::Solve | Op::Implicit | Op::Repeat | Op::Call => return,
        Op::Jump | Op::JumpUnless | Op::Assert => return,
    };
}
