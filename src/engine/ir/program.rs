//! The compiled model: flat tapes over one array of doubles.
//!
//! *Holds:* the memory map, tapes of three-address instructions by variability, the torn and mixed
//! blocks that tapes refer to, and everything a simulation must monitor (relations, clocks,
//! `reinit`s, assertions). Parameters and start values are slots of the memory, so one program
//! serves many runs and threads.
//! *Never holds:* anything that changes during a run; expression trees that are walked at run time;
//! strings outside of [`Program::blocks`], which is kept for messages only.
//! *Made by:* `codegen`. *Read by:* `runtime`, `simulate`.
//!
//! Booleans are 0 and 1; enumeration literals and strings are represented by their number. Every
//! temporary has a slot of its own: the results of a tape stay readable until it runs again.
//!
//! Tapes run from rare to frequent: `parameters` once; `initial` once; `event` in each event
//! iteration; `discrete` after each event; `rhs` at each evaluation of derivatives; at the same
//! point then `jacobian`, followed by the tape of `forcing` if the run is differentiated, or `roots` followed by
//! `outputs`; `state_selection` after each step. Rows between steps run `rows`, if there is one, in place of `rhs`,
//! `roots` and `outputs`.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use super::blocks::{Blocks, Source};
use super::dae::Dae;
use super::expr::{Binary, ExprId, Unary, VarId};
use super::external::Externals;
use super::foreign::Foreign;
use crate::base::source::Span;

/// Index of a value in the memory.
pub type Slot = u32;

/// Operation of an instruction on the slots `dst`, `a` and `b`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Op {
    /// `dst := a`
    Copy,
    /// `if a then dst := b`; together with a preceding `Copy` this is a selection.
    CopyIf,
    /// `dst := b`, or `a` if `b` is NaN: an input that is not set takes its default.
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
    Differentiate,
    /// Iterates mixed block `a` until its discrete unknowns stop changing.
    Iterate,
    /// Calls call site `a`.
    Call,
    /// Jumps to instruction `a` of the same tape. In functions only.
    Jump,
    /// Jumps to instruction `b` if slot `a` is zero. In functions only.
    JumpUnless,
    /// Fails with message `b` of the function if slot `a` is zero. In functions only.
    Assert,
}

/// One instruction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Instr {
    /// The operation.
    pub op: Op,
    /// The slot it writes.
    pub dst: Slot,
    /// First operand.
    pub a: Slot,
    /// Second operand.
    pub b: Slot,
}

/// Large models have tens of millions of instructions.
const _: () = assert!(size_of::<Instr>() == 24);

/// A sequence of instructions; dereferences to them.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Tape {
    code: Vec<Instr>,
    /// Position in [`Program::all_tapes`], which identifies its machine code; `None` during code
    /// generation.
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
    /// Slot of the value.
    pub slot: Slot,
}

/// A torn block: solve for the unknowns at which the residuals vanish.
#[derive(Clone, Debug)]
pub struct TornBlock {
    /// Tearing variables.
    pub unknowns: Vec<VarId>,
    /// Their slots.
    pub slots: Vec<Slot>,
    /// Computes the explicit variables and the residuals from the unknowns.
    pub residual_tape: Tape,
    /// Slots of the residuals.
    pub residuals: Vec<Slot>,
    /// Computes the entries of the Jacobian; runs after `residual_tape`.
    pub jacobian_tape: Tape,
    /// The structurally nonzero entries.
    pub jacobian: Vec<Entry>,
    /// Slots of the nominal values of the unknowns.
    pub nominals: Vec<Slot>,
    /// Slots of the bounds of the unknowns: `min`, `max`.
    pub bounds: Vec<(Slot, Slot)>,
    /// Linear in its unknowns: solved by one factorization, without Newton iterations.
    pub linear: bool,
    /// The block it was compiled from.
    pub place: BlockPosition,
}

/// Derivatives of the unknowns `z` of a torn block with respect to outer seeds: `J dz = -B`.
#[derive(Clone, Debug)]
pub struct BlockDerivative {
    /// The torn block, for messages.
    pub torn_block: u32,
    /// Order of `J`.
    pub order: usize,
    /// `J`
    pub jacobian: Vec<Entry>,
    /// `B`, row by equation, column by seed.
    pub seeds: Vec<Entry>,
    /// Slots of the results, column by column.
    pub results: Vec<Slot>,
}

/// A mixed block: its tape is iterated until the discrete unknowns stop changing.
#[derive(Clone, Debug)]
pub struct MixedBlock {
    /// Determines the discrete variables that read its relations.
    pub decisions: Tape,
    /// Determines the others and the relations. An iteration executes both tapes, the first one this one only.
    pub tape: Tape,
    /// The discrete variables and relations that it determines.
    pub discrete_unknowns: Vec<DiscreteUnknown>,
    /// The conditions of when-clauses whose becoming true it reads: slots of each and of its `pre` value.
    pub edges: Vec<(Slot, Slot)>,
    /// The block it was compiled from.
    pub place: BlockPosition,
}

/// A discrete unknown of a mixed block.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DiscreteUnknown {
    /// A discrete variable.
    Variable(VarId, Slot),
    /// A relation.
    Relation(u32, Slot),
}

/// One of the sequences of [`Blocks`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sequence {
    /// `blocks.initial`
    Initial,
    /// `blocks.initial_by_states`
    InitialByStates,
    /// `blocks.event`
    Event,
    /// `blocks.continuous`
    Continuous,
}

/// Position of a block, for messages.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BlockPosition {
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
    /// Slots of the arguments.
    pub args: Vec<Slot>,
    /// Slots of all outputs, or of the partial derivative if `partial` is given.
    pub results: Vec<Slot>,
    /// Output and argument of a partial derivative, computed by central differences.
    pub partial: Option<(usize, usize)>,
    /// Slot of the condition under which the results are read; if it is false the call is skipped.
    pub condition: Option<Slot>,
    /// For expensive functions, the first of the slots that hold the arguments of the last call,
    /// one per argument. The call is skipped while its arguments are unchanged, as in inactive
    /// when-clauses. The first slot is NaN if the results come from elsewhere.
    pub memo: Option<Slot>,
}

/// A compiled function. Its locals have fixed slots.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct FunctionCode {
    /// The body.
    pub tape: Tape,
    /// Slots of the inputs.
    pub inputs: Vec<Slot>,
    /// Slots of the outputs.
    pub outputs: Vec<Slot>,
    /// Slots of all locals, set to zero on entry.
    pub locals: Vec<Slot>,
    /// Slots of the messages of assertions (as string numbers), and their positions in the source.
    pub messages: Vec<(Slot, Span)>,
    /// The slots of its locals and temporaries.
    pub frame: std::ops::Range<Slot>,
    /// It calls itself, directly or indirectly: a call saves its slots in a frame.
    pub is_recursive: bool,
}

/// Cause of a relation changing its value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RelationTrigger {
    /// A zero crossing on the trajectory.
    State,
    /// Reaching the time in this slot.
    Time(Slot),
    /// A change of discrete variables.
    Discrete,
}

/// A clock `sample(start, interval)`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Clock {
    /// Slot of the first instant.
    pub start: Slot,
    /// Slot of the period.
    pub interval: Slot,
    /// Slot of the flag that is true at a tick.
    pub flag: Slot,
}

/// A `reinit`, evaluated by the event tape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ReinitSlots {
    /// Acts if not zero.
    pub active: Slot,
    /// The state.
    pub state: Slot,
    /// Its new value.
    pub value: Slot,
}

/// An assertion. `roots` and `event` write both slots.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct AssertSlots {
    /// Checked if not zero.
    pub active: Slot,
    /// Fails if zero.
    pub condition: Slot,
    /// Belongs to a when-clause: evaluated by the event tape only.
    pub at_events: bool,
}

/// The slots of a variable that has a `min` or a `max`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Bounds {
    /// The variable.
    pub variable: VarId,
    /// Its value.
    pub value: Slot,
    /// The lower bound, infinite if there is none.
    pub min: Slot,
    /// The upper bound, infinite if there is none.
    pub max: Slot,
    /// The nominal value.
    pub nominal: Slot,
}

/// States that are selected at run time.
#[derive(Clone, Debug)]
pub struct StateSetSlots {
    /// Slots of the candidates.
    pub candidates: Vec<Slot>,
    /// Slots of their nominal values.
    pub nominals: Vec<Slot>,
    /// Slots of the states.
    pub states: Vec<Slot>,
    /// Slots of the selection, state by state.
    pub selection: Vec<Slot>,
    /// Derivatives of the constraints with respect to the candidates, computed by
    /// [`Tapes::state_selection`].
    pub jacobian: Vec<Entry>,
}

/// Form of the system that the integrator sees: determines who solves algebraic loops.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SystemForm {
    /// Ordinary differential equations `y' = f(t, y)`: loops are solved within each evaluation.
    #[default]
    Ode,
    /// Differential-algebraic equations `M y' = f(t, y)` of index 1: the unknowns of the loops that
    /// derivatives depend on are components of `y`, and their equations follow those of the states.
    Dae,
}

/// An unknown of an algebraic loop that the integrator solves for ([`SystemForm::Dae`]).
#[derive(Clone, Copy, Debug)]
pub struct AlgebraicUnknown {
    /// The unknown.
    pub variable: VarId,
    /// Its equation `residual = 0`.
    pub residual: ExprId,
    /// Origin of the equation.
    pub source: Source,
}

/// The memory map.
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
    /// First state; the others follow in the order of `blocks.states`, then the unknowns in the
    /// order of [`Program::algebraics`].
    pub states: Slot,
    /// Derivative of each state, then the residual of each algebraic equation.
    pub derivatives: Vec<Slot>,
    /// The size of each state and unknown below which its error is absolute.
    pub nominals: Vec<Slot>,
    /// Discrete variables, and others whose `pre` is read: variable, its slot, slot of `pre`.
    pub pre: Vec<(VarId, Slot, Slot)>,
    /// First relation, with the value held between events; the others follow.
    pub relations: Slot,
    /// First candidate value of a relation, evaluated by `roots`.
    pub candidates: Slot,
    /// First zero-crossing indicator `lhs - rhs`, evaluated by `roots`.
    pub indicators: Slot,
    /// Parameters that a run may set: variable, input slot (NaN: not set).
    pub parameter_inputs: Vec<(VarId, Slot)>,
    /// Signals with a known history, and their derivatives: variable, order, slot.
    pub signals: Vec<(VarId, u32, Slot)>,
    /// Delayed variables; their past values are [`Layout::signals`].
    pub delays: Vec<DelaySlots>,
    /// Transport lines (`spatialDistribution`, `delay` with a variable time).
    pub transports: Vec<TransportSlots>,
    /// Start values that a run may set: variable, input slot (NaN: not set), slot of the start
    /// value.
    pub starts: Vec<(VarId, Slot, Slot)>,
    /// Slots from the first to before the second hold parameters, their inputs and what they are computed from: only
    /// the tape of parameters writes them, and copies of the memory within a run leave them out.
    pub parameters: (Slot, Slot),
}

/// A delayed variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DelaySlots {
    /// The variable.
    pub variable: VarId,
    /// Its slot.
    pub source: Slot,
    /// Slot of the delay time, s.
    pub delay: Slot,
    /// The input that it equals, if recordings may determine that and the delay is a parameter.
    pub input: Option<VarId>,
    /// It varies between events.
    pub moves: bool,
}

/// A transport line: a profile that moves along a coordinate.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TransportSlots {
    /// Coordinates of the low and of the high end.
    pub ends: [Slot; 2],
    /// Values entering at the ends, if any.
    pub entering: [Option<Slot>; 2],
    /// The initial profile: coordinates from the low end, and values.
    pub initial: Vec<(Slot, Slot)>,
    /// Where the profile is read.
    pub readers: Vec<ReaderSlots>,
}

/// A point at which a transport line is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ReaderSlots {
    /// Its coordinate.
    pub place: Slot,
    /// Start of the smooth segment it reads; written by the runtime.
    pub from: Slot,
    /// End of that segment; written by the runtime.
    pub to: Slot,
}

/// The tapes of a program, from rare to frequent.
#[derive(Clone, Default)]
pub struct Tapes {
    /// Parameters, start values, nominal values, and expressions of parameters.
    pub parameters: Tape,
    /// The initial sequence.
    pub initial: Tape,
    /// The initial sequence with loops torn at states; empty if it would be the same.
    pub initial_by_states: Tape,
    /// The event sequence, with relations, `reinit`s, assertions and terminations.
    pub event: Tape,
    /// The lagged relations of the event sequence for the present values of the discrete variables that read them; empty
    /// if there are none.
    pub decided: Tape,
    /// Expressions that change at events only.
    pub discrete: Tape,
    /// The derivatives.
    pub rhs: Tape,
    /// Zero-crossing indicators and assertions.
    pub roots: Tape,
    /// All other variables.
    pub outputs: Tape,
    /// Entries of the Jacobian of the derivatives (and residuals) with respect to the states (and
    /// algebraic unknowns).
    pub jacobian: Tape,
    /// Derivatives of the constraints that state selection is based on; all variables must be in
    /// the memory.
    pub state_selection: Tape,
}

/// Blocks and functions that instructions refer to by number.
#[derive(Clone, Default)]
pub struct Routines {
    /// Torn blocks.
    pub torn_blocks: Vec<TornBlock>,
    /// Derivatives of torn blocks.
    pub block_derivatives: Vec<BlockDerivative>,
    /// Mixed blocks.
    pub mixed_blocks: Vec<MixedBlock>,
    /// Call sites.
    pub calls: Vec<CallSite>,
    /// Functions.
    pub functions: Vec<FunctionCode>,
}

/// The value with which a relation begins at the start.
#[derive(Clone, Debug)]
pub struct RelationStart {
    /// The relation.
    pub relation: u32,
    /// Evaluates it at the start values of its operands.
    pub tape: Tape,
}

/// Relations, clocks, and actions at events.
#[derive(Clone, Default)]
pub struct Events {
    /// One for each relation of the model.
    pub relation_triggers: Vec<RelationTrigger>,
    /// The values of relations that the initial sequences read before they can evaluate them, and of those that mixed
    /// blocks iterate there, in an order in which they can be evaluated.
    pub relation_starts: Vec<RelationStart>,
    /// Relations that `initial` reads before it can evaluate them.
    pub lagged_initial: Vec<u32>,
    /// Relations that `initial_by_states` reads before it can evaluate them.
    pub lagged_by_states: Vec<u32>,
    /// Relations that `event` reads before it can evaluate them.
    pub lagged_event: Vec<u32>,
    /// Clocks.
    pub clocks: Vec<Clock>,
    /// `reinit`s.
    pub reinits: Vec<ReinitSlots>,
    /// Assertions.
    pub asserts: Vec<AssertSlots>,
    /// Activation of each `terminate`.
    pub terminates: Vec<Slot>,
    /// `terminal()` is read somewhere: the run ends with an event.
    pub reads_terminal: bool,
}

/// A compiled model.
#[derive(Clone)]
pub struct Program {
    /// The sorted system it was compiled from, for messages and names.
    pub blocks: Blocks,
    /// The initial memory: literals, and NaN in the inputs.
    pub image: Vec<f64>,
    /// The slots of literals, ascending.
    pub literals: Vec<Slot>,
    /// The memory map.
    pub layout: Layout,
    /// The recorded variables, in order of declaration.
    pub recorded: Vec<VarId>,
    /// The parameters and constants whose values are reported once, in order of declaration.
    pub constants: Vec<VarId>,
    /// The tapes of the system itself.
    pub tapes: Tapes,
    /// What the recorded variables and assertions need of `rhs`, `roots` and `outputs`, if that is
    /// little: evaluates a row between steps. The other variables then keep earlier values.
    pub rows: Option<Tape>,
    /// The unknowns beyond the states, and their equations; none in [`SystemForm::Ode`].
    pub algebraics: Vec<AlgebraicUnknown>,
    /// The structurally nonzero entries of the Jacobian, by row, then column.
    pub jacobian_entries: Vec<Entry>,
    /// Derivatives by parameters, if runs are to be differentiated by some.
    pub forcing: Option<Forcing>,
    /// One for each of `blocks.state_sets`.
    pub state_sets: Vec<StateSetSlots>,
    /// Blocks and functions that instructions refer to.
    pub routines: Routines,
    /// Relations, clocks and actions at events.
    pub events: Events,
    /// Variables with a `min` or a `max`; of aliases, the representative.
    pub bounds: Vec<Bounds>,
    /// The simplified system from which initialization continues, if the model uses `homotopy`.
    pub continuation: Option<Box<Continuation>>,
    /// The foreign model that computes the variables, which are then inputs of the program.
    pub foreign: Option<Arc<Foreign>>,
}

/// Derivatives of the right side by parameters and discrete variables at constant states.
#[derive(Clone, Debug)]
pub struct Forcing {
    /// A run may use it that is differentiated by these parameters, and by start values.
    pub inputs: Vec<VarId>,
    /// The slots of the parameters and discrete variables.
    pub seeds: Vec<Slot>,
    /// Computes the derivatives; runs after `rhs` and `jacobian` at the same point.
    pub tape: Tape,
    /// The structurally nonzero derivatives: row of the right side, position of the seed.
    pub entries: Vec<Entry>,
}

/// The model with `(1 - lambda) simplified + lambda actual` for each `homotopy(actual,
/// simplified)`.
#[derive(Clone)]
pub struct Continuation {
    /// Its program.
    pub program: Program,
    /// The continuation parameter.
    pub lambda: VarId,
    /// Slots of the continuous variables in that program, and in the actual one.
    pub slots: Vec<(Slot, Slot)>,
}

impl Program {
    /// A driven input of the model whose derivative the equations need.
    pub fn differentiated_input(&self) -> Option<VarId> {
        // There is always a slot for one derivative more than the equations read.
        let is_delayed = |v: VarId| self.layout.delays.iter().any(|d| d.variable == v);
        let mut signals = self.layout.signals.iter();
        signals.find(|(v, order, _)| *order > 1 && !is_delayed(*v)).map(|(v, ..)| *v)
    }

    /// The external functions that its instructions refer to.
    #[inline]
    pub fn externals(&self) -> &Arc<Externals> {
        self.blocks.dae.graph.externals()
    }

    /// Number of states: those of the foreign model, if there is one.
    pub fn state_count(&self) -> usize {
        let own = self.blocks.states.len();
        self.foreign.as_ref().map_or(own, |foreign| foreign.model.interface().states)
    }

    /// Number of components that the integrator sees: states, then algebraic unknowns.
    pub fn order(&self) -> usize {
        self.layout.derivatives.len()
    }

    /// The variable that corresponds to a component of the integrator.
    pub fn component(&self, i: usize) -> Option<VarId> {
        let states = &self.blocks.states;
        match i.checked_sub(states.len()) {
            None => Some(states[i].variable),
            Some(k) => self.algebraics.get(k).map(|a| a.variable),
        }
    }

    /// Slot of a variable.
    pub fn slot(&self, v: VarId) -> Slot {
        self.layout.variables[v.0 as usize]
    }

    /// Name of a variable.
    pub fn name(&self, v: VarId) -> &str {
        &self.blocks.dae.variables[v].name
    }

    /// All tapes except the bodies of functions, with their names; the order depends on the program
    /// only.
    pub fn all_tapes(&self) -> Vec<(&'static str, &Tape)> {
        let tapes = &self.tapes;
        let mut all = vec![
            ("parameters", &tapes.parameters),
            ("initial", &tapes.initial),
            ("initial by states", &tapes.initial_by_states),
            ("event", &tapes.event),
            ("decided", &tapes.decided),
            ("discrete", &tapes.discrete),
            ("rhs", &tapes.rhs),
            ("roots", &tapes.roots),
            ("outputs", &tapes.outputs),
            ("jacobian", &tapes.jacobian),
            ("state selection", &tapes.state_selection),
        ];
        for torn_block in &self.routines.torn_blocks {
            all.push(("residual", &torn_block.residual_tape));
            all.push(("block jacobian", &torn_block.jacobian_tape));
        }
        for mixed in &self.routines.mixed_blocks {
            all.push(("decisions", &mixed.decisions));
            all.push(("loop", &mixed.tape));
        }
        all.extend(self.rows.iter().map(|tape| ("rows", tape)));
        all.extend(self.forcing.iter().map(|forcing| ("forcing", &forcing.tape)));
        all
    }

    /// Numbers the tapes in the order of [`Program::all_tapes`].
    pub fn number_tapes(&mut self) {
        let tapes = &mut self.tapes;
        let own = [
            &mut tapes.parameters,
            &mut tapes.initial,
            &mut tapes.initial_by_states,
            &mut tapes.event,
            &mut tapes.decided,
            &mut tapes.discrete,
            &mut tapes.rhs,
            &mut tapes.roots,
            &mut tapes.outputs,
            &mut tapes.jacobian,
            &mut tapes.state_selection,
        ];
        let blocks = self
            .routines
            .torn_blocks
            .iter_mut()
            .flat_map(|s| [&mut s.residual_tape, &mut s.jacobian_tape]);
        let mixed_blocks = self
            .routines
            .mixed_blocks
            .iter_mut()
            .flat_map(|mixed| [&mut mixed.decisions, &mut mixed.tape]);
        let forcing = self.forcing.iter_mut().map(|forcing| &mut forcing.tape);
        let all = own.into_iter().chain(blocks).chain(mixed_blocks).chain(&mut self.rows);
        let all = all.chain(forcing);
        for (number, tape) in all.enumerate() {
            tape.number = Some(number as u32);
        }
    }

    /// Checks that every slot and every reference of every tape exists.
    pub fn verify(&self) -> Result<(), String> {
        for (name, tape) in self.all_tapes() {
            self.verify_tape(name, tape)?;
        }
        for torn_block in &self.routines.torn_blocks {
            if torn_block.residuals.len() != torn_block.unknowns.len() {
                return Err("a torn block is not square".into());
            }
            let entries = torn_block.jacobian.iter().map(|e| &e.slot);
            let mut slots = torn_block.slots.iter().chain(&torn_block.residuals).chain(entries);
            if !slots.all(|slot| (*slot as usize) < self.image.len()) {
                return Err("a torn block refers to a slot that does not exist".into());
            }
        }
        let exists = |slot: &Slot| (*slot as usize) < self.image.len();
        let of_forcing = |f: &Forcing| {
            f.seeds.iter().chain(f.entries.iter().map(|e| &e.slot)).all(exists)
                && f.entries.iter().all(|e| (e.column as usize) < f.seeds.len())
        };
        if !self.forcing.iter().all(of_forcing) {
            return Err(
                "a derivative by a parameter refers to something that does not exist".into()
            );
        }
        if self.routines.functions.iter().any(|f| f.frame.end as usize > self.image.len()) {
            return Err("a function has a frame of slots that do not exist".into());
        }
        for start in &self.events.relation_starts {
            self.verify_tape("relation start", &start.tape)?;
        }
        for function in &self.routines.functions {
            self.verify_tape("function", &function.tape)?;
            let mut slots = function.inputs.iter().chain(&function.outputs).chain(&function.locals);
            if !slots.all(exists) {
                return Err("a function has a local that does not exist".into());
            }
        }
        for site in &self.routines.calls {
            let Some(function) = self.routines.functions.get(site.function) else {
                return Err("a call refers to no function".into());
            };
            let partial = site.partial.is_none_or(|(output, argument)| {
                output < function.outputs.len()
                    && argument < site.args.len()
                    && !site.results.is_empty()
            });
            let kept = |first: Slot| first as usize + site.args.len() <= self.image.len();
            let mut slots = site.args.iter().chain(&site.results).chain(&site.condition);
            if !(partial && slots.all(exists) && site.memo.is_none_or(kept)) {
                return Err("a call refers to a slot that does not exist".into());
            }
        }
        Ok(())
    }

    /// True if a call site calls a recursive function.
    pub fn is_recursive_call(&self, site: usize) -> bool {
        self.routines.functions[self.routines.calls[site].function].is_recursive
    }

    fn verify_tape(&self, name: &str, tape: &Tape) -> Result<(), String> {
        let slots = self.image.len();
        for (at, i) in tape.iter().enumerate() {
            let exists = |s: Slot| (s as usize) < slots;
            let fine = match i.op {
                Op::Solve => (i.a as usize) < self.routines.torn_blocks.len(),
                Op::Differentiate => (i.a as usize) < self.routines.block_derivatives.len(),
                Op::Iterate => (i.a as usize) < self.routines.mixed_blocks.len(),
                Op::Call => (i.a as usize) < self.routines.calls.len(),
                Op::Jump => (i.a as usize) <= tape.len(),
                Op::JumpUnless => exists(i.a) && (i.b as usize) <= tape.len(),
                Op::Assert => exists(i.a),
                _ => exists(i.dst) && exists(i.a) && exists(i.b),
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

/// Source position of the equation of a block.
pub fn source_span(dae: &Dae, source: Source) -> Span {
    match source {
        Source::Continuous(i) => dae.equations[i].origin.span,
        Source::Discrete(i) => dae.discrete[i].origin.span,
        Source::Initial(i) => dae.initial[i].origin.span,
        Source::Start(v) => dae.variables[v].span,
    }
}
