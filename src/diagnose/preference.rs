//! The order of preference among fitted hypotheses.

use super::hypothesis::Hypothesis;
use super::policy::SearchPolicy;
use super::search::Search;
use super::study::Study;

/// Sorts hypotheses that extend `from`, best first.
///
/// A free curve explains at least as much as the parametric effect that it contains, and noise and drift as
/// well: it comes first only if no parametric effect explains nearly as much.
pub fn sort_by_preference(
    search: &Search<'_>,
    from: &Hypothesis,
    hypotheses: &mut [Hypothesis],
    criterion: impl Fn(&Hypothesis) -> f64,
) {
    let (study, policy) = (search.study, search.policy());
    hypotheses.sort_by(|a, b| criterion(a).total_cmp(&criterion(b)));
    let order = Preference { study, policy, from, criterion: &criterion };
    // A special case of a law that explains the same says no more.
    order.earlier_law(hypotheses, SAME_CRITERION);
    order.machine_before_instrument(hypotheses);
    order.actuator_before_sensor(hypotheses);
    order.value_before_term(hypotheses);
    order.named_law_before_variation(hypotheses);
    order.plainer_law_before_product(hypotheses);
    // Of the laws by which a parameter varies with a variable, the straight line is the first of the catalogue.
    if hypotheses.first().is_some_and(|h| ends_with_variation(study, h)) {
        order.earlier_law(hypotheses, policy.evidence);
    }
    order.parametric_law_before_curve(hypotheses);
}

/// Difference of criteria below which two laws explain the same.
const SAME_CRITERION: f64 = 0.5;

/// Puts the first hypothesis of a kind before all others.
fn promote(hypotheses: &mut [Hypothesis], is: impl Fn(&Hypothesis) -> bool) {
    if let Some(k) = hypotheses.iter().position(is) {
        hypotheses[..=k].rotate_right(1);
    }
}

/// The rules by which another hypothesis takes the place of the first one.
struct Preference<'a> {
    study: &'a Study,
    policy: &'a SearchPolicy,
    from: &'a Hypothesis,
    criterion: &'a dyn Fn(&Hypothesis) -> f64,
}

impl Preference<'_> {
    fn explained(&self, hypothesis: &Hypothesis) -> f64 {
        self.from.train.total() - hypothesis.train.total()
    }

    fn of_instrument(&self, hypothesis: &Hypothesis) -> bool {
        ends_with_instrument(self.study, hypothesis)
    }

    /// An earlier law of the catalogue at the place of the first hypothesis comes before that, if its criterion is not
    /// greater by more than a margin.
    fn earlier_law(&self, hypotheses: &mut [Hypothesis], margin: f64) {
        let Some(first) = hypotheses.first() else { return };
        let Some(own) = first.effects.last().cloned() else { return };
        let limit = (self.criterion)(first) + margin;
        promote(hypotheses, |h| {
            let other = h.effects.last();
            other.is_some_and(|c| c.place.is_same_over(&own.place) && c.effect < own.effect)
                && (self.criterion)(h) < limit
        });
    }

    /// An instrument is blamed only if no effect on the measured machine explains as much: an effect in proportion to a
    /// pressure is also a scale error of its sensor. Where much is left, small differences mean little, except to a
    /// parameter that varies, which follows what any other effect leaves.
    fn machine_before_instrument(&self, hypotheses: &mut [Hypothesis]) {
        let Some(first) = hypotheses.first().filter(|h| self.of_instrument(h)) else { return };
        let (least, policy) = ((self.criterion)(first), self.policy);
        let is_near_noise = first.chi2_train() < policy.resolved_validation;
        let margin = |h: &Hypothesis| match is_near_noise {
            false if !ends_with_variation(self.study, h) => {
                policy.evidence.max(policy.instrument_share * least)
            }
            _ => policy.evidence,
        };
        promote(hypotheses, |h| !self.of_instrument(h) && (self.criterion)(h) < least + margin(h));
    }

    /// Of two instruments that explain the same, the actuator comes first.
    fn actuator_before_sensor(&self, hypotheses: &mut [Hypothesis]) {
        let Some(first) = hypotheses.first().filter(|h| ends_with_sensor(h)) else { return };
        let as_good = (self.criterion)(first) + self.policy.evidence;
        promote(hypotheses, |h| {
            self.of_instrument(h)
                && !ends_with_sensor(h)
                && !ends_with_curve(self.study, h)
                && (self.criterion)(h) < as_good
        });
    }

    /// A term of an equation that explains the same as a wrong value of a parameter is no missing law.
    fn value_before_term(&self, hypotheses: &mut [Hypothesis]) {
        let is_term = |h: &&Hypothesis| ends_with_term(self.study, h);
        let Some(first) = hypotheses.first().filter(is_term) else { return };
        let as_good = (self.criterion)(first) + self.policy.evidence;
        promote(hypotheses, |h| ends_with_value(self.study, h) && (self.criterion)(h) < as_good);
    }

    /// A parameter that varies is a finding without a name: a named law comes first if it explains as much, or nearly as
    /// much and more of what was never fitted.
    fn named_law_before_variation(&self, hypotheses: &mut [Hypothesis]) {
        let (study, policy) = (self.study, self.policy);
        let varies = |h: &Hypothesis| ends_with_variation(study, h);
        let Some(first) = hypotheses.first().filter(|h| varies(h)) else { return };
        let as_good = (self.criterion)(first) + policy.evidence;
        let wanted = policy.parametric_share * self.explained(first);
        let unseen = first.validation.total() - policy.evidence;
        let is_value = ends_with_value(study, first);
        let holds_better =
            |h: &Hypothesis| h.validation.total() < unseen && self.explained(h) > wanted;
        let is_named = |h: &Hypothesis| match ends_with_term(study, h) {
            true => !is_value && !ends_with_product(study, h),
            false => !varies(h),
        };
        promote(hypotheses, |h| {
            is_named(h)
                && !self.of_instrument(h)
                && !ends_with_curve(study, h)
                && ((self.criterion)(h) < as_good || holds_better(h))
        });
    }

    /// A term with one variable, or another law, comes before a product of variables that explains the same.
    fn plainer_law_before_product(&self, hypotheses: &mut [Hypothesis]) {
        let study = self.study;
        let is_product = |h: &&Hypothesis| ends_with_product(study, h);
        let Some(first) = hypotheses.first().filter(is_product) else { return };
        let as_good = (self.criterion)(first) + self.policy.evidence;
        promote(hypotheses, |h| {
            !ends_with_product(study, h)
                && !ends_with_curve(study, h)
                && !self.of_instrument(h)
                && (self.criterion)(h) < as_good
        });
    }

    /// A parametric law comes before a free curve that explains hardly more. Where the curve leaves hardly more than noise,
    /// what a named law leaves more of is evidence against it; elsewhere the curve describes drift and rounding as well.
    fn parametric_law_before_curve(&self, hypotheses: &mut [Hypothesis]) {
        let (study, policy) = (self.study, self.policy);
        let is_curve = |h: &&Hypothesis| ends_with_curve(study, h);
        let Some(first) = hypotheses.first().filter(is_curve) else { return };
        let wanted = policy.parametric_share * self.explained(first);
        let limit = policy.parametric_factor * first.train.total();
        let most_held_out = policy.parametric_factor * first.validation.total();
        let is_near_noise =
            first.chi2_train().max(first.chi2_validation()) < policy.resolved_validation;
        let as_good = (self.criterion)(first) + policy.evidence;
        let nearly_as_good = |h: &Hypothesis| match is_near_noise {
            true => (self.criterion)(h) < as_good || h.is_resolved(policy),
            false => {
                self.explained(h) > wanted
                    && h.train.total() < limit
                    && h.validation.total() <= most_held_out
            }
        };
        promote(hypotheses, |h| {
            !ends_with_curve(study, h) && !self.of_instrument(h) && nearly_as_good(h)
        });
    }
}

/// True if the last added effect acts on a sensor.
pub fn ends_with_sensor(hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| c.place.signal.is_some())
}

/// True if the last added effect acts on a sensor or an actuator.
pub fn ends_with_instrument(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.is_of_instrument(c.effect, &c.place))
}

/// True if the last added effect lets a parameter vary.
pub fn ends_with_variation(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.effects[c.effect].varies.is_some())
}

/// True if the last added effect gives a parameter another value.
pub fn ends_with_value(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.effects[c.effect].is_other_value())
}

/// True if the last added effect is a term of an equation.
pub fn ends_with_term(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.effects[c.effect].adds.is_some())
}

/// True if the last added effect is a product of variables.
pub fn ends_with_product(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.effects[c.effect].is_product())
}

/// True if the last added effect is a free curve.
pub fn ends_with_curve(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.is_curve(c.effect))
}
