//! Arrays of parameters that a function gets as an argument. A large one is a table: its numbers take the place of the
//! parameters, so that the function looks an element up, where it would be given all of them with each call.
//!
//! The parameters then belong to the structure of the model, like those of the tables that external objects hold.

use super::Evaluator;
use super::value::Value;
use crate::ir::expr::{ExprId, Type};

/// Elements from which an array is a table.
const TABLE: usize = 128;

impl Evaluator<'_> {
    /// Replaces large arrays among the arguments of a function by their numbers, where parameters determine them.
    pub(super) fn with_numbers_of_tables(&mut self, given: &mut [Option<Value>]) {
        if self.mode.is_before_simulation() || self.frames.in_function() {
            return;
        }
        for value in given.iter_mut().flatten() {
            if let Some(numbers) = self.numbers_of_table(value) {
                *value = numbers;
            }
        }
    }

    fn numbers_of_table(&mut self, value: &Value) -> Option<Value> {
        let Value::Array(_) = value else { return None };
        let mut elements: Vec<ExprId> = Vec::new();
        value.for_each_scalar(&mut |e| elements.push(e));
        let graph = &self.graph;
        let is_open = |e: &&ExprId| graph.as_const(**e).is_none();
        if elements.len() < TABLE || elements.iter().find(is_open).is_none() {
            return None;
        }
        let may_be_known = |e: &ExprId| {
            self.graph.ty(*e) == Type::Real && self.may_be_known(self.first_leaf(*e), true)
        };
        if !elements.iter().all(may_be_known) {
            return None;
        }
        let (numbers, problems) = self.collect_problems(|cx| {
            elements.iter().map(|e| cx.parameter_expression(*e, true)).collect::<Option<Vec<_>>>()
        });
        let mut numbers = numbers.filter(|_| problems.is_empty())?.into_iter();
        let graph = &mut self.class_graph.graph;
        Some(value.each_scalar(&mut |e| match numbers.next() {
            Some(number) => graph.constant(number),
            None => e,
        }))
    }
}
