//! Tiered execution: decides when to compile to machine code.
//!
//! Compiling an instruction costs as much as interpreting it about a thousand times, and the length
//! of a run is not known in advance. So a program is interpreted until that has cost as much as
//! compiling it, and is then compiled in another thread while the interpreter continues. This never
//! costs more than twice the optimum (the ski rental problem: Karlin, Manasse, Rudolph, Sleator,
//! *Competitive snoopy caching*, Algorithmica 3, 1988, sec. 3).
//!
//! The moment of the switch depends on the computer, but results do not: both tiers agree bit for
//! bit.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use super::source::Source;
use super::{MachineCode, Memo, Translator};
use crate::ir::program::Program;

/// Number of interpretations of an instruction that cost as much as compiling it: three to four
/// microseconds against three nanoseconds, plus an allowance for the thread.
const TRANSLATION_COST: u64 = 1500;

/// How a run executes its program.
#[derive(Clone, Debug)]
pub enum Execution {
    /// Interpreted until that has cost as much as a compilation, then by machine code.
    Adaptive(Starter),
    /// Interpreted.
    Interpreted,
    /// By existing machine code. If it belongs to another program, the run is interpreted.
    Compiled(Arc<MachineCode>),
}

/// What starts a compilation. A program that never names it, such as the runtime of FMUs, does not contain the
/// compiler.
#[derive(Clone, Copy, Debug)]
pub struct Starter(fn(&Program) -> Option<Translation>);

impl Default for Execution {
    fn default() -> Self {
        Execution::Adaptive(Starter(Translation::start))
    }
}

impl Execution {
    /// Compiles a program that will run many times, once for all runs and threads. Falls back to
    /// the interpreter if the program cannot be compiled.
    pub fn translated(program: &Program) -> Execution {
        match MachineCode::translate(program) {
            Ok(code) => Execution::Compiled(Arc::new(code)),
            Err(_) => Execution::Interpreted,
        }
    }
}

impl PartialEq for Execution {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Execution::Compiled(a), Execution::Compiled(b)) => Arc::ptr_eq(a, b),
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

/// The current execution tier of a run.
pub enum Tier {
    /// Interpreted for the whole run.
    Interpreted,
    /// Machine code and its memo.
    Compiled(Arc<MachineCode>, Memo),
    /// Interpreted until compiling pays.
    Interpreting(TierUp),
}

/// Counts interpreted instructions and starts the compilation at a threshold.
pub struct TierUp {
    starter: Starter,
    interpreted: u64,
    threshold: u64,
    translation: Option<Translation>,
}

/// A compilation in its thread; cancelled on drop.
#[derive(Debug)]
pub struct Translation {
    done: Arc<OnceLock<Option<Arc<MachineCode>>>>,
    cancelled_flag: Arc<AtomicBool>,
}

impl Tier {
    /// The initial tier of a run.
    pub fn of(program: &Program, execution: &Execution) -> Tier {
        match execution {
            Execution::Interpreted => Tier::Interpreted,
            Execution::Compiled(code) if code.is_of(program) => Tier::with(Arc::clone(code)),
            Execution::Compiled(_) => Tier::Interpreted,
            Execution::Adaptive(starter) => {
                let tapes: usize = program.all_tapes().iter().map(|(_, t)| t.len()).sum();
                let functions = &program.routines.functions;
                let instructions = tapes + functions.iter().map(|f| f.tape.len()).sum::<usize>();
                let threshold = TRANSLATION_COST * instructions as u64;
                Tier::Interpreting(TierUp {
                    starter: *starter,
                    interpreted: 0,
                    threshold,
                    translation: None,
                })
            }
        }
    }

    fn with(code: Arc<MachineCode>) -> Tier {
        let memo = code.memo();
        Tier::Compiled(code, memo)
    }

    /// True if machine code is available; otherwise counts `instructions` as interpreted.
    #[inline]
    pub fn is_compiled(&mut self, program: &Program, instructions: usize) -> bool {
        if let Tier::Interpreting(tier_up) = self {
            tier_up.interpreted += instructions as u64;
            if tier_up.interpreted >= tier_up.threshold
                && let Some(code) = tier_up.poll(program)
            {
                *self = code;
            }
        }
        matches!(self, Tier::Compiled(..))
    }
}

impl TierUp {
    /// Starts the compilation, or checks whether it has finished.
    #[cold]
    fn poll(&mut self, program: &Program) -> Option<Tier> {
        // Do not poll at each tape.
        self.threshold = self.interpreted + self.interpreted / 16;
        let Some(translation) = &self.translation else {
            self.translation = (self.starter.0)(program);
            return self.translation.is_none().then_some(Tier::Interpreted);
        };
        let outcome = translation.done.get()?;
        Some(outcome.clone().map_or(Tier::Interpreted, Tier::with))
    }
}

impl Translation {
    /// Starts a compilation; `None` if the program is invalid or no thread can be created.
    fn start(program: &Program) -> Option<Translation> {
        program.verify().ok()?;
        let source = Source::of(program);
        let done = Arc::new(OnceLock::new());
        let cancelled_flag = Arc::new(AtomicBool::new(false));
        let (result, cancelled) = (Arc::clone(&done), Arc::clone(&cancelled_flag));
        let work = move || {
            let code = Translator::translate(source, &|| cancelled.load(Ordering::Relaxed));
            // Only this thread sets it.
            let _ = result.set(code.ok().map(Arc::new));
        };
        std::thread::Builder::new().name("translate".into()).spawn(work).ok()?;
        Some(Translation { done, cancelled_flag })
    }
}

impl Drop for Translation {
    fn drop(&mut self) {
        self.cancelled_flag.store(true, Ordering::Relaxed);
    }
}
