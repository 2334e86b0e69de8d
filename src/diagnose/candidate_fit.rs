//! Fits of the effects that a score test proposes: a short fit of each, a full fit of the best, and further
//! starts if the best looks like a local minimum.

use crate::calibrate::fit::{Fit, refined, search as local_search};
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::Problem;
use crate::numeric::least_squares;

use super::backward_elimination::eliminated;
use super::hypothesis::{ChosenEffect, Hypothesis, attach};
use super::place::Place;
use super::policy::SearchPolicy;
use super::preference::{
    ends_with_curve, ends_with_instrument, ends_with_sensor, sort_by_preference,
};
use super::rank::Scored;
use super::regrid::regridded;
use super::search::Search;
use super::study::Study;

/// Proposals that may extend a hypothesis.
#[derive(Clone, Copy)]
pub struct CandidateFits<'a> {
    /// The search.
    pub search: &'a Search<'a>,
    /// The hypothesis to extend.
    pub from: &'a Hypothesis,
    /// The proposals, of one or several effects each, best score first.
    pub proposals: &'a [Vec<Scored>],
    /// Number of effects before.
    pub depth: usize,
    /// Where proposals are alternatives to what was found: the sum of squares above which a short fit is given up.
    give_up_above: Option<f64>,
    /// Reduced sum of the calibrated model, where `from` is not calibrated: what leaves as much explains nothing.
    calibrated: Option<f64>,
}

/// Steps after which a short fit of an alternative may be given up.
const STEPS_BEFORE_GIVING_UP: u32 = 3;
/// How many times as much as a law a curve may leave after a short fit to get a full one, where no law comes close.
const CURVE_MAY_PASS: f64 = 4.0;
/// Share of the promise of an actuator that explains everything which its rivals promise as well.
const RIVAL_SHARE: f64 = 0.98;

impl<'a> CandidateFits<'a> {
    /// The proposals, of one or several effects each, that may extend a hypothesis with a number of effects.
    pub fn new(
        search: &'a Search<'a>,
        from: &'a Hypothesis,
        proposals: &'a [Vec<Scored>],
        depth: usize,
    ) -> Self {
        CandidateFits { search, from, proposals, depth, give_up_above: None, calibrated: None }
    }

    /// For alternatives to what was found: the sum of squares above which a short fit is given up.
    pub fn giving_up_above(self, sum: f64) -> Self {
        CandidateFits { give_up_above: Some(sum), ..self }
    }

    /// For alternatives whose `from` is not calibrated: the calibrated model without effects. Those that explain little
    /// of what it leaves are not fitted to convergence.
    pub fn instead_of(self, before: &Hypothesis) -> Self {
        CandidateFits { calibrated: Some(before.chi2_train()), ..self }
    }

    /// The hypothesis extended by each of the proposals, best first.
    pub fn run(&self) -> Vec<Hypothesis> {
        self.completed(self.first_fits())
    }

    /// The same where the first fits explain at least this share of the excess; else these alone.
    pub fn run_if_explained(&self, share: f64) -> Vec<Hypothesis> {
        let first = self.first_fits();
        let excess = |h: &Hypothesis| h.chi2_train() - 1.0;
        let most = (1.0 - share) * excess(self.from);
        match first.iter().any(|h| excess(h) < most) {
            true => self.completed(first),
            false => first,
        }
    }

    /// The best of first fits, continued to convergence and from other starts.
    fn completed(&self, mut hypotheses: Vec<Hypothesis>) -> Vec<Hypothesis> {
        let (search, from) = (self.search, self.from);
        // Recordings that were never fitted count as much as the fitted ones.
        let criterion = Hypothesis::total_criterion;
        sort_by_preference(search, from, &mut hypotheses, criterion);
        if hypotheses.first().is_some_and(|h| self.resolves(h)) {
            return hypotheses;
        }
        self.fit_fully(&mut hypotheses);
        sort_by_preference(search, from, &mut hypotheses, criterion);
        if let Some(best) = hypotheses
            .first()
            .filter(|h| self.may_be_local_minimum(h) && !search.is_nearly_resolved(h))
            && let Some(better) = self.refit_from_other_starts(best)
        {
            hypotheses[0] = better;
            sort_by_preference(search, from, &mut hypotheses, criterion);
        }
        hypotheses
    }

    /// A short fit of each, and if none explains much, another from the plan's start.
    fn first_fits(&self) -> Vec<Hypothesis> {
        let mut hypotheses = self.short_fits();
        if self.depth == 0 && !hypotheses.iter().any(|h| self.explains_most(h)) {
            // The calibration may have left the region from which an effect can be found.
            let at_start = Hypothesis { plan: self.search.study.plan.clone(), ..self.from.clone() };
            for other in (CandidateFits { from: &at_start, ..*self }).short_fits() {
                let same = |h: &&mut Hypothesis| h.has_same_effects(&other);
                match hypotheses.iter_mut().find(same) {
                    Some(known) if known.bic() <= other.bic() => {}
                    Some(known) => *known = other,
                    None => hypotheses.push(other),
                }
            }
        }
        hypotheses
    }

    /// A short fit of each proposal.
    pub fn short_fits(&self) -> Vec<Hypothesis> {
        let policy = self.search.policy();
        let mut hypotheses: Vec<Hypothesis> = Vec::new();
        let (left, mut least_gain) = (self.from.train.total(), f64::NEG_INFINITY);
        let (study, mut variation_resolves) = (self.search.study, false);
        // What a proposal must promise beside an instrument that explains everything.
        let mut least_promise: f64 = 0.0;
        let mut hopeless = self.give_up_above.unwrap_or(f64::INFINITY);
        for proposal in self.proposals {
            if !self.search.may_continue() {
                break;
            }
            let gain = proposal.first().map_or(0.0, |s| s.gain);
            let varies = proposal.iter().any(|s| study.effects[s.effect].varies.is_some());
            let promises_less = gain < least_promise;
            if proposal.len() > 1 && gain < least_gain
                || varies && variation_resolves
                || promises_less
            {
                continue;
            }
            if !self.search.is_new(self.from, proposal) {
                continue;
            }
            let (effects, plan) = attach(self.search.study, self.from, proposal, self.depth);
            // A named law may need more steps than a curve, and is worth them.
            let is_named = !varies && !proposal.iter().any(|s| study.is_curve(s.effect));
            let limit = match is_named {
                true => self.give_up_above.unwrap_or(f64::INFINITY),
                false => hopeless,
            };
            let short = &mut |p: &mut Problem<'_>, start: &[f64]| {
                let is_hopeless =
                    |step: u32, cost: f64| step >= STEPS_BEFORE_GIVING_UP && cost > limit;
                let on_step = &mut |step, cost| self.search.on_step() && !is_hopeless(step, cost);
                trimmed_fit(p, start, policy, on_step)
            };
            let mut fitted = self.fitted(effects.clone(), plan.clone(), short);
            let nothing_yet = self.from.effects.is_empty();
            let is_close = fitted.as_ref().is_some_and(|h| self.search.leads(self.from, h));
            if nothing_yet && !is_close && self.from.chi2_train() > policy.large_effect_above {
                let from_plan = self.fitted(effects, self.with_planned_starts(&plan), short);
                let cost =
                    |h: &Option<Hypothesis>| h.as_ref().map_or(f64::INFINITY, |h| h.train.total());
                if cost(&from_plan) < cost(&fitted) {
                    fitted = from_plan;
                }
            }
            if let Some(fitted) = fitted {
                let label = self.label(&fitted);
                self.search.note(&format!("short fit of {label}: {:.4}", fitted.chi2_train()));
                let leads = self.leads(&fitted).then(|| self.continued(&fitted)).flatten();
                if let Some(leader) = &leads {
                    hopeless = hopeless.min(policy.trailing_factor * leader.train.total());
                }
                let fitted = leads.unwrap_or(fitted);
                if fitted.explains_training(policy) {
                    least_gain = least_gain.max(gain - policy.pair_margin * left);
                }
                // Another effect that explains as much as a sensor promises about as much.
                let is_of_sensor = ends_with_sensor(&fitted) && !ends_with_curve(study, &fitted);
                if is_of_sensor && fitted.is_resolved(policy) {
                    least_promise = least_promise.max(policy.alternative_share * gain);
                }
                // The rivals of an actuator promise the same to first order.
                let is_of_actuator = ends_with_instrument(study, &fitted)
                    && !is_of_sensor
                    && !ends_with_curve(study, &fitted);
                if is_of_actuator && fitted.is_complete_fit && fitted.is_resolved(policy) {
                    least_promise = least_promise.max(RIVAL_SHARE * gain);
                }
                let resolves = self.resolves(&fitted);
                hypotheses.push(fitted);
                // A named law may explain as much as a parameter that varies.
                variation_resolves |= resolves && varies;
                if resolves && !varies {
                    break;
                }
            }
        }
        hypotheses
    }

    /// True for a short fit that explains so much that it is continued before others are tried.
    fn leads(&self, hypothesis: &Hypothesis) -> bool {
        let study = self.search.study;
        let specific = !ends_with_curve(study, hypothesis) && !ends_with_sensor(hypothesis);
        let is_alternative = self.give_up_above.is_some();
        specific
            && !is_alternative
            && self.from.effects.is_empty()
            && self.search.leads(self.from, hypothesis)
    }

    /// True for a completed fit of an effect on the machine that leaves nothing to explain. Sensors and actuators have
    /// rivals of their kind.
    fn resolves(&self, hypothesis: &Hypothesis) -> bool {
        let study = self.search.study;
        let specific =
            !ends_with_curve(study, hypothesis) && !ends_with_instrument(study, hypothesis);
        specific && hypothesis.is_complete_fit && hypothesis.is_resolved(self.search.policy())
    }

    /// A hypothesis fitted to convergence.
    fn continued(&self, hypothesis: &Hypothesis) -> Option<Hypothesis> {
        let full = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            self.full_fit(p, &start)
        };
        let from = |start: &Hypothesis, full: &mut dyn FnMut(&mut Problem<'_>) -> Option<Fit>| {
            let (effects, plan) = (start.effects.clone(), start.plan.clone());
            Hypothesis::fitted(self.search.study, effects, plan, full).ok()
        };
        let on_new_knots = regridded(self.search, hypothesis).and_then(|moved| from(&moved, full));
        let is_better = |h: &Hypothesis| h.train.total() < hypothesis.train.total();
        let mut better = match on_new_knots.filter(is_better) {
            Some(better) => better,
            None => from(hypothesis, full)?,
        };
        // At several places, those of which the recordings say nothing would reject all of them.
        if better.is_at_several_places() && !better.is_determined(self.search.study) {
            better = eliminated(self.search, better);
        }
        better.is_complete_fit = true;
        self.note(&format!("fitted {}", self.label(&better)), &better);
        Some(better)
    }

    /// Continues the best short fits to convergence: parametric effects that explain much, then curves, then the rest.
    pub fn fit_fully(&self, hypotheses: &mut [Hypothesis]) {
        const CURVES: u8 = 1;
        const WEAK: u8 = 2;
        // A curve adds nothing to a parametric effect that leaves nothing to explain; if a curve leaves
        // nothing, parametric effects are searched for from there.
        let rank =
            |h: &Hypothesis| match (ends_with_curve(self.search.study, h), self.explains_most(h)) {
                (false, true) => 0,
                (true, _) => CURVES,
                (false, false) => WEAK,
            };
        let mut order = self.worth_a_full_fit(hypotheses);
        order.sort_by_key(|k| rank(&hypotheses[*k]));
        let (mut parametric_resolves, mut curve_resolves) = (false, false);
        for k in order {
            let hypothesis = &mut hypotheses[k];
            let own_rank = rank(hypothesis);
            if parametric_resolves && own_rank == CURVES || curve_resolves && own_rank == WEAK {
                continue;
            }
            let better = match hypothesis.is_complete_fit {
                true => hypothesis.clone(),
                false => match self.continued(hypothesis) {
                    Some(better) => better,
                    None => continue,
                },
            };
            if better.explains_training(self.search.policy()) {
                match ends_with_curve(self.search.study, &better) {
                    true => curve_resolves = true,
                    false => parametric_resolves = true,
                }
            }
            *hypothesis = better;
        }
    }

    fn full_fit(&self, problem: &mut Problem<'_>, start: &[f64]) -> Option<Fit> {
        let policy = &self.search.policy().fit;
        refined(problem, policy, start, &policy.full, &mut |_, _| self.search.on_step())
    }

    /// Positions of the hypotheses that are worth a full fit.
    ///
    /// A free curve always fits well, so parametric effects are only compared with each other. A curve
    /// that a parametric effect surpasses already after the short fits is not worth it.
    fn worth_a_full_fit(&self, hypotheses: &[Hypothesis]) -> Vec<usize> {
        let (study, policy) = (self.search.study, self.search.policy());
        let least_excess = |curves: bool| {
            let of_kind = hypotheses.iter().filter(|h| curves || !ends_with_curve(study, h));
            of_kind.map(|h| h.chi2_train() - 1.0).fold(f64::INFINITY, f64::min)
        };
        let factor = policy.long_fit_factor;
        let limit = |least: f64| 1.0 + (factor * least).max(factor * (policy.resolved_train - 1.0));
        let (parametric, any) = (least_excess(false), least_excess(true));
        let explains_nothing = |h: &Hypothesis| self.calibrated.is_some() && !self.explains_most(h);
        // Where no law comes close, a curve may after more steps.
        let leads = |h: &&Hypothesis| self.search.leads(self.from, h);
        let mut leading = hypotheses.iter().filter(leads);
        let is_close = match self.search.generosity() {
            1 => leading.next().is_some(),
            // Fits cost little.
            _ => leading.any(|h| h.is_resolved(policy)),
        };
        let may_pass = if is_close { 1.0 } else { CURVE_MAY_PASS };
        let is_near = |h: &Hypothesis| match ends_with_curve(study, h) {
            true => h.chi2_train() < (may_pass * limit(any)).min(1.0 + may_pass * parametric),
            false => h.chi2_train() < limit(parametric),
        };
        let is_worth_it = |h: &Hypothesis| is_near(h) && !explains_nothing(h);
        let first = 0..hypotheses.len().min(policy.long_fits * self.search.generosity());
        first.filter(|k| is_worth_it(&hypotheses[*k])).collect()
    }

    /// The last added effects fitted from other starts: the plan's start, which the calibration without them
    /// has left to compensate for them, and other shape parameters. `None` if nothing better is found.
    fn refit_from_other_starts(&self, best: &Hypothesis) -> Option<Hypothesis> {
        let mut better: Option<Hypothesis> = None;
        for (effects, plan) in self.other_starts(best) {
            if !self.search.may_continue() {
                break;
            }
            let policy = self.search.policy();
            let least = better.as_ref().unwrap_or(best);
            let hopeless = policy.hopeless_factor * least.train.total();
            let full = &mut |p: &mut Problem<'_>, start: &[f64]| {
                let on_step = &mut |_, _| self.search.on_step();
                let short = local_search(p, start, &policy.short_fit, on_step)?;
                match short.normal.cost > hopeless {
                    true => Some(short),
                    false => self.full_fit(p, &short.x),
                }
            };
            let Some(fitted) = self.fitted(effects, plan, full) else { continue };
            self.note("from another start", &fitted);
            if fitted.total_criterion() < least.total_criterion() {
                better = Some(Hypothesis { is_complete_fit: true, ..fitted });
            }
            if better.as_ref().is_some_and(|b| !self.may_be_local_minimum(b)) {
                break;
            }
        }
        better
    }

    fn other_starts(&self, best: &Hypothesis) -> Vec<(Vec<ChosenEffect>, Plan)> {
        let study = self.search.study;
        let from_plan = self.with_planned_starts(&best.plan);
        let mut starts = vec![(best.effects.clone(), from_plan)];
        let new: Vec<(usize, &[String])> =
            self.added(best).iter().map(|c| (c.effect, c.place.at.as_slice())).collect();
        let same = |p: &&Vec<Scored>| {
            let members: Vec<(usize, Place)> = p.iter().flat_map(Scored::members).collect();
            members.iter().map(|(effect, place)| (*effect, place.at.as_slice())).eq(new.clone())
        };
        let Some(proposal) = self.proposals.iter().find(same) else { return starts };
        for (k, scored) in proposal.iter().enumerate() {
            for other in scored.others.iter().take(self.search.policy().other_shapes) {
                let mut proposal = proposal.clone();
                proposal[k] = other.clone();
                starts.push(attach(study, self.from, &proposal, self.depth));
            }
        }
        starts
    }

    /// A plan whose free parameters, but for those of effects, start at the values of the study's plan.
    pub fn with_planned_starts(&self, plan: &Plan) -> Plan {
        let mut plan = plan.clone();
        for free in &mut plan.free {
            let as_planned = self.search.study.plan.free.iter().find(|f| f.name == free.name);
            free.start = as_planned.map_or(free.start, |f| f.start);
        }
        plan
    }

    /// The effects that a hypothesis has beyond those it extends.
    fn added<'h>(&self, hypothesis: &'h Hypothesis) -> &'h [ChosenEffect] {
        &hypothesis.effects[self.from.effects.len()..]
    }

    /// The same for messages.
    fn label(&self, hypothesis: &Hypothesis) -> String {
        let mut last = None;
        let mut labels: Vec<String> = Vec::new();
        for c in self.added(hypothesis) {
            match labels.last_mut() {
                Some(label) if last == Some(c.group) => {
                    label.push_str(", ");
                    label.push_str(&c.place.at.join(", "));
                }
                _ => labels.push(self.search.study.label(c.effect, &c.place)),
            }
            last = Some(c.group);
        }
        labels.join(" and ")
    }

    /// The hypothesis with these effects, fitted from the best start along the promised amplitudes.
    fn fitted(
        &self,
        effects: Vec<ChosenEffect>,
        plan: Plan,
        fit: &mut dyn FnMut(&mut Problem<'_>, &[f64]) -> Option<Fit>,
    ) -> Option<Hypothesis> {
        let new = amplitudes(self.search.study, &effects[self.from.effects.len()..]);
        let from_best_start = &mut |p: &mut Problem<'_>| {
            let start = best_start(p, &new, &self.search.policy().start_shares);
            fit(p, &start)
        };
        Hypothesis::fitted(self.search.study, effects, plan, from_best_start).ok()
    }

    fn note(&self, what: &str, hypothesis: &Hypothesis) {
        let (train, validation) = (hypothesis.chi2_train(), hypothesis.chi2_validation());
        self.search.note(&format!("{what}: {train:.4}, validation {validation:.4}"));
        for sums in [&hypothesis.train, &hypothesis.validation] {
            let each = sums.by_recording();
            let worst = each.iter().copied().fold(0.0, f64::max);
            let total = sums.total() / sums.count().max(1) as f64;
            if worst > OUTSTANDING * total {
                self.search.note(&format!("  by recording {each:.1?}"));
            }
        }
    }

    /// True for a fit that explains most of the excess, but not all of it: a better minimum may be near.
    fn may_be_local_minimum(&self, hypothesis: &Hypothesis) -> bool {
        let policy = self.search.policy();
        let limit = policy.validation_limit(hypothesis.validation.count());
        let leaves_something = !hypothesis.explains_training(policy)
            || hypothesis.chi2_validation() > limit.max(1.0 + policy.local_minimum_above);
        leaves_something && self.explains_most(hypothesis)
    }

    /// True for a fit that explains most of the excess.
    fn explains_most(&self, hypothesis: &Hypothesis) -> bool {
        let before = self.from.chi2_train().min(self.calibrated.unwrap_or(f64::INFINITY));
        let excess = before - 1.0;
        hypothesis.chi2_train() - 1.0 < self.search.policy().most_share * excess
    }
}

/// A short fit to some of the training recordings if they are long; to all of them if those left out are then described
/// worse than at the start, as where they alone determine a part of a curve.
fn trimmed_fit(
    problem: &mut Problem<'_>,
    start: &[f64],
    policy: &SearchPolicy,
    on_step: &mut dyn FnMut(u32, f64) -> bool,
) -> Option<Fit> {
    problem.trimmed = problem.surplus(policy.score_instants);
    let is_trimmed = !problem.trimmed.is_empty();
    let fit = local_search(problem, start, &policy.short_fit, on_step);
    problem.trimmed = Vec::new();
    let cost = |problem: &mut Problem<'_>, x: &[f64]| {
        least_squares::Residuals::cost(problem, x).unwrap_or(f64::INFINITY)
    };
    match fit {
        Some(fit) if is_trimmed && cost(problem, &fit.x) > cost(problem, start) => {
            local_search(problem, start, &policy.short_fit, on_step)
        }
        fit => fit,
    }
}

/// Multiple of the mean reduced sum at which a recording is worth a line of its own.
const OUTSTANDING: f64 = 3.0;

/// Full names of the amplitudes of effects.
pub fn amplitudes(study: &Study, effects: &[ChosenEffect]) -> Vec<String> {
    let of = |c: &ChosenEffect| {
        let all = study.effects[c.effect].amplitudes.iter();
        all.map(|a| c.full_name(&a.name)).collect::<Vec<_>>()
    };
    effects.iter().flat_map(of).collect()
}

/// The best start among `shares` of the promised amplitudes: the score is linear, and the full amplitudes may
/// lie far beyond the range in which it holds.
pub fn best_start(problem: &mut Problem<'_>, amplitudes: &[String], shares: &[f64]) -> Vec<f64> {
    let whole = problem.start();
    if amplitudes.is_empty() {
        return whole;
    }
    let at = |share: &f64| {
        let scaled = problem.parameters.iter().zip(&whole).map(|(p, x)| {
            let is_new = amplitudes.contains(&p.name);
            if is_new { p.scale.place(share * p.start) } else { *x }
        });
        scaled.collect::<Vec<f64>>()
    };
    let points: Vec<Vec<f64>> = shares.iter().map(at).collect();
    let costs: Vec<f64> = points
        .iter()
        .map(|x| least_squares::Residuals::cost(problem, x).unwrap_or(f64::INFINITY))
        .collect();
    let best = (0..points.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    best.map_or(whole, |k| points[k].clone())
}
