//! Random numbers whose generator keeps its state to itself: impure functions (section 12.3 of the
//! specification).
//!
//! The numbers that the generator draws are counted, so that each is a function of its number. A
//! when-clause counts what it has drawn; at one instant the clauses draw one after the other. What is drawn
//! at the start comes before all others.

use std::sync::Arc;

use super::Evaluator;
use super::external::Refusal;
use super::history::Synthetic;
use super::value::Value;
use crate::base::source::Span;
use crate::external::xorshift1024::Stream;
use crate::ir::expr::{ExprId, Node, Type, Unary, VarId};

/// Where the evaluator stands, for what may be called there.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) enum Place {
    /// At the start, or in a declaration.
    #[default]
    Start,
    /// In equations that hold all the time.
    Always,
    /// In a branch of a when-clause.
    When,
}

/// What is drawn, as far as it was met.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct RandomDraws {
    /// The state of the generator at the start.
    pub generator: Option<Vec<ExprId>>,
    /// Where the evaluator stands.
    pub place: Place,
    /// Numbers that are drawn at the start.
    pub at_start: i64,
    /// The counters of when-clauses that draw, in their order.
    pub counters: Vec<VarId>,
    /// The counter of the clause that is looked at, if it draws.
    counter: Option<VarId>,
    /// Numbers that the branch has drawn that is looked at.
    in_branch: i64,
}

/// A random number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RandomDraw {
    /// The counter of its when-clause; none at the start.
    pub counter: Option<VarId>,
    /// Its number among those that its branch or the start draws, from 1.
    pub number: i64,
    /// Place of the call.
    pub span: Span,
}

impl Evaluator<'_> {
    /// The state of the generator at the start: words of 32 bits, the lower half of each pair first, and
    /// the number of the word drawn last.
    pub(super) fn set_generator(&mut self, state: &Value) -> Result<Vec<Value>, Refusal> {
        let mut words = Vec::new();
        state.for_each_scalar(&mut |e| words.push(e));
        if !self.mode.sizes {
            self.random_draws.generator = Some(words);
        }
        Ok(Vec::new())
    }

    /// The next random number.
    pub(super) fn draw(&mut self, span: Span) -> Result<ExprId, Refusal> {
        if self.mode.is_before_simulation() {
            return Ok(self.graph.real(0.5));
        }
        let (counter, number) = match self.random_draws.place {
            Place::Always => {
                let why = "it gives another number at each call: call it in a when-clause or at the start";
                return Err(Refusal::Wrong(why.into()));
            }
            Place::Start => {
                self.random_draws.at_start += 1;
                (None, self.random_draws.at_start)
            }
            Place::When => {
                let counter = match self.random_draws.counter {
                    Some(counter) => counter,
                    None => {
                        let counter = self.make(Synthetic::Counter(span));
                        self.random_draws.counters.push(counter);
                        self.random_draws.counter = Some(counter);
                        counter
                    }
                };
                self.random_draws.in_branch += 1;
                (Some(counter), self.random_draws.in_branch)
            }
        };
        let v = self.make(Synthetic::Number(RandomDraw { counter, number, span }));
        Ok(self.graph.var(v, Type::Real))
    }

    /// The random number of a number, that a generator draws which begins with a state.
    pub(crate) fn drawn(&mut self, state: &[i64], number: ExprId) -> ExprId {
        let half = |k: usize| u64::from(state.get(k).map_or(0, |half| *half as u32));
        let seed = std::array::from_fn(|k| half(2 * k + 1) << 32 | half(2 * k));
        let last = state.last().map_or(0, |last| last.rem_euclid(16) as usize);
        let stream = self.graph.add_external(Arc::new(Stream::new(seed, last)));
        self.graph.unary(Unary::External(stream), number)
    }

    /// Looks at what stands in a place.
    pub(crate) fn in_place<T>(&mut self, place: Place, act: impl FnOnce(&mut Self) -> T) -> T {
        let around = std::mem::replace(&mut self.random_draws.place, place);
        let result = act(self);
        self.random_draws.place = around;
        result
    }

    /// Looks at a when-clause.
    pub(crate) fn in_when<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        (self.random_draws.counter, self.random_draws.in_branch) = (None, 0);
        self.in_place(Place::When, act)
    }

    /// A branch of a when-clause ends: its counter, if it draws, and the value that this has from then on.
    pub(crate) fn leave_branch(&mut self) -> Option<(VarId, ExprId)> {
        let drawn = std::mem::take(&mut self.random_draws.in_branch);
        let counter = self.random_draws.counter.filter(|_| drawn > 0)?;
        let before = self.graph.intern(Node::Pre(counter), Type::Integer);
        let drawn = self.graph.integer(drawn);
        Some((counter, self.graph.add(before, drawn)))
    }
}
