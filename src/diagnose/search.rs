//! The search for missing effects: calibrate, score every effect at every place, fit the most promising,
//! keep those that the data support.
//!
//! Stepwise model selection by the Bayesian information criterion ([`super::forward_selection`],
//! [`super::backward_elimination`], [`super::pairwise_selection`]), followed by a revision of the result
//! ([`super::revise`]).

use std::cell::{Cell, RefCell};

use crate::base::index::FastMap;
use crate::calibrate::data::Split;
use crate::calibrate::fit::{self, quick_fit};
use crate::calibrate::observer::{Event, Observer};

use super::alternatives::compare_alternatives;
use super::backward_elimination::{eliminated, without_inert};
use super::effective_evidence::{eliminate_unsupported, supports_first};
use super::formula_fit::replace_curves;
use super::forward_selection::forward_selection;
use super::hypothesis::{Hypothesis, groups, plan_without_effects};
use super::law_refinement::refine_law;
use super::merge::{merge_laws_of_one_parameter, merge_variations, widen_variation};
use super::noise::noise;
use super::pairwise_selection::pairwise_selection;
use super::place::Place;
use super::policy::SearchPolicy;
use super::rank::Scored;
use super::result::{Diagnosis, Verdict};
use super::revise::{revise, select_again, simplify, swap_effects};
use super::rival_curves::{compare_curves, compare_curves_early};
use super::sibling_laws::compare_siblings;
use super::study::{DiagnosisError, Study};

/// A search: its study, its observer and the steps that it has spent.
pub struct Search<'a> {
    /// The study.
    pub study: &'a Study,
    observer: &'a dyn Observer,
    /// Steps of all fits so far.
    steps: Cell<u64>,
    /// The sets of effects that were fitted, and how often.
    fitted: RefCell<FastMap<Vec<EffectAt>, usize>>,
}

/// An effect by its position in the catalogue, where it is, and the variables that it depends on.
type EffectAt = (usize, Vec<String>, Vec<(String, String)>);

impl<'a> Search<'a> {
    /// A search that has not begun.
    pub fn new(study: &'a Study, observer: &'a dyn Observer) -> Search<'a> {
        Search { study, observer, steps: Cell::new(0), fitted: RefCell::default() }
    }

    /// A search in another form of the study, with the same observer.
    pub fn in_form(&self, study: &'a Study) -> Search<'a> {
        Search::new(study, self.observer)
    }

    /// The policy of the study.
    pub fn policy(&self) -> &'a SearchPolicy {
        &self.study.policy
    }

    /// How many times as many proposals are fitted where the recordings are short, so that a fit costs little.
    pub fn generosity(&self) -> usize {
        let instants: usize = self.study.data.of(Split::Train).map(|r| r.time.len()).sum();
        match instants <= self.policy().preselection_instants {
            true => self.policy().proposals_if_short,
            false => 1,
        }
    }

    /// Counts a step of a fit; false ends the fit.
    pub fn on_step(&self) -> bool {
        self.steps.set(self.steps.get() + 1);
        !self.observer.is_cancelled()
    }

    /// Whether the search is to end at once.
    pub fn is_cancelled(&self) -> bool {
        self.observer.is_cancelled()
    }

    /// Whether another fit may begin.
    pub fn may_continue(&self) -> bool {
        let most = self.policy().max_steps * (self.generosity() as u64).pow(2);
        !self.observer.is_cancelled() && self.steps.get() < most
    }

    /// Whether another fit of a hypothesis with a proposal may tell something new; counts it.
    pub fn is_new(&self, from: &Hypothesis, proposal: &[Scored]) -> bool {
        let known = from.effects.iter().map(|c| (c.effect, &c.place));
        let members: Vec<(usize, Place)> = proposal.iter().flat_map(Scored::members).collect();
        let all = known.chain(members.iter().map(|(effect, place)| (*effect, place)));
        let mut key: Vec<EffectAt> =
            all.map(|(effect, p)| (effect, p.at.clone(), p.binds.clone())).collect();
        key.sort();
        let mut fitted = self.fitted.borrow_mut();
        let count = fitted.entry(key).or_default();
        *count += 1;
        *count <= self.policy().fits_of_the_same
    }

    /// True if a hypothesis leaves so little of what another leaves to explain that little can be better.
    pub fn leads(&self, from: &Hypothesis, hypothesis: &Hypothesis) -> bool {
        let policy = self.policy();
        let excess = from.chi2_train() - 1.0;
        let left = policy.leading_excess + (1.0 - policy.leading_share) * excess;
        hypothesis.chi2_train() - 1.0 < left.min(excess)
    }

    /// True if a hypothesis leaves so little that it is no local minimum, but may lack something small.
    pub fn is_nearly_resolved(&self, hypothesis: &Hypothesis) -> bool {
        let most = 1.0 + self.policy().leading_excess;
        hypothesis.chi2_train() < most && hypothesis.chi2_validation() < most
    }

    /// True if one effect explains so much that pairs of others are not closer at hand, and leaves little.
    fn dominates(&self, diagnosis: &Diagnosis) -> bool {
        let (before, after) = (&diagnosis.before, &diagnosis.after);
        let policy = self.policy();
        let leaves = |of: fn(&Hypothesis) -> f64, share: f64| {
            let most = (1.0 - share) * (of(before) - 1.0);
            of(after) < policy.many_effects_above && of(after) - 1.0 < most
        };
        // Where the fitted recordings leave nothing, no pair explains more of them.
        let unseen = match after.explains_training(policy) {
            true => policy.explained_share,
            false => policy.dominant_share,
        };
        groups(&after.effects).count() == 1
            && leaves(Hypothesis::chi2_train, policy.dominant_share)
            && leaves(Hypothesis::chi2_validation, unseen)
    }

    /// False for a further effect that only corrects the form of one which explains nearly everything, and for a first one that
    /// follows coloured noise.
    pub fn is_needed(&self, diagnosis: &Diagnosis, extended: &Hypothesis) -> bool {
        let after = &diagnosis.after;
        let number = diagnosis.rankings.last().map_or(0, Vec::len);
        let is_faint = after.effects.is_empty() && after.chi2_train() < self.policy().faint_below;
        if is_faint && !supports_first(self.study, after, extended, number) {
            return false;
        }
        let is_further = groups(&extended.effects).count() > groups(&after.effects).count();
        if after.effects.is_empty() || !is_further || !self.leads(&diagnosis.before, after) {
            return true;
        }
        // Where even pairs leave much, no form of the first law explains it.
        let policy = self.policy();
        let are_many = groups(&after.effects).count() >= policy.usual_effects;
        if are_many && after.chi2_train() > policy.explained_limit {
            return true;
        }
        let left = (1.0 - self.policy().second_share) * (after.chi2_train() - 1.0);
        let limit = self.policy().train_limit(after.train.count());
        extended.chi2_train() < limit.max(1.0 + left)
    }

    /// Tells the observer the best result so far.
    pub fn announce(&self, diagnosis: &Diagnosis) {
        self.observer.event(&Event::Best(&diagnosis.evidence(self.study)));
    }

    /// Writes a line to the log.
    pub fn note(&self, text: &str) {
        self.observer.event(&Event::Note(text));
    }
}

/// Searches for the effects that a model lacks. If the noise of some signals is to be corrected first, the result
/// holds that noise, and no more than what was found until it showed.
pub fn diagnose(study: &Study, observer: &dyn Observer) -> Result<Diagnosis, DiagnosisError> {
    let search = &Search::new(study, observer);
    let fit_policy = &search.policy().fit;
    let before = Hypothesis::fitted(study, Vec::new(), study.plan.clone(), &mut |p| {
        quick_fit(p, fit_policy, &mut |_, _| search.on_step())
    })?;
    let noise = noise(study, &before);
    let is_correctable = study.corrections.is_empty();
    if noise.is_all() || (is_correctable && noise.corrections(search.policy()).is_some()) {
        search.note("signals are white");
        return Ok(Diagnosis { noise, ..Diagnosis::new(before) });
    }
    study.plan.cancellation.arm();
    let diagnosis = search_from(search, before);
    study.plan.cancellation.disarm();
    Ok(diagnosis)
}

/// Searches from a calibration, and from another one if that explains nothing.
fn search_from(search: &Search<'_>, before: Hypothesis) -> Diagnosis {
    let (study, fit_policy) = (search.study, &search.policy().fit);
    let mut diagnosis = diagnose_from(search, before);
    if diagnosis.noise.is_all() {
        return diagnosis;
    }
    if !diagnosis.after.explains_training(search.policy()) && search.may_continue() {
        // If no effect explains the data, the calibration may be in a local minimum.
        let thorough = Hypothesis::fitted(study, Vec::new(), study.plan.clone(), &mut |p| {
            fit::fit(p, fit_policy, &mut |_, _| search.on_step())
        });
        let limit = search.policy().escaped_share * diagnosis.before.train.total();
        if let Some(escaped) = thorough.ok().filter(|t| t.train.total() < limit) {
            let again = diagnose_from(search, escaped);
            if again.after.chi2_validation() < diagnosis.after.chi2_validation() {
                diagnosis = again;
            }
        }
    }
    search.note(&format!("{} steps in all", search.steps.get()));
    diagnosis
}

/// Searches for missing effects, given the calibration without any.
fn diagnose_from(search: &Search<'_>, before: Hypothesis) -> Diagnosis {
    search.note(&format!("calibrated: reduced chi-square {:.4}", before.chi2_train()));
    search.note(&format!("  by recording {:.1?}", before.train.by_recording()));
    let mut diagnosis = Diagnosis::new(before);
    search.announce(&diagnosis);
    let (usual, max) = (search.policy().usual_effects, search.policy().max_effects);
    forward_selection(search, &mut diagnosis, 0..1);
    if has_other_noise(search, &mut diagnosis) {
        return diagnosis;
    }
    widen_variation(search, &mut diagnosis);
    refine_law(search, &mut diagnosis);
    compare_curves_early(search, &mut diagnosis);
    let second = add_second(search, &mut diagnosis);
    let is_one = |diagnosis: &Diagnosis| groups(&diagnosis.after.effects).count() == 1;
    if is_one(&diagnosis) {
        select_again(search, &mut diagnosis);
    }
    // Beside an effect that explains nearly everything, a second one is closer at hand than a pair without it.
    let leads = search.leads(&diagnosis.before, &diagnosis.after);
    if leads {
        if is_one(&diagnosis) {
            forward_selection(search, &mut diagnosis, 1..usual);
        }
        // Two that leave little are close to the truth, from where each of them is scored better than pairs are from afar.
        swap_effects(search, &mut diagnosis);
    }
    let left = diagnosis.after.train.total();
    let is_dominated = search.dominates(&diagnosis);
    if !is_dominated {
        pairwise_selection(search, &mut diagnosis);
    }
    match second {
        Some(second) if is_better_everywhere(&second, &diagnosis.after) => {
            let replaced = accept(search, &mut diagnosis, second);
            diagnosis.rejected.push(replaced);
        }
        _ => {
            let is_searched = leads && diagnosis.after.train.total() == left;
            if is_one(&diagnosis) && !is_searched {
                forward_selection(search, &mut diagnosis, 1..usual);
            }
        }
    }
    if has_other_noise(search, &mut diagnosis) {
        return diagnosis;
    }
    if !is_dominated {
        revise(search, &mut diagnosis);
    }
    if groups(&diagnosis.after.effects).count() >= usual {
        forward_selection(search, &mut diagnosis, usual..max);
    }
    merge_variations(search, &mut diagnosis);
    merge_laws_of_one_parameter(search, &mut diagnosis);
    if is_varied_along_curve(search, &diagnosis.after) {
        replace_curves(search, &mut diagnosis);
    }
    simplify(search, &mut diagnosis);
    replace_curves(search, &mut diagnosis);
    compare_curves(search, &mut diagnosis);
    eliminate_unsupported(search, &mut diagnosis);
    compare_alternatives(search, &mut diagnosis);
    compare_siblings(search, &mut diagnosis);
    drop_worthless(search, &mut diagnosis);
    diagnosis
}

/// Adds a second effect to one that explains most of the excess but leaves much, if both together leave little. Otherwise
/// the first one may be wrong, and so the second one: returns them, to be compared with what else is found.
fn add_second(search: &Search<'_>, diagnosis: &mut Diagnosis) -> Option<Hypothesis> {
    let policy = search.policy();
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let leaves = (after.chi2_train() - 1.0) / (before.chi2_train() - 1.0);
    let is_done = search.leads(before, after) || after.is_resolved(policy);
    let is_single = groups(&after.effects).count() == 1;
    if !is_single || is_done || leaves > policy.most_share || !search.may_continue() {
        return None;
    }
    let mut extended = diagnosis.clone();
    forward_selection(search, &mut extended, 1..policy.usual_effects);
    // The second one may have made the first one needless.
    if search.leads(&extended.before, &extended.after) {
        *diagnosis = extended;
        return None;
    }
    (groups(&extended.after.effects).count() > 1).then_some(extended.after)
}

/// True if a hypothesis explains the recordings together better than another, and those that were never fitted too.
fn is_better_everywhere(hypothesis: &Hypothesis, other: &Hypothesis) -> bool {
    hypothesis.total_criterion() < other.total_criterion()
        && hypothesis.validation.total() < other.validation.total()
}

/// True for a single parameter that varies along a free curve, if that leaves nothing to explain: a formula then says more
/// than another search for a single law, and its alternatives are compared later.
fn is_varied_along_curve(search: &Search<'_>, hypothesis: &Hypothesis) -> bool {
    let [only] = hypothesis.effects.as_slice() else { return false };
    let varies = search.study.effects[only.effect].is_variation();
    varies && search.study.is_curve(only.effect) && hypothesis.is_resolved(search.policy())
}

/// Withdraws a partial explanation that leaves nearly everything to explain.
fn drop_worthless(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let policy = search.policy();
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let share = |of: fn(&Hypothesis) -> f64| (of(before) - of(after)) / (of(before) - 1.0);
    let is_worthless = [Hypothesis::chi2_train, Hypothesis::chi2_validation]
        .into_iter()
        .any(|of| share(of) < policy.partial_share);
    let is_partial = !after.effects.is_empty() && diagnosis.verdict(policy) == Verdict::Unexplained;
    if is_partial && is_worthless {
        search.note("what was found explains too little to be named");
        let after = std::mem::replace(&mut diagnosis.after, diagnosis.before.clone());
        diagnosis.rejected.push(after);
    }
}

/// True if the effects leave white residuals of another size than the plan declares: with its noise corrected, the search
/// ends where nothing is left to explain. The diagnosis then holds that noise.
fn has_other_noise(search: &Search<'_>, diagnosis: &mut Diagnosis) -> bool {
    let after = &diagnosis.after;
    let is_open = search.study.corrections.is_empty() && !after.effects.is_empty();
    if !is_open || after.is_resolved(search.policy()) {
        return false;
    }
    let noise = noise(search.study, after);
    let differs = noise.explains_misfit(search.policy());
    if differs {
        search.note("the residuals are white, with another noise than the plan declares");
        diagnosis.noise = noise;
    }
    differs
}

/// Accepts a better hypothesis, less the effects that it does not need. The model without effects is then
/// fitted from the new parameters: if it fits as well from there, it is accepted instead. Returns the
/// replaced hypothesis.
pub fn accept(search: &Search<'_>, diagnosis: &mut Diagnosis, better: Hypothesis) -> Hypothesis {
    let mut best = eliminated(search, without_inert(search.study, better));
    let plain = without_effects(search, &best);
    if let Some(plain) = plain.filter(|p| p.train.total() < diagnosis.before.train.total()) {
        search.note(&format!("without any effect from there: {:.4}", plain.chi2_train()));
        diagnosis.before = plain.clone();
        if plain.total_criterion() < best.total_criterion() + search.policy().evidence {
            diagnosis.rejected.push(std::mem::replace(&mut best, plain));
        }
    }
    let replaced = std::mem::replace(&mut diagnosis.after, best);
    search.announce(diagnosis);
    replaced
}

/// The model without effects, fitted from the parameters of a hypothesis.
fn without_effects(search: &Search<'_>, from: &Hypothesis) -> Option<Hypothesis> {
    let plan = plan_without_effects(search.study, from);
    let policy = search.policy();
    let hopeless = policy.hopeless_factor * from.train.total();
    let fit = Hypothesis::fitted(search.study, Vec::new(), plan, &mut |p| {
        let start = p.start();
        let short = fit::search(p, &start, &policy.short_fit, &mut |_, _| search.on_step())?;
        match short.normal.cost > hopeless {
            true => Some(short),
            false => {
                let on_step = &mut |_, _| search.on_step();
                fit::refined(p, &policy.fit, &short.x, &policy.fit.quick, on_step)
            }
        }
    });
    fit.ok()
}
