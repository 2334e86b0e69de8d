//! Two effects at once: what they would explain together, before either is fitted.
//!
//! Where two effects are missing, each by itself may explain little, and what explains most by itself may
//! be neither. The score test of both together, from one run with all candidates attached, tells.

use crate::base::index::FastSet;

use super::case::Case;
use super::level::Level;
use super::preference::{CURVE, EVIDENCE};
use super::rank::{Candidate, ENOUGH, Linearised, Scored, Scoring};

/// Candidates that pairs are made of.
const CANDIDATES: usize = 400;
/// Pairs that are fitted.
const FITTED: usize = 8;
/// Of these, those that have one effect at one place in common.
const ALIKE: usize = 3;

/// A law with a shape, and the candidates that it is made of.
struct Law<'a> {
    scored: &'a Scored,
    /// The best shape of the same effect at the same place.
    best: &'a Scored,
    /// Position of the effect and place among all.
    number: usize,
    members: Vec<usize>,
}

/// Two laws, and what they promise together.
struct Pair {
    laws: [usize; 2],
    amplitudes: Vec<f64>,
    worth: f64,
}

/// The pairs of laws that promise most, best first. `ranking`: the scores of each by itself.
pub fn pairs(case: &Case<'_>, level: &Level, ranking: &[Scored]) -> Vec<Vec<Scored>> {
    let (candidates, laws) = candidates(case, ranking);
    (case.say)(&format!("scoring pairs of {} laws", laws.len()));
    let scoring = Scoring::new(case, level, &candidates, ENOUGH);
    let all: Vec<usize> = (0..candidates.len()).collect();
    let Some(linearised) = scoring.linearised(&all) else { return Vec::new() };
    let mut all = scored(case, level, &laws, &linearised);
    all.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    let mut used = vec![0; ranking.len()];
    let mut known = FastSet::default();
    let mut best = Vec::new();
    for Pair { laws: [i, j], amplitudes, worth } in all {
        let (first, second) = (&laws[i], &laws[j]);
        let numbers = [first.number, second.number];
        if best.len() == FITTED || numbers.iter().any(|n| used[*n] == ALIKE) {
            continue;
        }
        if !known.insert(numbers) {
            continue;
        }
        numbers.iter().for_each(|n| used[*n] += 1);
        let of_first = first.members.len() * case.effects[first.scored.effect].amplitudes.len();
        let (of_first, of_second) = amplitudes.split_at(of_first);
        let both = [first.proposed(worth, of_first), second.proposed(worth, of_second)];
        let share = 100.0 * worth / level.train.total();
        let [a, b] = [0, 1].map(|k| case.named(both[k].effect, &both[k].place));
        (case.say)(&format!("  score {share:5.1} %  {a} and {b}"));
        best.push(both.into());
    }
    best
}

impl Law<'_> {
    /// The law with what a pair promises, and its amplitudes; its other shapes are those that are best by
    /// themselves.
    fn proposed(&self, gain: f64, amplitudes: &[f64]) -> Scored {
        let others = match std::ptr::eq(self.scored, self.best) {
            true => self.best.others.clone(),
            false => vec![Scored { others: Vec::new(), ..self.best.clone() }],
        };
        Scored { gain, amplitudes: amplitudes.to_vec(), others, ..self.scored.clone() }
    }
}

/// The score of every two of the laws that is worth its amplitudes.
fn scored(case: &Case<'_>, level: &Level, laws: &[Law<'_>], linearised: &Linearised) -> Vec<Pair> {
    let price = (level.train.count() as f64).ln();
    let mut pairs = Vec::new();
    for (j, second) in laws.iter().enumerate() {
        for (i, first) in laws[..j].iter().enumerate() {
            if first.number == second.number
                || first.members.iter().any(|c| second.members.contains(c))
            {
                continue;
            }
            let both = [first, second].map(|l| (l.scored.effect, l.members.as_slice()));
            if let Some(found) = linearised.score(case, &both) {
                let worth = found.gain - price * found.amplitudes.len() as f64;
                if worth > EVIDENCE {
                    pairs.push(Pair { laws: [i, j], amplitudes: found.amplitudes, worth });
                }
            }
        }
    }
    pairs
}

/// What pairs are made of, with all shapes.
fn candidates<'a>(case: &Case<'_>, ranking: &'a [Scored]) -> (Vec<Candidate>, Vec<Law<'a>>) {
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut laws = Vec::new();
    for (number, best) in ranking.iter().enumerate() {
        let effect = &case.effects[best.effect];
        if effect.amplitudes.len() >= CURVE {
            continue;
        }
        for scored in std::iter::once(best).chain(&best.others) {
            let places = scored.place.members();
            // What is built into a component is there once, with one shape.
            let clash = |c: &Candidate| {
                let here = c.effect == scored.effect && places.contains(&c.place);
                effect.built_in && here && c.shape != scored.shape
            };
            if candidates.len() >= CANDIDATES || candidates.iter().any(clash) {
                continue;
            }
            let mut members = Vec::new();
            for place in places {
                let same = |c: &Candidate| {
                    c.effect == scored.effect && c.place == place && c.shape == scored.shape
                };
                members.push(candidates.iter().position(same).unwrap_or_else(|| {
                    let (effect, shape) = (scored.effect, scored.shape.clone());
                    candidates.push(Candidate { effect, place, number: 0, shape });
                    candidates.len() - 1
                }));
            }
            laws.push(Law { scored, best, number, members });
        }
    }
    (candidates, laws)
}
