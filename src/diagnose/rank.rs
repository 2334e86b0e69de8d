//! The score of every effect at every place with every shape, sorted by the information criterion.
//!
//! The derivatives come from runs of the model with many candidates attached at once, all at amplitude zero:
//! a candidate contributes one column of the score test, or several. Effects at several places together are
//! composed of the columns of the single places.

use crate::calibrate::data::Split;
use crate::calibrate::parallel;

use super::hypothesis::{ChosenEffect, Hypothesis};
use super::law_choice::scored_choices;
use super::linearise::{Linearisation, Linearised};
use super::place::Place;
use super::search::Search;
use super::shape_parameters::{ranges, shapes_at};
use super::study::Study;

/// An effect at a place with a shape, and its score.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Position in the catalogue.
    pub effect: usize,
    /// Its place.
    pub place: Place,
    /// Its shape parameters.
    pub shape: Vec<(String, f64)>,
    /// The amplitudes that the score promises.
    pub amplitudes: Vec<f64>,
    /// Decrease of the sum of squares that it promises.
    pub gain: f64,
    /// The same for the recordings that were never fitted, if it was computed.
    pub validation_gain: Option<f64>,
    /// The same with other shapes, best first.
    pub others: Vec<Scored>,
}

impl Scored {
    /// The effect at each of its places separately.
    pub fn members(&self) -> Vec<(usize, Place)> {
        self.place.members().into_iter().map(|place| (self.effect, place)).collect()
    }

    /// True if all of some effects are this one, at one of its places.
    pub fn has_all(&self, effects: &[ChosenEffect]) -> bool {
        let members = self.members();
        let is_member = |c: &ChosenEffect| {
            members.iter().any(|(effect, place)| *effect == c.effect && place.at == c.place.at)
        };
        effects.iter().all(is_member)
    }

    /// True for the same effect at the same place.
    pub fn is_same(&self, other: &Scored) -> bool {
        self.effect == other.effect && self.place == other.place
    }

    /// True for another place of the same effect where it cannot be told apart: in a chain without branches,
    /// or at a set of parameters of which one has no influence.
    pub fn promises_as(&self, other: &Scored) -> bool {
        const EQUAL: f64 = 1e-6;
        self.effect == other.effect && (self.gain - other.gain).abs() < EQUAL * self.gain.abs()
    }

    /// Decrease of the Bayesian information criterion: the gain less the penalty of the amplitudes.
    pub fn bic_gain(&self, hypothesis: &Hypothesis) -> f64 {
        self.gain - (hypothesis.train.count() as f64).ln() * self.amplitudes.len() as f64
    }
}

/// An effect at one place with a shape.
pub struct Candidate {
    /// Position in the catalogue.
    pub effect: usize,
    /// Its place.
    pub place: Place,
    /// Position among the shapes of the effect at this place.
    pub number: usize,
    /// Its shape parameters.
    pub shape: Vec<(String, f64)>,
}

/// Whether an effect, by its position in the catalogue, is to be scored at a place.
pub type Filter<'f> = dyn Fn(usize, &Place) -> bool + 'f;

/// A score test and the candidates that it consists of.
struct Trial {
    scored: Scored,
    candidates: Vec<usize>,
}

/// Every effect at every place with every shape, not yet scored.
pub fn unscored(study: &Study, hypothesis: &Hypothesis) -> Vec<Scored> {
    let (_, trials) = trials(study, hypothesis, false, &|_, _| true);
    trials.into_iter().map(|t| t.scored).collect()
}

/// Scores every effect at every place with every shape. One entry for each effect and place, with its best
/// shape.
///
/// Where the model without effects leaves nothing to explain, effects with states of their own are left out: their runs would
/// take most of the time, and what they describe is too small to be told from noise.
pub fn rank(search: &Search<'_>, hypothesis: &Hypothesis) -> Vec<Scored> {
    let is_done = hypothesis.effects.is_empty() && hypothesis.is_resolved(search.policy());
    let effects = &search.study.effects;
    rank_those(search, hypothesis, None, &|k, _| !is_done || !effects[k].has_states)
}

/// Scores laws and free curves, but no parameters that vary or have other values.
pub fn rank_laws(search: &Search<'_>, hypothesis: &Hypothesis) -> Vec<Scored> {
    let effects = &search.study.effects;
    let is_law = |k: usize| !effects[k].is_variation() && !effects[k].is_other_value();
    // What pulls the model to the recordings lacks nothing.
    let is_recorded = |name: &String| search.study.followers.iter().any(|f| f.input() == *name);
    let reads_recording =
        |p: &Place| p.at.iter().any(is_recorded) || p.binds.iter().any(|(_, v)| is_recorded(v));
    rank_those(search, hypothesis, None, &|k, place| is_law(k) && !reads_recording(place))
}

/// Scores effects in place of those of a hypothesis: if that leaves little, its trajectories are close to the
/// true ones, and so are the derivatives. `replaced` is the hypothesis without effects.
pub fn rank_instead(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    replaced: &Hypothesis,
    filter: &Filter<'_>,
) -> Vec<Scored> {
    rank_those(search, hypothesis, Some(replaced), filter)
}

/// Parameters and variables over which a free curve of the parameter is scored: those with the best straight lines.
const CURVED_VARIATIONS: usize = 8;

/// Parameters of which the laws are scored that follow a straight line: those with the best ones.
const FOLLOWING_PARAMETERS: usize = 2;

/// Places where a single parameter varies along a straight line, or a law of the first round, that promises something; the
/// best first. A parameter that varies otherwise has some slope as well.
fn sloped_places(search: &Search<'_>, scored: &[Scored]) -> Vec<Place> {
    let study = search.study;
    let varies = |s: &&Scored| study.effects[s.effect].varies.is_some() && s.gain > 0.0;
    let mut lines: Vec<&Scored> = scored.iter().filter(varies).collect();
    lines.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let single = &study.variations.parameters[..study.variations.single];
    let places = lines.into_iter().map(|s| s.place.clone());
    places.filter(|place| single.contains(&place.at)).collect()
}

/// All places where a single parameter may vary by some law.
fn varied_places(study: &Study, hypothesis: &Hypothesis) -> Vec<Place> {
    let single = &study.variations.parameters[..study.variations.single];
    let laws = study.effects.iter().filter(|e| e.is_variation());
    let all = laws.flat_map(|e| study.places(e, &hypothesis.plan));
    all.filter(|place| single.contains(&place.at)).collect()
}

fn rank_those(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    replaced: Option<&Hypothesis>,
    filter: &Filter<'_>,
) -> Vec<Scored> {
    let effects = &search.study.effects;
    let is_curve = |k: usize| effects[k].varies.is_some() && search.study.is_curve(k);
    let is_later = |k: usize| is_curve(k) || effects[k].follows_line;
    let mut best =
        scored(search, hypothesis, replaced, &|k, place| !is_later(k) && filter(k, place));
    let mut places = sloped_places(search, &best);
    let (mut most_curved, mut most_following) = (CURVED_VARIATIONS, FOLLOWING_PARAMETERS);
    if places.is_empty() && !search.policy().only.is_empty() {
        // Without straight lines, all places are looked at.
        places = varied_places(search.study, hypothesis);
        (most_curved, most_following) = (usize::MAX, usize::MAX);
    }
    let curved = &places[..places.len().min(most_curved)];
    let mut following: Vec<&Vec<String>> = Vec::new();
    for place in &places {
        if following.len() < most_following && !following.contains(&&place.at) {
            following.push(&place.at);
        }
    }
    // A condition keeps its value during a run, so that only a function of that value and of nothing else follows it.
    let has_shape = |k: usize| effects[k].amplitudes.len() > 1 || effects[k].depends_on_length();
    let conditions = &search.study.variations.conditions;
    let is_condition = |place: &Place| place.binds.iter().any(|(_, v)| conditions.contains(v));
    best.extend(scored(search, hypothesis, replaced, &|k, place| {
        let is_due = match is_curve(k) {
            true => curved.iter().any(|line| line.is_same_over(place)),
            false => {
                let is_admitted = !is_condition(place) || !has_shape(k);
                effects[k].follows_line && following.contains(&&place.at) && is_admitted
            }
        };
        is_due && filter(k, place)
    }));
    if replaced.is_none() {
        best.extend(scored_choices(search, hypothesis));
    }
    for scored in &mut best {
        scored.others.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    }
    best.sort_by(|a, b| b.bic_gain(hypothesis).total_cmp(&a.bic_gain(hypothesis)));
    measured_first(search.study, &mut best);
    best
}

/// Of a parameter that may as well vary with one variable as with another, such as a position and the volume that it
/// determines, puts the measured one first, and one of the same component before those of others.
fn measured_first(study: &Study, ranking: &mut [Scored]) {
    let closeness = |s: &Scored| {
        let component = s.place.at.first().and_then(|at| component_of(at));
        let all = |is: &dyn Fn(&String) -> bool| s.place.binds.iter().all(|(_, name)| is(name));
        let is_own = component.is_some() && all(&|name| component_of(name) == component);
        (all(&|name| study.is_measured(name)), is_own)
    };
    for k in 1..ranking.len() {
        let mut j = k;
        while j > 0
            && study.effects[ranking[j].effect].has_free_inputs()
            && ranking[j].place.at == ranking[j - 1].place.at
            && ranking[j].promises_as(&ranking[j - 1])
            && closeness(&ranking[j]) > closeness(&ranking[j - 1])
        {
            ranking.swap(j, j - 1);
            j -= 1;
        }
    }
}

/// The component that a variable, or the rate of one, belongs to.
fn component_of(name: &str) -> Option<&str> {
    let own = name.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')')).unwrap_or(name);
    own.rsplit_once('.').map(|(component, _)| component)
}

/// Scores those that `filter` admits, in no order.
fn scored(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    replaced: Option<&Hypothesis>,
    filter: &Filter<'_>,
) -> Vec<Scored> {
    let (study, policy) = (search.study, search.policy());
    let (candidates, mut trials) = trials(study, hypothesis, replaced.is_some(), filter);
    let all: Vec<usize> = (0..candidates.len()).collect();
    let instants: usize = study.data.of(Split::Train).map(|r| r.time.len()).sum();
    let with =
        |instants| Linearisation::new(study, hypothesis, &candidates, instants).instead(replaced);
    let few = policy.preselection_instants;
    if instants > 2 * few && all.len() > 2 * policy.preselected {
        score_some(search, with(few), (&candidates, &all), &mut trials);
        let selected = preselected(search, hypothesis, &trials);
        let again = with(policy.score_instants);
        score_some(search, again, (&candidates, &selected), &mut trials);
    } else {
        let all_at_once = with(policy.score_instants).validated();
        score_some(search, all_at_once, (&candidates, &all), &mut trials);
    }
    let mut best: Vec<Scored> = Vec::new();
    // Effects that promise nothing alone are kept: they may do so beside another.
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
    best
}

/// The candidates of the best trials.
fn preselected(search: &Search<'_>, hypothesis: &Hypothesis, trials: &[Trial]) -> Vec<usize> {
    let mut order: Vec<&Trial> = trials.iter().filter(|t| t.scored.gain > 0.0).collect();
    let gain = |t: &Trial| t.scored.bic_gain(hypothesis);
    order.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    let mut selected = Vec::new();
    for trial in order {
        if selected.len() >= search.policy().preselected {
            break;
        }
        for candidate in &trial.candidates {
            if !selected.contains(candidate) {
                selected.push(*candidate);
            }
        }
    }
    selected.sort_unstable();
    selected
}

/// Scores the trials that consist of the selected candidates, batch by batch, several batches at once: the models of the
/// batches are compiled besides, and recordings are too few to occupy all cores.
fn score_some(
    search: &Search<'_>,
    linearisation: Linearisation<'_>,
    (candidates, selected): (&[Candidate], &[usize]),
    trials: &mut [Trial],
) {
    let batches = batches(search.study, candidates, selected);
    let (some, runs) = (selected.len(), batches.len());
    search.note(&format!("scoring {some} candidates in {runs} runs"));
    let cores = parallel::cores();
    let linearisation = linearisation.on_threads(cores.div_ceil(runs.max(1)));
    let of_batch = |k: usize| linearised(&linearisation, &batches[k]);
    let all = parallel::map_while(cores, runs, || !search.is_cancelled(), of_batch);
    for linearised in all.iter().flatten().flatten() {
        score_trials(search, &linearisation, linearised, trials);
    }
}

/// The normal equations with the candidates of a batch. If these cannot be simulated together, each half has its own, so
/// that one candidate does not prevent the others.
fn linearised(linearisation: &Linearisation<'_>, batch: &[usize]) -> Vec<Linearised> {
    if let Some(linearised) = linearisation.with(batch) {
        return vec![linearised];
    }
    match batch.len() {
        0 | 1 => Vec::new(),
        count => {
            let (left, right) = batch.split_at(count / 2);
            [left, right].into_iter().flat_map(|half| linearised(linearisation, half)).collect()
        }
    }
}

/// Scores the trials of which normal equations have all candidates.
fn score_trials(
    search: &Search<'_>,
    linearisation: &Linearisation<'_>,
    linearised: &Linearised,
    trials: &mut [Trial],
) {
    for Trial { scored, candidates } in trials {
        if let Some(score) = linearised.score(search.study, &[(scored.effect, candidates)]) {
            scored.gain = score.gain.min(linearisation.max_gain());
            scored.validation_gain = linearised.validation_gain(&score);
            scored.amplitudes = score.amplitudes;
        }
    }
}

/// The trials of a score test and their candidates.
fn trials(
    study: &Study,
    hypothesis: &Hypothesis,
    instead: bool,
    filter: &Filter<'_>,
) -> (Vec<Candidate>, Vec<Trial>) {
    let mut all: Vec<(usize, Place)> = Vec::new();
    for (k, effect) in study.effects.iter().enumerate() {
        if effect.choice.is_some() || effect.formula.is_some() || effect.finer_than.is_some() {
            continue;
        }
        for place in study.places(effect, &hypothesis.plan) {
            let taken = |at: &String| {
                let is_here = |c: &ChosenEffect| {
                    c.place.at.first() == Some(at)
                        && (effect.adds.is_none() || c.place.binds == place.binds)
                };
                let is_same = |c: &ChosenEffect| {
                    c.effect == k || study.effects[c.effect].finer_than == Some(k)
                };
                hypothesis.effects.iter().any(|c| is_same(c) && is_here(c))
            };
            let known = match effect.built_in {
                true => place.at.iter().any(taken),
                false => !instead && place.at.iter().all(taken),
            };
            if !known && filter(k, &place) {
                all.push((k, place));
            }
        }
    }
    let ranges = ranges(study, hypothesis, &all);
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut trials: Vec<Trial> = Vec::new();
    for (effect, place) in &all {
        let shapes = shapes_at(study, &ranges, *effect, place).unwrap_or_default();
        for (number, shape) in shapes.into_iter().enumerate() {
            let mut own = Vec::new();
            for place in place.members() {
                let same =
                    |c: &Candidate| c.effect == *effect && c.shape == shape && c.place == place;
                own.push(candidates.iter().position(same).unwrap_or_else(|| {
                    let (effect, shape) = (*effect, shape.clone());
                    candidates.push(Candidate { effect, place, number, shape });
                    candidates.len() - 1
                }));
            }
            let (effect, place) = (*effect, place.clone());
            let count = own.len() * study.effects[effect].amplitudes.len();
            let (amplitudes, others) = (vec![0.0; count], Vec::new());
            let (gain, validation_gain) = (0.0, None);
            let scored = Scored { effect, place, shape, amplitudes, gain, validation_gain, others };
            trials.push(Trial { scored, candidates: own });
        }
    }
    (candidates, trials)
}

/// Splits candidates into batches that run together: those of one effect and shape always do, and two shapes
/// of an effect that is built into a component never do.
pub fn batches(study: &Study, candidates: &[Candidate], selected: &[usize]) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    for i in selected.iter().copied() {
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
        let alone = study.effects[effect].built_in;
        let fits = |b: &&mut Vec<usize>| {
            let clash = alone && b.iter().any(|i| candidates[*i].effect == effect);
            b.len() + block.len() <= study.batch() && !clash
        };
        match batches.iter_mut().find(fits) {
            Some(batch) => batch.extend(block),
            None => batches.push(block),
        }
    }
    batches
}
