//! Compiles tapes to machine code.
//!
//! In: a [`Program`]. Out: [`MachineCode`], immutable and shared by any number of runs and threads.
//! It leaves the same values in the same slots as the [interpreter](super::machine), bit for bit
//! (except for the sign and payload of NaN, which Rust does not specify). Torn blocks with more
//! than one unknown, their derivatives and mixed blocks are executed in Rust: tapes are split
//! there.
//!
//! Cranelift selects instructions and allocates registers; `slots` generates its input. The
//! interpreter remains for tapes that run too rarely to be worth compiling, for clamped arguments,
//! for targets that Cranelift does not support, and as the oracle of the tests.
#![allow(unsafe_code)] // Only here: calls generated code and frees its memory.

mod body;
mod external;
mod slots;
mod source;
pub mod tiering;

use std::mem::ManuallyDrop;

use cranelift::codegen::Context;
use cranelift::codegen::ir::UserFuncName;
use cranelift::jit::{ArenaMemoryProvider, JITBuilder, JITModule};
use cranelift::module::{FuncId, Module, default_libcall_names};
use cranelift::prelude::*;

use self::body::Faults;
use self::slots::{FragmentBuilder, RegisterState};
use self::source::Source;
use super::machine::Fault;
use crate::ir::expr::Unary;
use crate::ir::program::{Instr, Op, Program};

/// Maximum number of instructions in one function: the time of register allocation grows faster
/// than linearly.
pub const MAX_FRAGMENT_LENGTH: usize = 1000;
/// Address space reserved for the machine code of an instruction, bytes; four times the typical
/// size.
const BYTES_PER_INSTRUCTION: usize = 256;
/// Address space reserved in addition, bytes.
const BASE_BYTES: usize = 1 << 20;
/// Maximum number of slots that an offset of 31 bits can address.
const MAX_SLOTS: usize = (i32::MAX as usize) / size_of::<f64>();

/// Why a program was not compiled to machine code. The interpreter gives the same results.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum TranslationError {
    /// Cranelift does not support the target or an instruction.
    #[error("cannot compile to machine code for this machine: {0}")]
    Unsupported(String),
    /// The program is larger than offsets reach.
    #[error("the program has {cells} cells, more than machine code can reach")]
    TooLarge {
        /// Its number of cells.
        cells: usize,
    },
    /// The run that requested the code has ended.
    #[error("the translation was given up")]
    Cancelled,
    /// The program refers to something that does not exist.
    #[error("{0}")]
    Invalid(String),
}

/// Code of a fragment of a tape: operates on the memory; returns 0 or the number of a fault.
type Fragment = unsafe extern "C" fn(memory: *mut f64, memo: *mut f64) -> u32;

/// A part of a tape.
enum TapePart {
    /// Machine code.
    Fragment(Fragment),
    /// Executed in Rust.
    Interpreted(Instr),
}

/// Memoized calls of elementary functions of one run. Entries are pure function values and never
/// become invalid.
#[derive(Clone, Debug)]
pub struct Memo(Vec<f64>);

/// The machine code of a program.
pub struct MachineCode {
    source: Source,
    tapes: Vec<Vec<TapePart>>,
    faults: Vec<Fault>,
    memo: Memo,
    module: ManuallyDrop<JITModule>,
}

// SAFETY: after `translate` nothing writes to the module or its code: all methods take `&self` and
// only read pointers to code that depends on its arguments alone.
unsafe impl Send for MachineCode {}
// SAFETY: as above.
unsafe impl Sync for MachineCode {}

impl MachineCode {
    /// Compiles all tapes of a program. Takes some microseconds per instruction.
    pub fn translate(program: &Program) -> Result<MachineCode, TranslationError> {
        program.verify().map_err(TranslationError::Invalid)?;
        Translator::translate(Source::of(program), &|| false)
    }

    /// True if this is the machine code of `program` or of an identical one.
    pub fn is_of(&self, program: &Program) -> bool {
        self.source.is_of(program)
    }

    /// The initial memo of a run.
    pub fn memo(&self) -> Memo {
        self.memo.clone()
    }

    /// Executes a tape from part `at` to its end or up to an instruction that must be executed in
    /// Rust; returns that instruction and the position of the next part. Panics if the memory is
    /// not that of the program, or `memo` not that of this machine code, which is a bug.
    pub fn run(
        &self,
        tape: u32,
        at: usize,
        memory: &mut [f64],
        memo: &mut Memo,
    ) -> Result<Option<(Instr, usize)>, Fault> {
        assert!(memory.len() >= self.source.slots, "the memory of another program");
        assert!(memo.0.len() == self.memo.0.len(), "the memo of another program");
        for (k, piece) in self.tapes[tape as usize].iter().enumerate().skip(at) {
            match *piece {
                TapePart::Fragment(fragment_code) => {
                    // SAFETY: the code was made by `Translator` for `source`, which was verified:
                    // it reads and writes only slots below `source.slots`, all of which `memory`
                    // has, and the entries of `self.memo`, as many as `memo` has; it calls only
                    // itself and `external`. It is not freed before `self` is dropped.
                    match unsafe { fragment_code(memory.as_mut_ptr(), memo.0.as_mut_ptr()) } {
                        0 => {}
                        fault => return Err(self.faults[fault as usize - 1]),
                    }
                }
                TapePart::Interpreted(instruction) => return Ok(Some((instruction, k + 1))),
            }
        }
        Ok(None)
    }
}

impl Drop for MachineCode {
    fn drop(&mut self) {
        // SAFETY: the module is not used after this, and the pointers to its code are dropped with
        // `self`.
        unsafe { ManuallyDrop::take(&mut self.module).free_memory() };
    }
}

impl std::fmt::Debug for MachineCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "MachineCode of {} instructions", self.source.size())
    }
}

/// A translation in progress.
struct Translator<'s> {
    source: &'s Source,
    module: JITModule,
    context: Context,
    builder: FunctionBuilderContext,
    signature: Signature,
    registers: RegisterState,
    /// The code of each function.
    functions: Vec<FuncId>,
    faults: Faults,
}

/// A part of a tape before its address is known.
enum PlannedPart {
    Fragment(FuncId),
    Interpreted(Instr),
}

impl Translator<'_> {
    /// `is_cancelled` is asked now and then.
    fn translate(
        source: Source,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<MachineCode, TranslationError> {
        let mut translator = Translator::new(&source)?;
        translator.functions()?;
        let mut parts = Vec::with_capacity(source.tapes.len());
        for tape in &source.tapes {
            parts.push(translator.tape(tape, is_cancelled)?);
        }
        let Translator { mut module, faults, registers, .. } = translator;
        module.finalize_definitions().map_err(unsupported)?;
        let resolve = |parts: PlannedPart| match parts {
            PlannedPart::Fragment(id) => {
                let address = module.get_finalized_function(id);
                // SAFETY: the function was defined with this signature and calling convention.
                TapePart::Fragment(unsafe { std::mem::transmute::<*const u8, Fragment>(address) })
            }
            PlannedPart::Interpreted(instruction) => TapePart::Interpreted(instruction),
        };
        let tapes = parts.into_iter().map(|tape| tape.into_iter().map(resolve).collect()).collect();
        let memo = Memo(registers.memo);
        Ok(MachineCode { tapes, faults: faults.0, memo, module: ManuallyDrop::new(module), source })
    }

    fn new(source: &Source) -> Result<Translator<'_>, TranslationError> {
        let cells = source.slots;
        if cells > MAX_SLOTS {
            return Err(TranslationError::TooLarge { cells });
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
            registers: RegisterState::new(cells, &source.literals),
            functions: Vec::new(),
            faults: Faults::default(),
        })
    }

    /// Declares, then defines the functions of the model, which call each other.
    fn functions(&mut self) -> Result<(), TranslationError> {
        let source = self.source;
        for _ in &source.functions {
            let id = self.declare()?;
            self.functions.push(id);
        }
        for (k, function) in source.functions.iter().enumerate() {
            if source.interpreted[k] {
                // Machine code does not call it; it is declared to keep the numbering.
                self.define(self.functions[k], |fragment, _, _| fragment.return_status(0))?;
                continue;
            }
            self.define(self.functions[k], |fragment, faults, call| {
                body::emit(fragment, k, function, faults, call);
            })?;
        }
        Ok(())
    }

    fn tape(
        &mut self,
        tape: &[Instr],
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<Vec<PlannedPart>, TranslationError> {
        let mut parts = Vec::new();
        let source = self.source;
        let is_interpreted = |i: &Instr| match i.op {
            Op::Solve => source.scalar_blocks[i.a as usize].is_none(),
            Op::Differentiate | Op::Iterate | Op::Unary(Unary::Carried(_)) => true,
            Op::Call => source.interpreted[source.calls[i.a as usize].function],
            _ => false,
        };
        let mut rest = tape;
        while let Some(first) = rest.first() {
            if is_cancelled() {
                return Err(TranslationError::Cancelled);
            }
            if is_interpreted(first) {
                parts.push(PlannedPart::Interpreted(*first));
                rest = &rest[1..];
                continue;
            }
            let length = rest.iter().take(MAX_FRAGMENT_LENGTH).position(is_interpreted);
            let (fragment_code, after) =
                rest.split_at(length.unwrap_or(rest.len().min(MAX_FRAGMENT_LENGTH)));
            let id = self.declare()?;
            self.define(id, |fragment, faults, call| {
                for i in fragment_code {
                    match (i.op, i.a as usize) {
                        (Op::Call, k) => call(fragment, k),
                        (Op::Solve, k) => body::scalar_block(fragment, source, k, faults, call),
                        _ => fragment.compute(i),
                    }
                }
                fragment.return_status(0);
            })?;
            parts.push(PlannedPart::Fragment(id));
            rest = after;
        }
        Ok(parts)
    }

    fn declare(&mut self) -> Result<FuncId, TranslationError> {
        // It needs no name: nothing outside of the module refers to it.
        self.module.declare_anonymous_function(&self.signature).map_err(unsupported)
    }

    /// Defines a function of the module. `fill` receives a callback that emits a call.
    fn define(
        &mut self,
        id: FuncId,
        fill: impl FnOnce(
            &mut FragmentBuilder<'_, '_>,
            &mut Faults,
            &mut dyn FnMut(&mut FragmentBuilder<'_, '_>, usize),
        ),
    ) -> Result<(), TranslationError> {
        let Translator {
            source,
            module,
            context,
            builder,
            signature,
            registers,
            functions,
            faults,
        } = self;
        context.func.signature = signature.clone();
        context.func.name = UserFuncName::user(0, id.as_u32());
        let call_conv = module.target_config().default_call_conv;
        let building = FunctionBuilder::new(&mut context.func, builder);
        let mut fragment =
            FragmentBuilder::begin(building, registers, &source.externals, call_conv);
        let mut imported = vec![None; functions.len()];
        let mut call = |fragment: &mut FragmentBuilder<'_, '_>, k: usize| {
            let site = &source.calls[k];
            let code = *imported[site.function].get_or_insert_with(|| {
                module.declare_func_in_func(functions[site.function], fragment.build.func)
            });
            body::call(fragment, site, &source.functions[site.function], code);
        };
        fill(&mut fragment, faults, &mut call);
        fragment.build.seal_all_blocks();
        fragment.build.finalize(module.target_config());
        let defined = module.define_function(id, context).map_err(unsupported);
        module.clear_context(context);
        defined
    }
}

fn builder(source: &Source) -> Result<JITBuilder, TranslationError> {
    let mut flags = settings::builder();
    let on_or_off = if cfg!(debug_assertions) { "true" } else { "false" };
    let chosen = [
        // The tapes leave little to optimize: expressions are already shared and folded.
        ("opt_level", "none"),
        ("enable_verifier", on_or_off),
        ("use_colocated_libcalls", "false"),
        ("is_pic", "false"),
        ("unwind_info", "false"),
        ("enable_probestack", "false"),
    ];
    for (name, value) in chosen {
        flags.set(name, value).map_err(unsupported)?;
    }
    let target = cranelift::native::builder().map_err(unsupported)?;
    let isa = target.finish(settings::Flags::new(flags)).map_err(unsupported)?;
    let mut builder = JITBuilder::with_isa(isa, default_libcall_names());
    // One region, so that every call can reach every function.
    let reserved = BASE_BYTES + BYTES_PER_INSTRUCTION * source.size();
    let arena = ArenaMemoryProvider::new_with_size(reserved).map_err(unsupported)?;
    builder.memory_provider(Box::new(arena));
    Ok(builder)
}

fn unsupported(why: impl std::fmt::Display) -> TranslationError {
    TranslationError::Unsupported(why.to_string())
}
