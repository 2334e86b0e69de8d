//! Whether to translate at all: rent or buy.
//!
//! Translating costs as much as interpreting every instruction about a thousand times. How long a run
//! will be is not known before; so the program is interpreted until that has cost as much as the
//! translation would, and translated then, on a thread of its own, while the interpreter goes on.
//! That never costs more than twice of what would have been best (the ski rental problem: Karlin,
//! Manasse, Rudolph, Sleator, *Competitive snoopy caching*, Algorithmica 3, 1988, sec. 3).
//!
//! When the machine code takes over depends on the machine, but nothing that is computed does: both
//! compute the same to the bit.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use super::source::Source;
use super::{MachineCode, Memo, Translator};
use crate::ir::program::Program;

/// Interpretations of an instruction that cost as much as its translation: three to four microseconds
/// against three nanoseconds, and something for the thread.
const PRICE: u64 = 1500;

/// How a run computes.
#[derive(Clone, Debug, Default)]
pub enum Execution {
    /// By the interpreter, until that has cost as much as a translation; then by machine code.
    #[default]
    Adaptive,
    /// By the interpreter.
    Interpreted,
    /// By machine code that was made before. If it is that of another program, the run is
    /// interpreted.
    Machine(Arc<MachineCode>),
}

impl Execution {
    /// By machine code from the start, for a program that will run many times: it is translated here,
    /// once for all runs and threads. By the interpreter where machine code can not be had.
    pub fn translated(program: &Program) -> Execution {
        match MachineCode::translate(program) {
            Ok(code) => Execution::Machine(Arc::new(code)),
            Err(_) => Execution::Interpreted,
        }
    }
}

impl PartialEq for Execution {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Execution::Machine(a), Execution::Machine(b)) => Arc::ptr_eq(a, b),
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

/// The machine code of a run, if there is any yet.
pub enum Code {
    /// There will never be any.
    Interpreted,
    /// This, and what it remembers.
    Machine(Arc<MachineCode>, Memo),
    /// Interpreted so far.
    Rented(Rent),
}

/// What was spent on interpretation.
pub struct Rent {
    spent: u64,
    price: u64,
    order: Option<Order>,
}

/// A translation on its thread, given up when this is dropped.
struct Order {
    done: Arc<OnceLock<Option<Arc<MachineCode>>>>,
    given_up: Arc<AtomicBool>,
}

impl Code {
    /// For a run of this program.
    pub fn of(program: &Program, execution: &Execution) -> Code {
        match execution {
            Execution::Interpreted => Code::Interpreted,
            Execution::Machine(code) if code.is_of(program) => Code::with(Arc::clone(code)),
            Execution::Machine(_) => Code::Interpreted,
            Execution::Adaptive => {
                let instructions: usize = program.tapes().iter().map(|(_, t)| t.len()).sum();
                let price = PRICE * instructions as u64;
                Code::Rented(Rent { spent: 0, price, order: None })
            }
        }
    }

    fn with(code: Arc<MachineCode>) -> Code {
        let memo = code.memo();
        Code::Machine(code, memo)
    }

    /// True if the machine code is there; else notes that `instructions` more are interpreted.
    #[inline]
    pub fn is_there(&mut self, program: &Program, instructions: usize) -> bool {
        if let Code::Rented(rent) = self {
            rent.spent += instructions as u64;
            if rent.spent >= rent.price
                && let Some(code) = rent.bought(program)
            {
                *self = code;
            }
        }
        matches!(self, Code::Machine(..))
    }
}

impl Rent {
    /// Orders a translation, or looks whether it has come.
    #[cold]
    fn bought(&mut self, program: &Program) -> Option<Code> {
        // Not at each tape.
        self.price = self.spent + self.spent / 16;
        let Some(order) = &self.order else {
            self.order = Order::place(program);
            return self.order.is_none().then_some(Code::Interpreted);
        };
        let outcome = order.done.get()?;
        Some(outcome.clone().map_or(Code::Interpreted, Code::with))
    }
}

impl Order {
    /// None if there can be no thread, or no machine code.
    fn place(program: &Program) -> Option<Order> {
        program.verify().ok()?;
        let source = Source::of(program);
        let done = Arc::new(OnceLock::new());
        let given_up = Arc::new(AtomicBool::new(false));
        let (result, asked) = (Arc::clone(&done), Arc::clone(&given_up));
        let work = move || {
            let code = Translator::translate(source, &|| asked.load(Ordering::Relaxed));
            // There is no other to set it.
            let _ = result.set(code.ok().map(Arc::new));
        };
        std::thread::Builder::new().name("translate".into()).spawn(work).ok()?;
        Some(Order { done, given_up })
    }
}

impl Drop for Order {
    fn drop(&mut self) {
        self.given_up.store(true, Ordering::Relaxed);
    }
}
