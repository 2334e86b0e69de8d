//! Every effect at every place with every shape, in the order of what it could explain.
//!
//! The derivatives come from runs of the model with many candidates attached at once, all at amplitude
//! zero: a candidate is a column of the score test, or several. Effects at several places together are
//! made of the columns of the single places.

use std::cell::OnceCell;

use crate::base::diag::Problems;
use crate::base::index::FastSet;
use crate::calibrate::data::Split;
use crate::calibrate::problem::Problem;
use crate::calibrate::statistics::at_bound;
use crate::numeric::least_squares::NormalEquations;

use super::case::{Case, compile};
use super::effect::Effect;
use super::level::{Level, amplitude, attached};
use super::place::{Place, places};
use super::score::{Score, score};
use super::shape::{ranges, ranges_of, shapes};
use super::text::Attached;

/// An effect at a place with a shape, as the score test sees it.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Position in the catalogue.
    pub effect: usize,
    /// Where.
    pub place: Place,
    /// Its shape.
    pub shape: Vec<(String, f64)>,
    /// The amplitudes that the score promises.
    pub amplitudes: Vec<f64>,
    /// Decrease of the sum of squares that it promises.
    pub gain: f64,
    /// The same with other shapes, best first.
    pub others: Vec<Scored>,
}

impl Scored {
    /// The effect with each of its places by itself.
    pub fn members(&self) -> Vec<(usize, Place)> {
        self.place.members().into_iter().map(|place| (self.effect, place)).collect()
    }

    /// The decrease less the price of the amplitudes.
    pub fn worth(&self, level: &Level) -> f64 {
        self.gain - (level.train.count() as f64).ln() * self.amplitudes.len() as f64
    }
}

/// Candidates in one model of a score test.
const BATCH: usize = 48;

/// Instants of recordings that a score test is made with.
pub const ENOUGH: usize = 10_000;
/// Instants that suffice to tell what is worth that test.
const FEW: usize = 3_000;
/// Candidates that it is made with.
const AGAIN: usize = 64;

/// An effect at one place with a shape.
pub struct Candidate {
    /// Position in the catalogue.
    pub effect: usize,
    /// Where.
    pub place: Place,
    /// Position among the shapes of the effect at this place.
    pub number: usize,
    /// The shape.
    pub shape: Vec<(String, f64)>,
}

/// Whether an effect at a place is to be scored.
pub type Wanted<'w> = dyn Fn(&Effect, &Place) -> bool + 'w;

/// What is scored, and the candidates it is made of.
struct Trial {
    scored: Scored,
    members: Vec<usize>,
}

/// Every effect at every place with every shape, not yet scored.
pub fn unscored(case: &Case<'_>, level: &Level) -> Vec<Scored> {
    let (_, trials) = trials(case, level, false, &|_, _| true);
    trials.into_iter().map(|t| t.scored).collect()
}

/// Scores every effect at every place with every shape; the best shape stands for the others.
pub fn rank(case: &Case<'_>, level: &Level) -> Vec<Scored> {
    rank_those(case, level, None, &|_, _| true)
}

/// Scores those effects that `wanted` takes in place of what a level has: where that leaves little, the
/// trajectories are nearly the true ones, and so are the derivatives. `before` is the model without it.
pub fn rank_instead(
    case: &Case<'_>,
    level: &Level,
    before: &Level,
    wanted: &Wanted<'_>,
) -> Vec<Scored> {
    rank_those(case, level, Some(before), wanted)
}

fn rank_those(
    case: &Case<'_>,
    level: &Level,
    before: Option<&Level>,
    wanted: &Wanted<'_>,
) -> Vec<Scored> {
    let (candidates, mut trials) = trials(case, level, before.is_some(), wanted);
    let all: Vec<usize> = (0..candidates.len()).collect();
    let instants: usize = case.data.of(Split::Train).map(|r| r.time.len()).sum();
    let scoring = |enough| {
        let scoring = Scoring::new(case, level, &candidates, enough);
        Scoring { before, ..scoring }
    };
    if instants > 2 * FEW && all.len() > 2 * AGAIN {
        score_some(&scoring(FEW), &all, &mut trials);
        let again = foremost(level, &trials);
        score_some(&scoring(ENOUGH), &again, &mut trials);
    } else {
        score_some(&scoring(ENOUGH), &all, &mut trials);
    }
    let mut best: Vec<Scored> = Vec::new();
    // What promises nothing by itself may do so beside another.
    for Trial { mut scored, .. } in trials {
        let same = |s: &&mut Scored| s.effect == scored.effect && s.place == scored.place;
        let Some(known) = best.iter_mut().find(same) else {
            best.push(scored);
            continue;
        };
        if known.gain < scored.gain {
            scored.others = std::mem::take(&mut known.others);
            std::mem::swap(known, &mut scored);
        }
        known.others.push(scored);
    }
    for scored in &mut best {
        scored.others.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    }
    best.sort_by(|a, b| b.worth(level).total_cmp(&a.worth(level)));
    best
}

/// About [`AGAIN`] candidates, those that the best trials are made of.
fn foremost(level: &Level, trials: &[Trial]) -> Vec<usize> {
    let mut order: Vec<&Trial> = trials.iter().filter(|t| t.scored.gain > 0.0).collect();
    order.sort_by(|a, b| b.scored.worth(level).total_cmp(&a.scored.worth(level)));
    let mut chosen = Vec::new();
    for trial in order {
        if chosen.len() >= AGAIN {
            break;
        }
        for member in &trial.members {
            if !chosen.contains(member) {
                chosen.push(*member);
            }
        }
    }
    chosen.sort_unstable();
    chosen
}

/// Scores the trials that are made of `chosen` candidates.
fn score_some(scoring: &Scoring<'_>, chosen: &[usize], trials: &mut [Trial]) {
    let batches = batches(scoring.case, scoring.candidates, chosen);
    let (some, runs) = (chosen.len(), batches.len());
    (scoring.case.say)(&format!("scoring {some} candidates in {runs} runs"));
    batches.iter().for_each(|batch| scoring.score(batch, trials));
}

/// What is scored, and the candidates that this takes.
fn trials(
    case: &Case<'_>,
    level: &Level,
    instead: bool,
    wanted: &Wanted<'_>,
) -> (Vec<Candidate>, Vec<Trial>) {
    let names: FastSet<&str> = case.variables.iter().map(String::as_str).collect();
    let mut all: Vec<(usize, Place)> = Vec::new();
    for (k, effect) in case.effects.iter().enumerate() {
        for place in places(effect, case.inventory, &names, &level.plan) {
            let taken = |at: &String| {
                level.chosen.iter().any(|c| c.effect == k && c.place.at.first() == Some(at))
            };
            let known = match effect.built_in {
                true => place.at.iter().any(taken),
                false => !instead && place.at.iter().all(taken),
            };
            if !known && wanted(effect, &place) {
                all.push((k, place));
            }
        }
    }
    let ranges = ranges(case, level, &all);
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut trials: Vec<Trial> = Vec::new();
    for (effect, place) in &all {
        let range = |variable: &str| ranges_of(&ranges, *effect, place, variable);
        for (number, shape) in shapes(&case.effects[*effect], range).into_iter().enumerate() {
            let mut members = Vec::new();
            for place in place.members() {
                let same =
                    |c: &Candidate| c.effect == *effect && c.shape == shape && c.place == place;
                members.push(candidates.iter().position(same).unwrap_or_else(|| {
                    let (effect, shape) = (*effect, shape.clone());
                    candidates.push(Candidate { effect, place, number, shape });
                    candidates.len() - 1
                }));
            }
            let (effect, place) = (*effect, place.clone());
            let count = members.len() * case.effects[effect].amplitudes.len();
            let (amplitudes, others) = (vec![0.0; count], Vec::new());
            let scored = Scored { effect, place, shape, amplitudes, gain: 0.0, others };
            trials.push(Trial { scored, members });
        }
    }
    (candidates, trials)
}

/// Which candidates run together: those of one effect and shape always, and never two shapes of what is
/// built into one component.
fn batches(case: &Case<'_>, candidates: &[Candidate], chosen: &[usize]) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    for i in chosen.iter().copied() {
        let c = &candidates[i];
        let same = |b: &&mut Vec<usize>| {
            let first = &candidates[b[0]];
            first.effect == c.effect && first.number == c.number
        };
        match blocks.iter_mut().find(same) {
            Some(block) => block.push(i),
            None => blocks.push(vec![i]),
        }
    }
    let mut batches: Vec<Vec<usize>> = Vec::new();
    for block in blocks {
        let effect = candidates[block[0]].effect;
        let alone = case.effects[effect].built_in;
        let fits = |b: &&mut Vec<usize>| {
            let clash = alone && b.iter().any(|i| candidates[*i].effect == effect);
            b.len() + block.len() <= BATCH && !clash
        };
        match batches.iter_mut().find(fits) {
            Some(batch) => batch.extend(block),
            None => batches.push(block),
        }
    }
    batches
}

/// What the scores of one level are computed from.
pub struct Scoring<'a> {
    /// What all levels share.
    case: &'a Case<'a>,
    level: &'a Level,
    /// What may be attached to it.
    candidates: &'a [Candidate],
    /// Instants of recordings.
    enough: usize,
    /// The model without what the level has, if the candidates are to come in its place.
    before: Option<&'a Level>,
    /// The normal equations of the level alone, of all recordings.
    whole: OnceCell<Option<NormalEquations>>,
}

/// The normal equations of a level with candidates at amplitude zero.
pub struct Linearised {
    normal: NormalEquations,
    /// Parameters of the level: they come first.
    free: usize,
    /// Position of the first amplitude of each candidate.
    first: Vec<Option<usize>>,
    /// Share of the sum of squares that they are made of.
    share: f64,
}

impl Linearised {
    /// The score of effects that are made of candidates, all at once.
    pub fn score(&self, case: &Case<'_>, all: &[(usize, &[usize])]) -> Option<Score> {
        let (mut group, mut positive) = (Vec::new(), Vec::new());
        for (effect, members) in all {
            let amplitudes = &case.effects[*effect].amplitudes;
            for member in *members {
                let start = self.first[*member]?;
                group.extend(start..start + amplitudes.len());
                positive.extend(amplitudes.iter().map(|a| a.positive));
            }
        }
        let mut found = score(&self.normal, self.free, &group, &positive)?;
        // Of what is left out the same part is taken to be explained.
        if self.share.is_normal() {
            found.gain /= self.share;
        }
        Some(found)
    }
}

impl<'a> Scoring<'a> {
    /// What may be attached to a level, scored with about `enough` instants of recordings.
    pub fn new(
        case: &'a Case<'a>,
        level: &'a Level,
        candidates: &'a [Candidate],
        enough: usize,
    ) -> Scoring<'a> {
        Scoring { case, level, candidates, enough, before: None, whole: OnceCell::new() }
    }

    /// Scores the trials that are made of candidates of this batch alone.
    fn score(&self, batch: &[usize], trials: &mut [Trial]) {
        let Some(linearised) = self.linearised(batch) else {
            // One that can not be run must not keep the others from it.
            let half = batch.len() / 2;
            if half > 0 {
                let (left, right) = batch.split_at(half);
                self.score(left, trials);
                self.score(right, trials);
            }
            return;
        };
        for Trial { scored, members } in trials {
            if let Some(found) = linearised.score(self.case, &[(scored.effect, members)]) {
                // More than everything can not be explained: beyond its range the line does not hold.
                let most = self.before.map_or(self.level.train.total(), |_| f64::INFINITY);
                scored.gain = found.gain.min(most);
                scored.amplitudes = found.amplitudes;
            }
        }
    }

    /// The normal equations with all candidates of a batch; `None` if they can not be run together.
    pub fn linearised(&self, batch: &[usize]) -> Option<Linearised> {
        let Scoring { case, level, candidates, enough, before, .. } = *self;
        let mut all = attached(case, &level.chosen);
        let mut plan = level.plan.clone();
        let free = plan.free.len();
        let mut first = vec![None; candidates.len()];
        for i in batch {
            let Candidate { effect, place, shape, .. } = &candidates[*i];
            let effect = &case.effects[*effect];
            let name = if effect.built_in { place.at[0].clone() } else { format!("trial_{i}") };
            first[*i] = Some(plan.free.len());
            for a in &effect.amplitudes {
                plan.free.push(amplitude(&format!("{name}.{}", a.name), 0.0, None, place, &name));
            }
            all.push(Attached { effect, place, name, values: shape.clone() });
        }
        let (session, program) = compile(case, &plan, &all, &[]).ok()?;
        let mut problems = Problems::new();
        let problem = Problem::new(&program, &session.sources, &plan, case.data, &mut problems);
        let mut problem = problem?;
        problem.left_out = surplus(&problem, before.unwrap_or(level), enough);
        let mut normal = problem.normal(&problem.start()).ok()?;
        if !problem.left_out.is_empty() {
            // Few recordings must not have the parameters for themselves: the others hold them too.
            hold(&mut normal, self.whole.get_or_init(|| alone(case, level)).as_ref()?);
        }
        let share = match before {
            None => normal.cost / level.train.total(),
            Some(before) => {
                let of = |(k, s): (usize, &Vec<f64>)| match problem.left_out.contains(&k) {
                    true => 0.0,
                    false => s.iter().sum(),
                };
                before.train.squares.iter().enumerate().map(of).sum::<f64>() / before.train.total()
            }
        };
        if before.is_some() {
            take_off(&mut normal, &removed(case, level, &problem));
        }
        // What is pushed against its bound absorbs nothing.
        let x = problem.start();
        let at_bound = at_bound(&normal, &problem.parameters[..free], &x[..free]);
        (0..free).filter(|k| at_bound[*k]).for_each(|k| hold_still(&mut normal, k));
        Some(Linearised { normal, free, first, share })
    }
}

/// The columns of what a level has, and how far each is from where it does nothing.
fn removed(case: &Case<'_>, level: &Level, problem: &Problem<'_>) -> Vec<(usize, f64)> {
    let mut columns = Vec::new();
    for (k, p) in problem.parameters.iter().enumerate().take(level.plan.free.len()) {
        let targets = &level.plan.free[k].targets;
        for c in &level.chosen {
            let own = |name: &str| targets.iter().any(|t| *t == format!("{}.{name}", c.name));
            let amplitudes = &case.effects[c.effect].amplitudes;
            if amplitudes.iter().any(|a| own(&a.name)) {
                columns.push((k, p.start / p.scale.slope(p.start)));
            } else if c.fitted.iter().any(|name| own(name)) {
                columns.push((k, 0.0));
            } else {
                continue;
            }
            break;
        }
    }
    columns
}

/// The normal equations of the residuals without what these columns contribute, and without the columns.
fn take_off(normal: &mut NormalEquations, columns: &[(usize, f64)]) {
    let n = normal.n;
    for (c, amount) in columns {
        let own = normal.gram[c + n * c];
        normal.cost += amount * (amount * own - 2.0 * normal.gradient[*c]);
        for i in 0..n {
            normal.gradient[i] -= amount * normal.gram[i + n * c];
        }
    }
    columns.iter().for_each(|(c, _)| hold_still(normal, *c));
}

/// The normal equations without a column.
fn hold_still(normal: &mut NormalEquations, column: usize) {
    let n = normal.n;
    for i in 0..n {
        normal.gram[i + n * column] = 0.0;
        normal.gram[column + n * i] = 0.0;
    }
    normal.gradient[column] = 0.0;
}

/// Recordings that a score test goes without, to have about `enough` instants: those that fit best, as they
/// have least to tell.
fn surplus(problem: &Problem<'_>, level: &Level, enough: usize) -> Vec<usize> {
    let mut left_out = problem.surplus(enough);
    let each: Vec<f64> = level.train.squares.iter().map(|s| s.iter().sum()).collect();
    if each.len() == problem.recordings(Split::Train).len() {
        let mut order: Vec<usize> = (0..each.len()).collect();
        order.sort_by(|a, b| each[*a].total_cmp(&each[*b]));
        order.truncate(left_out.len());
        left_out = order;
    }
    left_out
}

/// The normal equations of a level as it is.
fn alone(case: &Case<'_>, level: &Level) -> Option<NormalEquations> {
    let all = attached(case, &level.chosen);
    let (session, program) = compile(case, &level.plan, &all, &[]).ok()?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &level.plan, case.data, &mut problems)?;
    problem.normal(&problem.start()).ok()
}

/// What concerns the parameters of a level alone is that of all recordings.
fn hold(normal: &mut NormalEquations, whole: &NormalEquations) {
    for j in 0..whole.n {
        for i in 0..whole.n {
            normal.gram[i + normal.n * j] = whole.gram[i + whole.n * j];
        }
        normal.gradient[j] = whole.gradient[j];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y = 2 + 3 t + 0.5 t^2` fitted in full: without the slope, a direction like it explains what that did.
    #[test]
    fn what_is_taken_off_is_there_to_be_explained() {
        let mut normal = NormalEquations::new(4);
        let mut whole = 0.0;
        for i in 0..11 {
            let t = 0.1 * f64::from(i);
            normal.add(0.0, &[1.0, t, t * t, 2.0 * t]);
            whole += (3.0 * t).powi(2);
        }
        take_off(&mut normal, &[(1, 3.0)]);
        assert!((normal.cost - whole).abs() < 1e-9);
        let same = score(&normal, 3, &[3], &[false]).unwrap();
        assert!((same.amplitudes[0] - 1.5).abs() < 1e-6);
        assert_eq!(score(&normal, 3, &[1], &[false]), None);
    }
}
