//! Tapes to machine code.
//!
//! What comes in: a [`Program`]. What goes out: [`MachineCode`], immutable, which any number of runs
//! and threads share. It computes what [`interp`](super::machine) computes, to the bit (what is not a
//! number counts as one value: its sign and payload are open), and leaves the same values in the
//! same cells. Torn blocks of more than one unknown, their derivatives and mixed blocks stay in Rust: a tape is
//! cut there.
//!
//! Instructions are selected and registers allocated by Cranelift; what it is told is in `cells`.
//! The interpreter stays for what runs too seldom to be worth the translation, beyond the domain of
//! functions, on machines that Cranelift does not know, and as the oracle of the tests.
#![allow(unsafe_code)] // Here alone: code made at run time is called, and its memory given back.

mod body;
mod external;
mod slots;
mod source;

#[cfg(test)]
mod tests;
pub mod tiering;

use std::mem::ManuallyDrop;

use cranelift::codegen::Context;
use cranelift::codegen::ir::UserFuncName;
use cranelift::jit::{ArenaMemoryProvider, JITBuilder, JITModule};
use cranelift::module::{FuncId, Module, default_libcall_names};
use cranelift::prelude::*;

use self::body::Faults;
use self::slots::{Cells, Known};
use self::source::Source;
use super::machine::Fault;
use crate::ir::expr::Unary;
use crate::ir::program::{Instr, Op, Program};

/// Instructions of a tape that become one function: the time of register allocation grows faster
/// than the length.
const LONGEST: usize = 1000;
/// Address space for the machine code of an instruction, bytes; four times of what it mostly takes.
const RESERVED: usize = 256;
/// Address space besides, bytes.
const RESERVED_BESIDES: usize = 1 << 20;
/// The most cells that an offset of 31 bits reaches.
const MOST_CELLS: usize = (i32::MAX as usize) / size_of::<f64>();

/// Why there is no machine code; the interpreter does as well.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum Untranslated {
    /// Cranelift does not know the machine, or refuses an instruction.
    #[error("this machine can not be translated to: {0}")]
    Refused(String),
    /// The program is larger than offsets reach.
    #[error("the program has {cells} cells, more than machine code can reach")]
    TooLarge {
        /// Its number of cells.
        cells: usize,
    },
    /// Nobody waits for the result any more.
    #[error("the translation was given up")]
    GivenUp,
    /// The program refers to what it does not have.
    #[error("{0}")]
    Invalid(String),
}

/// One stretch of a tape: computes in the memory; returns 0 or the number of a fault.
type Stretch = unsafe extern "C" fn(memory: *mut f64, memo: *mut f64) -> u32;

/// A part of a tape.
enum Piece {
    /// Machine code.
    Stretch(Stretch),
    /// Done in Rust.
    Between(Instr),
}

/// What the machine code of one run remembers of elementary functions: only what was computed, so
/// it never has to be forgotten.
#[derive(Clone, Debug)]
pub struct Memo(Vec<f64>);

/// The machine code of a program.
pub struct MachineCode {
    source: Source,
    tapes: Vec<Vec<Piece>>,
    faults: Vec<Fault>,
    memo: Memo,
    module: ManuallyDrop<JITModule>,
}

// SAFETY: after `translate` nothing writes to the module or its code: all methods take `&self` and
// only read pointers to code that depends on nothing but its argument.
unsafe impl Send for MachineCode {}
// SAFETY: as above.
unsafe impl Sync for MachineCode {}

impl MachineCode {
    /// Translates all tapes of a program. Takes some microseconds for each instruction.
    pub fn translate(program: &Program) -> Result<MachineCode, Untranslated> {
        program.verify().map_err(Untranslated::Invalid)?;
        Translator::translate(Source::of(program), &|| false)
    }

    /// True if this is the machine code of `program`, or of one that does exactly the same.
    pub fn is_of(&self, program: &Program) -> bool {
        self.source.is_of(program)
    }

    /// What a run remembers before it begins.
    pub fn memo(&self) -> Memo {
        self.memo.clone()
    }

    /// Runs a tape from piece `at` until an instruction is to be done in Rust, or to its end; gives that,
    /// and the piece after it. Panics if the memory is not that of the program, or `memo` not of this
    /// machine code, which is a bug.
    pub fn run(
        &self,
        tape: u32,
        at: usize,
        memory: &mut [f64],
        memo: &mut Memo,
    ) -> Result<Option<(Instr, usize)>, Fault> {
        assert!(memory.len() >= self.source.cells, "the memory of another program");
        assert!(memo.0.len() == self.memo.0.len(), "the memo of another program");
        for (k, piece) in self.tapes[tape as usize].iter().enumerate().skip(at) {
            match *piece {
                Piece::Stretch(stretch) => {
                    // SAFETY: the code was made by `Translator` for `source`, which was verified: it
                    // reads and writes the cells below `source.cells` alone, all of which `memory`
                    // holds, and the places of `self.memo`, as many as `memo` has; it calls nothing
                    // but itself and `external`. It is not given back before `self` is dropped.
                    match unsafe { stretch(memory.as_mut_ptr(), memo.0.as_mut_ptr()) } {
                        0 => {}
                        fault => return Err(self.faults[fault as usize - 1]),
                    }
                }
                Piece::Between(instruction) => return Ok(Some((instruction, k + 1))),
            }
        }
        Ok(None)
    }
}

impl Drop for MachineCode {
    fn drop(&mut self) {
        // SAFETY: the module is not used after this, and the pointers to its code go with `self`.
        unsafe { ManuallyDrop::take(&mut self.module).free_memory() };
    }
}

impl std::fmt::Debug for MachineCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "MachineCode of {} instructions", self.source.size())
    }
}

/// A translation under way.
struct Translator<'s> {
    source: &'s Source,
    module: JITModule,
    context: Context,
    builder: FunctionBuilderContext,
    signature: Signature,
    known: Known,
    /// The code of each function.
    functions: Vec<FuncId>,
    faults: Faults,
}

/// A part of a tape, before its address is known.
enum Planned {
    Stretch(FuncId),
    Between(Instr),
}

impl Translator<'_> {
    /// `given_up` is asked now and then.
    fn translate(source: Source, given_up: &dyn Fn() -> bool) -> Result<MachineCode, Untranslated> {
        let mut translator = Translator::new(&source)?;
        translator.functions()?;
        let mut planned = Vec::with_capacity(source.tapes.len());
        for tape in &source.tapes {
            planned.push(translator.tape(tape, given_up)?);
        }
        let Translator { mut module, faults, known, .. } = translator;
        module.finalize_definitions().map_err(refused)?;
        let resolve = |planned: Planned| match planned {
            Planned::Stretch(id) => {
                let address = module.get_finalized_function(id);
                // SAFETY: the function was defined with this signature and calling convention.
                Piece::Stretch(unsafe { std::mem::transmute::<*const u8, Stretch>(address) })
            }
            Planned::Between(instruction) => Piece::Between(instruction),
        };
        let tapes =
            planned.into_iter().map(|tape| tape.into_iter().map(resolve).collect()).collect();
        let memo = Memo(known.memo);
        Ok(MachineCode { tapes, faults: faults.0, memo, module: ManuallyDrop::new(module), source })
    }

    fn new(source: &Source) -> Result<Translator<'_>, Untranslated> {
        let cells = source.cells;
        if cells > MOST_CELLS {
            return Err(Untranslated::TooLarge { cells });
        }
        let module = JITModule::new(builder(source)?);
        let mut signature = module.make_signature();
        let pointer = AbiParam::new(module.target_config().pointer_type());
        signature.params = vec![pointer, pointer];
        signature.returns.push(AbiParam::new(types::I32));
        Ok(Translator {
            source,
            context: module.make_context(),
            module,
            builder: FunctionBuilderContext::new(),
            signature,
            known: Known::new(cells, &source.literals),
            functions: Vec::new(),
            faults: Faults::default(),
        })
    }

    /// Declares, then defines the functions of the model, which call each other.
    fn functions(&mut self) -> Result<(), Untranslated> {
        let source = self.source;
        for _ in &source.functions {
            let id = self.declare()?;
            self.functions.push(id);
        }
        for (k, function) in source.functions.iter().enumerate() {
            if source.interpreted[k] {
                // Nothing calls it here; it is declared to keep the numbers.
                self.define(self.functions[k], |cells, _, _| cells.leave(0))?;
                continue;
            }
            self.define(self.functions[k], |cells, faults, call| {
                body::emit(cells, k, function, faults, call);
            })?;
        }
        Ok(())
    }

    fn tape(
        &mut self,
        tape: &[Instr],
        given_up: &dyn Fn() -> bool,
    ) -> Result<Vec<Planned>, Untranslated> {
        let mut planned = Vec::new();
        let source = self.source;
        let is_between = |i: &Instr| match i.op {
            Op::Solve => source.quotients[i.a as usize].is_none(),
            Op::Implicit | Op::Repeat | Op::Unary(Unary::Carried(_)) => true,
            Op::Call => source.interpreted[source.calls[i.a as usize].function],
            _ => false,
        };
        let mut rest = tape;
        while let Some(first) = rest.first() {
            if given_up() {
                return Err(Untranslated::GivenUp);
            }
            if is_between(first) {
                planned.push(Planned::Between(*first));
                rest = &rest[1..];
                continue;
            }
            let length = rest.iter().take(LONGEST).position(is_between);
            let (stretch, after) = rest.split_at(length.unwrap_or(rest.len().min(LONGEST)));
            let id = self.declare()?;
            self.define(id, |cells, faults, call| {
                for i in stretch {
                    match (i.op, i.a as usize) {
                        (Op::Call, k) => call(cells, k),
                        (Op::Solve, k) => body::quotient(cells, source, k, faults, call),
                        _ => cells.compute(i),
                    }
                }
                cells.leave(0);
            })?;
            planned.push(Planned::Stretch(id));
            rest = after;
        }
        Ok(planned)
    }

    fn declare(&mut self) -> Result<FuncId, Untranslated> {
        // A name is not needed: nothing outside of the module refers to it.
        self.module.declare_anonymous_function(&self.signature).map_err(refused)
    }

    /// Makes a function of the module. `fill` gets what emits a call.
    fn define(
        &mut self,
        id: FuncId,
        fill: impl FnOnce(&mut Cells<'_, '_>, &mut Faults, &mut dyn FnMut(&mut Cells<'_, '_>, usize)),
    ) -> Result<(), Untranslated> {
        let Translator { source, module, context, builder, signature, known, functions, faults } =
            self;
        context.func.signature = signature.clone();
        context.func.name = UserFuncName::user(0, id.as_u32());
        let call_conv = module.target_config().default_call_conv;
        let building = FunctionBuilder::new(&mut context.func, builder);
        let mut cells = Cells::begin(building, known, call_conv);
        let mut imported = vec![None; functions.len()];
        let mut call = |cells: &mut Cells<'_, '_>, k: usize| {
            let site = &source.calls[k];
            let code = *imported[site.function].get_or_insert_with(|| {
                module.declare_func_in_func(functions[site.function], cells.build.func)
            });
            body::call(cells, site, &source.functions[site.function], code);
        };
        fill(&mut cells, faults, &mut call);
        cells.build.seal_all_blocks();
        cells.build.finalize(module.target_config());
        let defined = module.define_function(id, context).map_err(refused);
        module.clear_context(context);
        defined
    }
}

fn builder(source: &Source) -> Result<JITBuilder, Untranslated> {
    let mut flags = settings::builder();
    let on_or_off = if cfg!(debug_assertions) { "true" } else { "false" };
    let chosen = [
        // The tapes are short of what could be optimised: expressions are shared and folded already.
        ("opt_level", "none"),
        ("enable_verifier", on_or_off),
        ("use_colocated_libcalls", "false"),
        ("is_pic", "false"),
        ("unwind_info", "false"),
        ("enable_probestack", "false"),
    ];
    for (name, value) in chosen {
        flags.set(name, value).map_err(refused)?;
    }
    let target = cranelift::native::builder().map_err(refused)?;
    let isa = target.finish(settings::Flags::new(flags)).map_err(refused)?;
    let mut builder = JITBuilder::with_isa(isa, default_libcall_names());
    // One region, in which every call reaches every function.
    let reserved = RESERVED_BESIDES + RESERVED * source.size();
    let arena = ArenaMemoryProvider::new_with_size(reserved).map_err(refused)?;
    builder.memory_provider(Box::new(arena));
    Ok(builder)
}

fn refused(why: impl std::fmt::Display) -> Untranslated {
    Untranslated::Refused(why.to_string())
}
