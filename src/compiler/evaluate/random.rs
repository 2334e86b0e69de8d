//! Random number generators of the family xorshift: the next state and a number from a state, as
//! expressions, so that a run may draw numbers too.
//!
//! *S. Vigna, An experimental exploration of Marsaglia's xorshift generators, scrambled, ACM TOMS 42
//! (2016); S. Vigna, Further scramblings of Marsaglia's xorshift generators, J. Comput. Appl. Math. 315
//! (2017).* States are words of 64 bits, each held as two Integers, the lower half first.

use std::sync::Arc;

use super::Evaluator;
use super::external::Refusal;
use super::value::Value;
use crate::base::source::Span;
use crate::external::split_u64::{Half, Operation};
use crate::ir::expr::{Binary, ExprId, Graph};

/// A word of 64 bits: lower and upper half.
#[derive(Clone, Copy)]
struct Word([ExprId; 2]);

/// Words of the state of xorshift1024*.
const WORDS: usize = 16;

impl Evaluator<'_> {
    /// A function of the family `ModelicaRandom_`: a state to the next one and a number.
    pub(super) fn random_function(
        &mut self,
        what: &str,
        args: &[Value],
        span: Span,
    ) -> Result<Vec<Value>, Refusal> {
        match (what, args) {
            ("setInternalState_xorshift1024star", [state, ..]) => return self.set_generator(state),
            ("impureRandom_xorshift1024star", _) => {
                return Ok(vec![Value::Scalar(self.draw(span)?)]);
            }
            _ => {}
        }
        let graph = &mut self.graph;
        let state = match args {
            [Value::Array(a)] => a.elements.iter().map(Value::scalar).collect(),
            _ => None,
        };
        let state: Vec<ExprId> = state.ok_or(Refusal::Unknown)?;
        let (next, number) = match (what, state.as_slice()) {
            ("xorshift64star", &[low, high]) => xorshift64star(graph, Word([low, high])),
            ("xorshift128plus", &[a, b, c, d]) => {
                xorshift128plus(graph, [[a, b], [c, d]].map(Word))
            }
            ("xorshift1024star", state) if state.len() == 2 * WORDS + 1 => {
                xorshift1024star(graph, state)
            }
            _ => return Err(Refusal::Unknown),
        };
        let next = next.into_iter().map(Value::Scalar).collect::<Vec<_>>();
        Ok(vec![Value::array(vec![next.len()], next), Value::Scalar(number)])
    }
}

fn xorshift64star(graph: &mut Graph, word: Word) -> (Vec<ExprId>, ExprId) {
    let x = word.xor_shifted(graph, |half| Operation::ShiftRight(12, half));
    let x = x.xor_shifted(graph, |half| Operation::ShiftLeft(25, half));
    let x = x.xor_shifted(graph, |half| Operation::ShiftRight(27, half));
    let x = x.changed(graph, |half| Operation::Times(2_685_821_657_736_338_717, half));
    (x.0.to_vec(), x.fraction(graph))
}

fn xorshift128plus(graph: &mut Graph, [first, second]: [Word; 2]) -> (Vec<ExprId>, ExprId) {
    let x = first.xor_shifted(graph, |half| Operation::ShiftLeft(23, half));
    let x = x.xor_shifted(graph, |half| Operation::ShiftRight(17, half));
    let y = second.xor_shifted(graph, |half| Operation::ShiftRight(26, half));
    let sum = x.xor(graph, y).plus(graph, second);
    (second.0.into_iter().chain(sum.0).collect(), sum.fraction(graph))
}

/// The last element of the state numbers the word that was drawn last.
fn xorshift1024star(graph: &mut Graph, state: &[ExprId]) -> (Vec<ExprId>, ExprId) {
    let (words, last) = state.split_at(2 * WORDS);
    let words: Vec<Word> = words.chunks_exact(2).map(|w| Word([w[0], w[1]])).collect();
    let count = graph.integer(WORDS as i64);
    let at = graph.binary(Binary::Mod, last[0], count);
    let one = graph.integer(1);
    let after = graph.add(at, one);
    let next = graph.binary(Binary::Mod, after, count);
    let old = Word::chosen(graph, &words, at);
    let x = Word::chosen(graph, &words, next);
    let x = x.xor_shifted(graph, |half| Operation::ShiftLeft(31, half));
    let x = x.xor_shifted(graph, |half| Operation::ShiftRight(11, half));
    let y = old.xor_shifted(graph, |half| Operation::ShiftRight(30, half));
    let drawn = x.xor(graph, y);
    let scrambled = drawn.changed(graph, |half| Operation::Times(1_181_783_497_276_652_981, half));
    let mut all = Vec::with_capacity(state.len());
    for (k, word) in words.iter().enumerate() {
        let here = is_number(graph, next, k);
        all.extend([0, 1].map(|h| graph.if_then_else(here, drawn.0[h], word.0[h])));
    }
    all.push(next);
    (all, scrambled.fraction(graph))
}

fn is_number(graph: &mut Graph, e: ExprId, k: usize) -> ExprId {
    let number = graph.integer(k as i64);
    graph.binary(Binary::Equal, e, number)
}

fn operation(graph: &mut Graph, f: Operation, a: ExprId, b: ExprId) -> ExprId {
    let f = graph.add_external(Arc::new(f));
    graph.binary(Binary::External(f), a, b)
}

impl Word {
    /// The word of a number that counts from 0.
    fn chosen(graph: &mut Graph, words: &[Word], number: ExprId) -> Word {
        let mut result = words[words.len() - 1];
        for (k, word) in words.iter().enumerate().rev().skip(1) {
            let here = is_number(graph, number, k);
            result = Word([0, 1].map(|h| graph.if_then_else(here, word.0[h], result.0[h])));
        }
        result
    }

    fn changed(self, graph: &mut Graph, f: impl Fn(Half) -> Operation) -> Word {
        let Word([low, high]) = self;
        Word([Half::Low, Half::High].map(|half| operation(graph, f(half), low, high)))
    }

    fn xor(self, graph: &mut Graph, other: Word) -> Word {
        Word([0, 1].map(|h| operation(graph, Operation::Xor, self.0[h], other.0[h])))
    }

    fn xor_shifted(self, graph: &mut Graph, f: impl Fn(Half) -> Operation) -> Word {
        let shifted = self.changed(graph, f);
        self.xor(graph, shifted)
    }

    fn plus(self, graph: &mut Graph, other: Word) -> Word {
        let (Word([a, b]), Word([c, d])) = (self, other);
        let low = operation(graph, Operation::Add, a, c);
        let carry = operation(graph, Operation::Carry, a, c);
        let high = operation(graph, Operation::Add, b, d);
        Word([low, operation(graph, Operation::Add, high, carry)])
    }

    fn fraction(self, graph: &mut Graph) -> ExprId {
        operation(graph, Operation::Fraction, self.0[0], self.0[1])
    }
}
