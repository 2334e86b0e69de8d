//! Functions of numbers that are made of data: tables, and operations on words of bits.
//!
//! *Holds:* each such function once, with its number. A [`Native`] is that number, so that operators
//! which are functions can be copied and compared like all others.
//! *Never holds:* anything that a run changes.
//! *Made by:* `instantiate`, from external objects. *Read by:* `symbolic::eval`, which calls them.

use std::cmp::Ordering;
use std::sync::RwLock;

use crate::base::name::{name, string_id, string_of_id};
use crate::external::printf::Form;
use crate::external::split_u64::Operation;
use crate::external::table::curve::Curve;
use crate::external::table::surface::Surface;
use crate::external::table::time_table::TimeTable;
use crate::external::xorshift1024::Stream;

/// A function that is made of data, by its number. Equal functions have equal numbers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Native(u32);

/// What it computes.
#[derive(Clone, PartialEq, Debug)]
pub enum Function {
    /// The derivative of this order of a curve: one argument.
    Curve(u8, Curve),
    /// The derivative of this order of a table: time and the time of the next event.
    TimeTable(u8, TimeTable),
    /// The next event of a table after an instant: one argument.
    NextStop(TimeTable),
    /// The partial derivative of these orders of a surface: two arguments.
    Surface((u8, u8), Surface),
    /// An operation on words of bits: two arguments.
    Word(Operation),
    /// A random number by its number: one argument.
    Drawn(Stream),
    /// A number, which may be a whole one, as the number of a text: one argument.
    Written(Form, bool),
    /// The element of this number, counted from 1, of some that are all whole or not: one argument. Beyond them
    /// the first or the last.
    Elements(Vec<f64>, bool),
    /// Two texts as one: two arguments, numbers of texts as the result.
    Joined,
    /// Whether two texts stand as one of these says in the order of their characters: two arguments.
    Ordered(Vec<Ordering>),
}

/// All functions so far. They are few, and stay for as long as the process does.
static KNOWN: RwLock<Vec<&'static Function>> = RwLock::new(Vec::new());

impl Native {
    /// The number of a function.
    pub fn of(function: Function) -> Native {
        let mut known = KNOWN.write().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(at) = known.iter().position(|f| **f == function) {
            return Native(at as u32);
        }
        known.push(Box::leak(Box::new(function)));
        Native(known.len() as u32 - 1)
    }

    /// The number, for what can hold nothing else.
    pub fn number(self) -> u32 {
        self.0
    }

    /// From its number.
    pub fn numbered(number: u32) -> Native {
        Native(number)
    }

    /// The function.
    pub fn function(self) -> &'static Function {
        KNOWN.read().unwrap_or_else(std::sync::PoisonError::into_inner)[self.0 as usize]
    }

    /// The value of a function of one number.
    pub fn unary(self, a: f64) -> f64 {
        match self.function() {
            Function::Curve(order, curve) => curve.at(a, *order),
            Function::NextStop(table) => table.next_stop(a),
            Function::Drawn(stream) => stream.number(a),
            Function::Elements(all, _) => {
                let at = (a.max(1.0) as usize - 1).min(all.len().saturating_sub(1));
                all.get(at).copied().unwrap_or(f64::NAN)
            }
            Function::Written(form, whole) => {
                let text = form.of(a, *whole).unwrap_or_default();
                f64::from(string_id(name(&text)))
            }
            _ => f64::NAN,
        }
    }

    /// The value of a function of two numbers.
    pub fn binary(self, a: f64, b: f64) -> f64 {
        match self.function() {
            Function::TimeTable(order, table) => table.at(a, b, *order),
            Function::Surface(orders, surface) => surface.at(a, b, *orders),
            Function::Word(operation) => operation.at(a, b),
            Function::Joined => {
                let (a, b) = (string_of_id(a as u32), string_of_id(b as u32));
                f64::from(string_id(name(&format!("{a}{b}"))))
            }
            Function::Ordered(wanted) => {
                let (a, b) = (string_of_id(a as u32), string_of_id(b as u32));
                f64::from(u8::from(wanted.contains(&a.as_str().cmp(b.as_str()))))
            }
            _ => f64::NAN,
        }
    }

    /// The derivative by an argument (counted from 0); `None` if it is 0 everywhere.
    pub fn derivative(self, argument: usize) -> Option<Native> {
        let derived = match (self.function(), argument) {
            // The polynomials are cubic.
            (Function::Curve(order @ 0..3, curve), 0) => Function::Curve(order + 1, curve.clone()),
            (Function::TimeTable(order @ 0..3, table), 0) => {
                Function::TimeTable(order + 1, table.clone())
            }
            (Function::Surface((k @ 0..3, l), surface), 0) => {
                Function::Surface((k + 1, *l), surface.clone())
            }
            (Function::Surface((k, l @ 0..3), surface), 1) => {
                Function::Surface((*k, l + 1), surface.clone())
            }
            _ => return None,
        };
        Some(Native::of(derived))
    }

    /// The slope of a function of one number.
    pub fn slope(self, a: f64) -> f64 {
        match self.function() {
            Function::Curve(order, curve) => curve.at(a, order + 1),
            _ => 0.0,
        }
    }

    /// The slopes of a function of two numbers, by the first and by the second.
    pub fn slopes(self, a: f64, b: f64) -> (f64, f64) {
        match self.function() {
            Function::TimeTable(order, table) => (table.at(a, b, order + 1), 0.0),
            Function::Surface((k, l), s) => (s.at(a, b, (k + 1, *l)), s.at(a, b, (*k, l + 1))),
            _ => (0.0, 0.0),
        }
    }

    /// False for what steps from one value to the next.
    pub fn has_slope(self) -> bool {
        matches!(
            self.function(),
            Function::Curve(..) | Function::TimeTable(..) | Function::Surface(..)
        )
    }

    /// True if the values are whole numbers.
    pub fn is_whole(self) -> bool {
        match self.function() {
            Function::Word(operation) => operation.is_whole(),
            Function::Elements(_, whole) => *whole,
            _ => false,
        }
    }

    /// What it chooses from, if it chooses elements.
    pub fn elements(self) -> Option<(&'static [f64], bool)> {
        match self.function() {
            Function::Elements(all, whole) => Some((all, *whole)),
            _ => None,
        }
    }

    /// What it is called in texts.
    pub fn name(self) -> &'static str {
        match self.function() {
            Function::Curve(0, _) | Function::TimeTable(0, _) | Function::Surface((0, 0), _) => {
                "table"
            }
            Function::NextStop(_) => "nextTimeEvent",
            Function::Word(_) => "word",
            Function::Drawn(_) => "randomNumber",
            Function::Elements(..) => "element",
            Function::Written(..) => "String",
            Function::Joined => "joinedTexts",
            Function::Ordered(_) => "ordered",
            Function::Curve(..) | Function::TimeTable(..) | Function::Surface(..) => {
                "derivativeOfTable"
            }
        }
    }
}
