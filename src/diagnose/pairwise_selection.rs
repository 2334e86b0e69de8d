//! Pairwise selection: two effects at once, scored together before either is fitted.
//!
//! Where two effects are missing, each alone may explain little, and the best single effect may be neither of
//! them. The score test of both together, from one run with all candidates attached, finds them.

use crate::base::index::FastSet;

use super::candidate_fit::CandidateFits;
use super::formula_fit::has_formulas;
use super::hypothesis::Hypothesis;
use super::linearise::{Linearisation, Linearised};
use super::preliminary_fit::with_preliminary_fits;
use super::rank::{Candidate, Scored, batches};
use super::result::Diagnosis;
use super::revise::accept_first_better;
use super::search::Search;
use super::study::Study;

/// Adds two effects at once if one leaves something to explain.
pub fn pairwise_selection(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let ranking = diagnosis.rankings.first().cloned().unwrap_or_default();
    if !diagnosis.after.is_resolved(search.policy()) && search.may_continue() {
        pairwise_selection_from(search, diagnosis, &diagnosis.before.clone(), &ranking);
    }
}

/// The same from a hypothesis without effects. `ranking`: the scores of single effects there.
pub fn pairwise_selection_from(
    search: &Search<'_>,
    diagnosis: &mut Diagnosis,
    from: &Hypothesis,
    ranking: &[Scored],
) {
    let is_large = from.chi2_train() > search.policy().large_effect_above;
    let many = pairs(search, from, ranking, if is_large { MANY } else { 1 });
    let most = search.generosity() * search.policy().fitted_pairs;
    let best = diverse(&many, most, search.policy().pairs_per_member);
    let mut proposals = with_preliminary_fits(search, from, best, many.into_iter());
    proposals.truncate(most);
    let hypotheses = CandidateFits::new(search, from, &proposals, 0).run();
    if diagnosis.pairs.is_empty() {
        diagnosis.pairs = proposals;
    }
    accept_first_better(search, diagnosis, hypotheses);
}

/// An effect at a place with a shape, and the candidates that it consists of.
struct Member<'a> {
    scored: &'a Scored,
    /// The best shape of the same effect at the same place.
    best: &'a Scored,
    /// Position of the effect and place in the ranking.
    number: usize,
    candidates: Vec<usize>,
}

/// Two members and their joint score.
struct Pair {
    members: [usize; 2],
    amplitudes: Vec<f64>,
    bic_gain: f64,
}

/// The first pairs, of which so many share an effect at a place.
fn diverse(pairs: &[Vec<Scored>], most: usize, per_member: usize) -> Vec<Vec<Scored>> {
    let mut out: Vec<Vec<Scored>> = Vec::new();
    for pair in pairs {
        let has = |p: &&Vec<Scored>, s: &Scored| p.iter().any(|own| own.is_same(s));
        let is_used_up = |s: &Scored| out.iter().filter(|p| has(p, s)).count() >= per_member;
        if out.len() < most && !pair.iter().any(is_used_up) {
            out.push(pair.clone());
        }
    }
    out
}

/// Times as many pairs for preliminary fits as are fitted.
const MANY: usize = 4;

/// The most promising pairs of effects, best first, so many times as the policy wants fitted. `ranking`: the scores of single
/// effects.
pub fn pairs(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    ranking: &[Scored],
    times: usize,
) -> Vec<Vec<Scored>> {
    let (study, policy) = (search.study, search.policy());
    let (candidates, members) = members(study, ranking);
    search.note(&format!("scoring pairs of {} effects", members.len()));
    let linearisation = Linearisation::new(study, hypothesis, &candidates, policy.score_instants);
    let all: Vec<usize> = (0..candidates.len()).collect();
    let batches = batches(study, &candidates, &all);
    let together = linearisation.together(&batches, || !search.is_cancelled());
    let Some(linearised) = together else { return Vec::new() };
    let mut all = scored(search, hypothesis, &members, &linearised.projected());
    all.sort_by(|a, b| b.bic_gain.total_cmp(&a.bic_gain));
    let mut used = vec![0; ranking.len()];
    let mut known = FastSet::default();
    let (mut best, mut kept) = (Vec::new(), Vec::new());
    // An instrument beside any effect explains a little of what its form leaves: half of the pairs are without one.
    let mut with_instrument = 0;
    // A parameter that varies beside an effect follows a little of whatever that leaves as well.
    let mut with_variation = 0;
    for Pair { members: [i, j], amplitudes, bic_gain } in all {
        let (first, second) = (&members[i], &members[j]);
        let numbers = [first.number, second.number];
        let is_used_up = |n: &usize| used[*n] == times * policy.pairs_per_member;
        let most = times * search.generosity() * policy.fitted_pairs;
        let is_of_instrument =
            |m: &Member<'_>| study.is_of_instrument(m.scored.effect, &m.scored.place);
        let has_instrument = is_of_instrument(first) || is_of_instrument(second);
        let has_variation = first.varies(study) || second.varies(study);
        if best.len() == most
            || numbers.iter().any(is_used_up)
            || has_instrument && with_instrument == most / 2
            || has_variation && with_variation == most / 2
        {
            continue;
        }
        // Connectors of one potential are places that cannot be told apart.
        let is_repeated = kept.iter().any(|[i, j]: &[usize; 2]| {
            let same = |a: usize, b: &Member<'_>| {
                members[a].best.promises_as(b.best) && members[a].scored.shape == b.scored.shape
            };
            same(*i, first) && same(*j, second) || same(*i, second) && same(*j, first)
        });
        if !known.insert(numbers) || is_repeated {
            continue;
        }
        kept.push([i, j]);
        with_instrument += usize::from(has_instrument);
        with_variation += usize::from(has_variation);
        numbers.iter().for_each(|n| used[*n] += 1);
        let per_place = study.effects[first.scored.effect].amplitudes.len();
        let (of_first, of_second) = amplitudes.split_at(first.candidates.len() * per_place);
        let both = [first.proposal(bic_gain, of_first), second.proposal(bic_gain, of_second)];
        let share = 100.0 * bic_gain / hypothesis.train.total();
        let [a, b] = [0, 1].map(|k| study.label(both[k].effect, &both[k].place));
        search.note(&format!("  score {share:5.1} %  {a} and {b}"));
        best.push(both.into());
    }
    // Two named effects that leave nothing end the fits.
    let varies = |pair: &Vec<Scored>| pair.iter().any(|s| study.effects[s.effect].varies.is_some());
    best.sort_by_key(varies);
    best
}

impl Member<'_> {
    /// True for a parameter that varies.
    fn varies(&self, study: &Study) -> bool {
        study.effects[self.scored.effect].varies.is_some()
    }

    /// The member as part of a proposal, with the promise of the pair and its own amplitudes. Its other
    /// shapes are those that score best alone.
    fn proposal(&self, gain: f64, amplitudes: &[f64]) -> Scored {
        let others = match std::ptr::eq(self.scored, self.best) {
            true => self.best.others.clone(),
            false => vec![Scored { others: Vec::new(), ..self.best.clone() }],
        };
        Scored { gain, amplitudes: amplitudes.to_vec(), others, ..self.scored.clone() }
    }
}

/// All pairs whose score outweighs their amplitudes.
fn scored(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    members: &[Member<'_>],
    linearised: &Linearised,
) -> Vec<Pair> {
    let penalty = (hypothesis.train.count() as f64).ln();
    let mut pairs = Vec::new();
    for (j, second) in members.iter().enumerate() {
        for (i, first) in members[..j].iter().enumerate() {
            if first.number == second.number
                || first.candidates.iter().any(|c| second.candidates.contains(c))
                || first.varies(search.study) && second.varies(search.study)
            {
                continue;
            }
            let both = [first, second].map(|m| (m.scored.effect, m.candidates.as_slice()));
            if let Some(score) = linearised.score(search.study, &both) {
                let bic_gain = score.gain - penalty * score.amplitudes.len() as f64;
                if bic_gain > search.policy().evidence {
                    pairs.push(Pair { members: [i, j], amplitudes: score.amplitudes, bic_gain });
                }
            }
        }
    }
    pairs
}

/// The members of pairs, with all shapes, and the candidates that they consist of. Free curves are left out, and all but the
/// parameters that vary along the most promising straight lines: two of them describe anything.
fn members<'a>(study: &Study, ranking: &'a [Scored]) -> (Vec<Candidate>, Vec<Member<'a>>) {
    let mut candidates: Vec<Candidate> = Vec::new();
    let (mut members, mut variations) = (Vec::new(), 0);
    for (number, best) in ranking.iter().enumerate() {
        let effect = &study.effects[best.effect];
        // Nor does another law that the model offers have an amplitude.
        let is_left_out = study.is_curve(best.effect) || effect.choice.is_some();
        let varies = effect.varies.is_some();
        let is_full = variations == study.policy.pair_variations;
        if is_left_out || varies && (is_full || !has_formulas(study, best.effect)) {
            continue;
        }
        variations += usize::from(varies);
        for scored in std::iter::once(best).chain(&best.others) {
            let places = scored.place.members();
            // An effect that is built into a component exists once, with one shape.
            let clash = |c: &Candidate| {
                let here = c.effect == scored.effect && places.contains(&c.place);
                effect.built_in && here && c.shape != scored.shape
            };
            let is_full = candidates.len() >= study.policy.pair_candidates;
            if is_full || candidates.iter().any(clash) {
                continue;
            }
            let mut own = Vec::new();
            for place in places {
                let same = |c: &Candidate| {
                    c.effect == scored.effect && c.place == place && c.shape == scored.shape
                };
                own.push(candidates.iter().position(same).unwrap_or_else(|| {
                    let (effect, shape) = (scored.effect, scored.shape.clone());
                    candidates.push(Candidate { effect, place, number: 0, shape });
                    candidates.len() - 1
                }));
            }
            members.push(Member { scored, best, number, candidates: own });
        }
    }
    (candidates, members)
}
