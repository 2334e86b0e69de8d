//! The compiled model: flat tapes over one array of doubles.
//!
//! *Holds:* the memory map, tapes of three-address instructions by variability, torn blocks and
//! loops that tapes refer to, and what the run must watch (relations, clocks, reinits, asserts).
//! Parameters and start values are cells of the memory, so one program serves many runs and threads.
//! *Never holds:* anything that a run changes; trees to be walked while running; texts outside of
//! [`Program::blocks`], which is kept for messages only.
//! *Made by:* `codegen`. *Read by:* `codegen::interp`, `simulate`.
//!
//! Truth values are 0 and 1, enumeration literals and texts their number. Every temporary has a cell of its
//! own: what a tape computed stays readable until the same tape runs again.
//!
//! Order of running, from rare to frequent: `parameters` once; `initial` once; `event` in each event
//! iteration; `held` after each event; `rhs` at each evaluation of derivatives; at the same point
//! then `jacobian`, or `roots` and after it `rest`; `selection` after each step.

use std::ops::{Deref, DerefMut};

use super::blocks::{Blocks, Source};
use super::dae::Dae;
use super::expr::{Binary, ExprId, Unary, VarId};
use crate::base::source::Span;

/// A cell of the memory.
pub type Slot = u32;

/// What an instruction does with the cells `dst`, `a` and `b`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Op {
    /// `dst := a`
    Copy,
    /// `if a then dst := b`; after a `Copy` the two make a selection.
    CopyIf,
    /// `dst := b`, or `a` where `b` is NaN: an input that was not given has its default.
    Input,
    /// `dst := a + b`
    Add,
    /// `dst := a - b`
    Sub,
    /// `dst := a * b`
    Mul,
    /// `dst := a / b`
    Div,
    /// `dst := -a`
    Neg,
    /// `dst := op(a)`
    Unary(Unary),
    /// `dst := op(a, b)`
    Binary(Binary),
    /// Solves torn block `a`.
    Solve,
    /// Differentiates torn block `a` by the implicit function theorem.
    Implicit,
    /// Repeats loop `a` until its watched cells rest.
    Repeat,
    /// Calls call site `a`.
    Call,
    /// Goes to instruction `a` of the same tape. In functions only.
    Jump,
    /// Goes to instruction `b` if cell `a` is zero. In functions only.
    JumpUnless,
    /// Fails with message `b` of the function if cell `a` is zero. In functions only.
    Assert,
}

/// One instruction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Instr {
    /// What it does.
    pub op: Op,
    /// The cell that it writes.
    pub dst: Slot,
    /// First operand.
    pub a: Slot,
    /// Second operand.
    pub b: Slot,
}

/// A straight sequence of instructions, which it derefs to.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Tape {
    code: Vec<Instr>,
    /// Its position among [`Program::tapes`], by which machine code is found; none while it is made.
    pub number: Option<u32>,
}

impl From<Vec<Instr>> for Tape {
    fn from(code: Vec<Instr>) -> Self {
        Tape { code, number: None }
    }
}

impl Deref for Tape {
    type Target = Vec<Instr>;
    fn deref(&self) -> &Vec<Instr> {
        &self.code
    }
}

impl DerefMut for Tape {
    fn deref_mut(&mut self) -> &mut Vec<Instr> {
        &mut self.code
    }
}

/// An entry of a matrix.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Entry {
    /// Row.
    pub row: u32,
    /// Column.
    pub column: u32,
    /// Cell of the value.
    pub slot: Slot,
}

/// A torn block: find the unknowns for which the residuals vanish.
#[derive(Clone, Debug)]
pub struct Solver {
    /// Tearing variables.
    pub unknowns: Vec<VarId>,
    /// Their cells.
    pub slots: Vec<Slot>,
    /// Computes the explicit variables and the residuals from the unknowns.
    pub residual_tape: Tape,
    /// Cells of the residuals.
    pub residuals: Vec<Slot>,
    /// Computes the entries of the Jacobian; runs after `residual_tape`.
    pub jacobian_tape: Tape,
    /// The entries that can differ from zero.
    pub jacobian: Vec<Entry>,
    /// Cells of the typical sizes of the unknowns.
    pub nominals: Vec<Slot>,
    /// Cells of the least and the greatest value of the unknowns.
    pub bounds: Vec<(Slot, Slot)>,
    /// Solved by one linear solution instead of Newton iterations.
    pub linear: bool,
    /// The block this was made from.
    pub place: BlockPlace,
}

/// The derivatives of the unknowns `z` of a torn block by outer seeds: `J dz = -B`.
#[derive(Clone, Debug)]
pub struct Implicit {
    /// Which block, for messages.
    pub solver: u32,
    /// Order of `J`.
    pub order: usize,
    /// `J`
    pub jacobian: Vec<Entry>,
    /// `B`, row by equation, column by seed.
    pub seeds: Vec<Entry>,
    /// Cells of the results, column by column.
    pub results: Vec<Slot>,
}

/// A mixed block: the tape is repeated until the watched cells do not change.
#[derive(Clone, Debug)]
pub struct Loop {
    /// One repetition.
    pub tape: Tape,
    /// Discrete variables and relations inside, with what they are.
    pub watched: Vec<Watched>,
    /// The block this was made from.
    pub place: BlockPlace,
}

/// Something discrete that must come to rest.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Watched {
    /// A discrete variable.
    Variable(VarId, Slot),
    /// A relation.
    Relation(u32, Slot),
}

/// One of the three sequences of [`Blocks`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sequence {
    /// `blocks.initial`
    Initial,
    /// `blocks.event`
    Event,
    /// `blocks.continuous`
    Continuous,
}

/// Position of a block, for messages.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BlockPlace {
    /// The sequence.
    pub sequence: Sequence,
    /// Index of the outermost block in it.
    pub index: usize,
}

/// A call of a run-time function.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CallSite {
    /// Position in [`Program::functions`].
    pub function: usize,
    /// Cells of the arguments.
    pub args: Vec<Slot>,
    /// Cells of all outputs; of the one partial derivative if `partial` is given.
    pub results: Vec<Slot>,
    /// Output and argument of a partial derivative, taken by central differences.
    pub partial: Option<(usize, usize)>,
    /// The cell of the condition under which the results are read: without it nothing is done.
    pub guard: Option<Slot>,
    /// Of a function that may take long the first of as many cells as there are arguments: those of the last call,
    /// whose results are still there. What takes long is not done again for the same arguments, as in
    /// when-clauses that are not active. The first one is no number after results of another origin.
    pub last: Option<Slot>,
}

/// A compiled function. Its locals have fixed cells.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct FunctionCode {
    /// The body.
    pub tape: Tape,
    /// Cells of the inputs.
    pub inputs: Vec<Slot>,
    /// Cells of the outputs.
    pub outputs: Vec<Slot>,
    /// Cells of all locals, set to zero on entry.
    pub locals: Vec<Slot>,
    /// Cells of the numbers of what assertions say, and where they stand.
    pub messages: Vec<(Slot, Span)>,
    /// The cells of its locals and of what it computes.
    pub frame: std::ops::Range<Slot>,
    /// It calls itself, directly or through others: a call puts aside what stands in its cells.
    pub recurs: bool,
}

/// What makes a relation switch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Watch {
    /// Searched on the trajectory.
    State,
    /// Switches at the time in this cell.
    Time(Slot),
    /// Switches only with discrete variables.
    Discrete,
}

/// A clock `sample(start, interval)`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Clock {
    /// Cell of the first instant.
    pub start: Slot,
    /// Cell of the period.
    pub interval: Slot,
    /// Cell of the flag.
    pub flag: Slot,
}

/// A `reinit`, evaluated by the event tape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ReinitCells {
    /// Acts if not zero.
    pub active: Slot,
    /// The state.
    pub state: Slot,
    /// Its new value.
    pub value: Slot,
}

/// An assertion. `roots` and `event` write both cells.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct AssertCells {
    /// Checked if not zero.
    pub active: Slot,
    /// Fails if zero.
    pub condition: Slot,
    /// Stands in a when-clause: only the event tape evaluates it.
    pub at_events: bool,
}

/// The cells of a variable that has a `min` or a `max`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Bounds {
    /// The variable.
    pub variable: VarId,
    /// Its value.
    pub value: Slot,
    /// The least value, infinite where there is none.
    pub min: Slot,
    /// The greatest one.
    pub max: Slot,
    /// The typical size.
    pub nominal: Slot,
}

/// States that are chosen while the model runs.
#[derive(Clone, Debug)]
pub struct StateSetCells {
    /// Cells of the candidates.
    pub candidates: Vec<Slot>,
    /// Cells of their typical sizes.
    pub nominals: Vec<Slot>,
    /// Cells of the states.
    pub states: Vec<Slot>,
    /// Cells of the selection, state by state.
    pub selection: Vec<Slot>,
    /// Derivatives of the constraints by the candidates, which [`Program::selection`] computes.
    pub jacobian: Vec<Entry>,
}

/// What the integrator of a program sees besides time: how algebraic loops are solved.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Form {
    /// Ordinary differential equations `y' = f(t, y)`: loops are solved inside of each evaluation.
    #[default]
    Reduced,
    /// Differential-algebraic equations `M y' = f(t, y)` of index 1: the unknowns of the loops that
    /// derivatives depend on are components of `y`, and their equations stand below those of the
    /// states.
    Implicit,
}

/// An unknown of an algebraic loop that the integrator finds, in a program of [`Form::Implicit`].
#[derive(Clone, Copy, Debug)]
pub struct Algebraic {
    /// The unknown.
    pub variable: VarId,
    /// Its equation `residual = 0`.
    pub residual: ExprId,
    /// Where that comes from.
    pub source: Source,
}

/// Where everything lies in the memory.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// `time`
    pub time: Slot,
    /// `initial()`
    pub initial: Slot,
    /// `terminal()`
    pub terminal: Slot,
    /// Each variable of the model.
    pub variables: Vec<Slot>,
    /// First state; the others follow in the order of `blocks.states`, and then the unknowns in the
    /// order of [`Program::algebraics`].
    pub states: Slot,
    /// Derivative of each state, then the residual of each algebraic equation.
    pub derivatives: Vec<Slot>,
    /// The size of each state and unknown at which its error becomes absolute.
    pub nominals: Vec<Slot>,
    /// Discrete and other variables whose `pre` is read: variable, its cell, cell of `pre`.
    pub pre: Vec<(VarId, Slot, Slot)>,
    /// First held relation; the others follow.
    pub relations: Slot,
    /// First relation evaluated by `roots`.
    pub fresh: Slot,
    /// First `lhs - rhs` evaluated by `roots`.
    pub gaps: Slot,
    /// Parameters that a run may set: variable, input cell (NaN: not given).
    pub parameter_inputs: Vec<(VarId, Slot)>,
    /// What recordings say about inputs: input, order of the derivative, cell.
    pub recorded: Vec<(VarId, u32, Slot)>,
    /// Delayed variables. What they were stands in the cells of what is recorded of them.
    pub delays: Vec<DelayCells>,
    /// Lines along which something is carried.
    pub transports: Vec<TransportCells>,
    /// Starts that a run may set: variable, input cell (NaN: not given), cell of the start value.
    pub starts: Vec<(VarId, Slot, Slot)>,
}

/// A delayed variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DelayCells {
    /// The variable.
    pub variable: VarId,
    /// Its cell.
    pub source: Slot,
    /// Cell of the delay, s.
    pub delay: Slot,
    /// It moves between events.
    pub moves: bool,
}

/// A line along which something is carried.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TransportCells {
    /// Places of the low and of the high end.
    pub ends: [Slot; 2],
    /// What enters there, if anything does.
    pub entering: [Option<Slot>; 2],
    /// What is on the line in the beginning: places from the low end on, and values.
    pub initial: Vec<(Slot, Slot)>,
    /// Those who read.
    pub readers: Vec<ReaderCells>,
}

/// A reader of what is carried along a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ReaderCells {
    /// The place.
    pub place: Slot,
    /// Where the smooth piece begins that it reads; the run writes it.
    pub from: Slot,
    /// Where it ends; the run writes it.
    pub to: Slot,
}

/// A compiled model.
#[derive(Clone)]
pub struct Program {
    /// What it was compiled from, for messages and names.
    pub blocks: Blocks,
    /// The memory before a run: literals, and NaN in the inputs.
    pub image: Vec<f64>,
    /// The cells of literals, ascending.
    pub literals: Vec<Slot>,
    /// The memory map.
    pub layout: Layout,
    /// The variables that a run records, in order of declaration.
    pub recorded: Vec<VarId>,
    /// The parameters and constants whose values a run tells, in order of declaration.
    pub constants: Vec<VarId>,
    /// Parameters, starts, nominals, and what depends on parameters only.
    pub parameters: Tape,
    /// The initial sequence.
    pub initial: Tape,
    /// The event sequence, with relations, reinits, asserts and terminates.
    pub event: Tape,
    /// What changes at events only.
    pub held: Tape,
    /// The derivatives.
    pub rhs: Tape,
    /// Searched relations and assertions.
    pub roots: Tape,
    /// The other variables.
    pub rest: Tape,
    /// Entries of the Jacobian of the derivatives (and residuals) by the states (and unknowns).
    pub jacobian: Tape,
    /// The unknowns beyond the states, and their equations; none in [`Form::Reduced`].
    pub algebraics: Vec<Algebraic>,
    /// Its entries that can differ from zero, by row, then column.
    pub jacobian_entries: Vec<Entry>,
    /// What the selection of states is judged by; all variables must be in the memory.
    pub selection: Tape,
    /// One for each of `blocks.state_sets`.
    pub state_sets: Vec<StateSetCells>,
    /// Torn blocks.
    pub solvers: Vec<Solver>,
    /// Derivatives of torn blocks.
    pub implicits: Vec<Implicit>,
    /// Mixed blocks.
    pub loops: Vec<Loop>,
    /// Calls.
    pub calls: Vec<CallSite>,
    /// Functions.
    pub functions: Vec<FunctionCode>,
    /// One for each relation of the model.
    pub watches: Vec<Watch>,
    /// Relations that `initial` reads before it can evaluate them.
    pub late_initial: Vec<u32>,
    /// Relations that `event` reads before it can evaluate them.
    pub late_event: Vec<u32>,
    /// Clocks.
    pub clocks: Vec<Clock>,
    /// `reinit`s.
    pub reinits: Vec<ReinitCells>,
    /// Assertions.
    pub asserts: Vec<AssertCells>,
    /// What has a `min` or a `max`, of variables that are the same the one that stands for all.
    pub bounds: Vec<Bounds>,
    /// Activation of each `terminate`.
    pub terminates: Vec<Slot>,
    /// `terminal()` is read somewhere: the run ends with an event.
    pub reads_terminal: bool,
    /// The way to the start from a simplified system, if the model offers one.
    pub continuation: Option<Box<Continuation>>,
}

/// The model with `(1 - lambda) simplified + lambda actual` for each `homotopy(actual, simplified)`.
#[derive(Clone)]
pub struct Continuation {
    /// Its program.
    pub program: Program,
    /// The parameter.
    pub lambda: VarId,
    /// Cells of the continuous variables of the model there, and in the program itself.
    pub cells: Vec<(Slot, Slot)>,
}

impl Program {
    /// Number of components that the integrator sees: states, then algebraic unknowns.
    pub fn order(&self) -> usize {
        self.layout.derivatives.len()
    }

    /// The variable that a component of the integrator is.
    pub fn component(&self, i: usize) -> Option<VarId> {
        let states = &self.blocks.states;
        match i.checked_sub(states.len()) {
            None => Some(states[i].variable),
            Some(k) => self.algebraics.get(k).map(|a| a.variable),
        }
    }

    /// Cell of a variable.
    pub fn slot(&self, v: VarId) -> Slot {
        self.layout.variables[v.0 as usize]
    }

    /// Name of a variable.
    pub fn name(&self, v: VarId) -> &str {
        &self.blocks.dae.variables[v].name
    }

    /// All tapes but the bodies of functions, with their names; in an order that depends on nothing
    /// but the program.
    pub fn tapes(&self) -> Vec<(&'static str, &Tape)> {
        let mut all = vec![
            ("parameters", &self.parameters),
            ("initial", &self.initial),
            ("event", &self.event),
            ("held", &self.held),
            ("rhs", &self.rhs),
            ("roots", &self.roots),
            ("rest", &self.rest),
            ("jacobian", &self.jacobian),
            ("selection", &self.selection),
        ];
        for solver in &self.solvers {
            all.push(("residual", &solver.residual_tape));
            all.push(("block jacobian", &solver.jacobian_tape));
        }
        all.extend(self.loops.iter().map(|mixed| ("loop", &mixed.tape)));
        all
    }

    /// Numbers the tapes in the order of [`Program::tapes`].
    pub fn number_tapes(&mut self) {
        let own = [
            &mut self.parameters,
            &mut self.initial,
            &mut self.event,
            &mut self.held,
            &mut self.rhs,
            &mut self.roots,
            &mut self.rest,
            &mut self.jacobian,
            &mut self.selection,
        ];
        let blocks =
            self.solvers.iter_mut().flat_map(|s| [&mut s.residual_tape, &mut s.jacobian_tape]);
        let loops = self.loops.iter_mut().map(|mixed| &mut mixed.tape);
        for (number, tape) in own.into_iter().chain(blocks).chain(loops).enumerate() {
            tape.number = Some(number as u32);
        }
    }

    /// Checks that every cell and every reference of every tape exists.
    pub fn verify(&self) -> Result<(), String> {
        for (name, tape) in self.tapes() {
            self.verify_tape(name, tape)?;
        }
        for solver in &self.solvers {
            if solver.residuals.len() != solver.unknowns.len() {
                return Err("a torn block is not square".into());
            }
            let entries = solver.jacobian.iter().map(|e| &e.slot);
            let mut cells = solver.slots.iter().chain(&solver.residuals).chain(entries);
            if !cells.all(|slot| (*slot as usize) < self.image.len()) {
                return Err("a torn block refers to a cell that does not exist".into());
            }
        }
        let exists = |slot: &Slot| (*slot as usize) < self.image.len();
        if self.functions.iter().any(|f| f.frame.end as usize > self.image.len()) {
            return Err("a function has a frame of cells that do not exist".into());
        }
        for function in &self.functions {
            self.verify_tape("function", &function.tape)?;
            let mut cells = function.inputs.iter().chain(&function.outputs).chain(&function.locals);
            if !cells.all(exists) {
                return Err("a function has a local that does not exist".into());
            }
        }
        for site in &self.calls {
            let Some(function) = self.functions.get(site.function) else {
                return Err("a call refers to no function".into());
            };
            let partial = site.partial.is_none_or(|(output, argument)| {
                output < function.outputs.len()
                    && argument < site.args.len()
                    && !site.results.is_empty()
            });
            let kept = |first: Slot| first as usize + site.args.len() <= self.image.len();
            let mut cells = site.args.iter().chain(&site.results).chain(&site.guard);
            if !(partial && cells.all(exists) && site.last.is_none_or(kept)) {
                return Err("a call refers to a cell that does not exist".into());
            }
        }
        Ok(())
    }

    /// Whether a call is one of a function that calls itself.
    pub fn calls_itself(&self, site: usize) -> bool {
        self.functions[self.calls[site].function].recurs
    }

    fn verify_tape(&self, name: &str, tape: &Tape) -> Result<(), String> {
        let cells = self.image.len();
        for (at, i) in tape.iter().enumerate() {
            let cell = |s: Slot| (s as usize) < cells;
            let fine = match i.op {
                Op::Solve => (i.a as usize) < self.solvers.len(),
                Op::Implicit => (i.a as usize) < self.implicits.len(),
                Op::Repeat => (i.a as usize) < self.loops.len(),
                Op::Call => (i.a as usize) < self.calls.len(),
                Op::Jump => (i.a as usize) <= tape.len(),
                Op::JumpUnless => cell(i.a) && (i.b as usize) <= tape.len(),
                Op::Assert => cell(i.a),
                _ => cell(i.dst) && cell(i.a) && cell(i.b),
            };
            if !fine {
                return Err(format!(
                    "instruction {at} of the {name} tape refers to nothing: {i:?}"
                ));
            }
        }
        Ok(())
    }
}

/// Where the equation of a block stands.
pub fn source_span(dae: &Dae, source: Source) -> Span {
    match source {
        Source::Continuous(i) => dae.equations[i].origin.span,
        Source::Discrete(i) => dae.discrete[i].origin.span,
        Source::Initial(i) => dae.initial[i].origin.span,
        Source::Start(v) => dae.variables[v].span,
    }
}
