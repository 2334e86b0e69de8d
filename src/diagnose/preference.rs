//! The order of preference among fitted hypotheses.

use super::hypothesis::Hypothesis;
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
    // A special case of a law that explains the same says no more.
    prefer_earlier_law(hypotheses, &criterion, SAME_CRITERION);
    // An instrument is blamed only if no effect on the measured machine explains as much: an effect in proportion
    // to a pressure is also a scale error of its sensor. Where much is left, small differences mean little, except to
    // a parameter that varies, which follows what any other effect leaves.
    let of_instrument = |h: &Hypothesis| ends_with_instrument(study, h);
    let varies = |h: &Hypothesis| ends_with_variation(study, h);
    let explained = |h: &Hypothesis| from.train.total() - h.train.total();
    if let Some(instrument) = hypotheses.first().filter(|h| of_instrument(h)) {
        let least = criterion(instrument);
        let margin = |h: &Hypothesis| match instrument.chi2_train() < policy.resolved_validation {
            false if !varies(h) => policy.evidence.max(policy.instrument_share * least),
            _ => policy.evidence,
        };
        let machine = |h: &Hypothesis| !of_instrument(h) && criterion(h) < least + margin(h);
        if let Some(k) = hypotheses.iter().position(machine) {
            hypotheses[..=k].rotate_right(1);
        }
    }
    // Of two instruments the actuator comes first.
    if let Some(sensor) = hypotheses.first().filter(|h| ends_with_sensor(h)) {
        let as_good = criterion(sensor) + policy.evidence;
        let actuator =
            |h: &Hypothesis| of_instrument(h) && !ends_with_sensor(h) && !ends_with_curve(study, h);
        let actuator = |h: &Hypothesis| actuator(h) && criterion(h) < as_good;
        if let Some(k) = hypotheses.iter().position(actuator) {
            hypotheses[..=k].rotate_right(1);
        }
    }
    // A term of an equation that explains the same as a wrong value of a parameter is no missing law.
    let is_value = |h: &Hypothesis| ends_with_value(study, h);
    let is_term = |h: &Hypothesis| ends_with_term(study, h);
    if let Some(term) = hypotheses.first().filter(|h| is_term(h)) {
        let as_good = criterion(term) + policy.evidence;
        let value = |h: &Hypothesis| is_value(h) && criterion(h) < as_good;
        if let Some(k) = hypotheses.iter().position(value) {
            hypotheses[..=k].rotate_right(1);
        }
    }
    // A parameter that varies is a finding without a name: a named law comes first if it explains as much, or nearly as
    // much and more of what was never fitted.
    if let Some(variation) = hypotheses.first().filter(|h| varies(h)) {
        let as_good = criterion(variation) + policy.evidence;
        let wanted = policy.parametric_share * explained(variation);
        let stays_first = |h: &Hypothesis| is_value(variation) && is_term(h);
        let unseen = variation.validation.total() - policy.evidence;
        let holds_better = |h: &Hypothesis| h.validation.total() < unseen && explained(h) > wanted;
        let named = |h: &Hypothesis| {
            !varies(h)
                && !ends_with_product(study, h)
                && !stays_first(h)
                && !of_instrument(h)
                && !ends_with_curve(study, h)
                && (criterion(h) < as_good || holds_better(h))
        };
        if let Some(k) = hypotheses.iter().position(named) {
            hypotheses[..=k].rotate_right(1);
        }
    }
    if let Some(product) = hypotheses.first().filter(|h| ends_with_product(study, h)) {
        let as_good = criterion(product) + policy.evidence;
        let plainer = |h: &Hypothesis| {
            !ends_with_product(study, h)
                && !ends_with_curve(study, h)
                && !of_instrument(h)
                && criterion(h) < as_good
        };
        if let Some(k) = hypotheses.iter().position(plainer) {
            hypotheses[..=k].rotate_right(1);
        }
    }
    // Of the laws by which a parameter varies with a variable, the straight line is the first of the catalogue.
    if hypotheses.first().is_some_and(varies) {
        prefer_earlier_law(hypotheses, &criterion, policy.evidence);
    }
    let Some(curve) = hypotheses.first().filter(|h| ends_with_curve(study, h)) else { return };
    let wanted = policy.parametric_share * explained(curve);
    let limit = policy.parametric_factor * curve.train.total();
    // Where the curve leaves hardly more than noise, what a named law leaves more of is evidence against it; elsewhere
    // the curve describes drift and rounding as well.
    let is_near_noise =
        curve.chi2_train().max(curve.chi2_validation()) < policy.resolved_validation;
    let as_good = criterion(curve) + policy.evidence;
    let nearly_as_good = |h: &Hypothesis| match is_near_noise {
        true => criterion(h) < as_good || h.is_resolved(policy),
        false => {
            explained(h) > wanted
                && h.train.total() < limit
                && h.validation.total() <= policy.parametric_factor * curve.validation.total()
        }
    };
    let is_parametric = |h: &Hypothesis| !ends_with_curve(study, h) && !of_instrument(h);
    if let Some(k) = hypotheses.iter().position(|h| is_parametric(h) && nearly_as_good(h)) {
        hypotheses[..=k].rotate_right(1);
    }
}

/// Difference of criteria below which two laws explain the same.
const SAME_CRITERION: f64 = 0.5;

/// Puts an earlier law of the catalogue at the place of the first hypothesis before that, if its criterion is not greater by
/// more than a margin.
fn prefer_earlier_law(
    hypotheses: &mut [Hypothesis],
    criterion: &impl Fn(&Hypothesis) -> f64,
    margin: f64,
) {
    let Some(first) = hypotheses.first() else { return };
    let Some(own) = first.effects.last() else { return };
    let limit = criterion(first) + margin;
    let is_earlier = |h: &Hypothesis| {
        let other = h.effects.last();
        other.is_some_and(|c| c.place == own.place && c.effect < own.effect) && criterion(h) < limit
    };
    if let Some(k) = hypotheses.iter().position(is_earlier) {
        hypotheses[..=k].rotate_right(1);
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
fn ends_with_product(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.effects[c.effect].is_product())
}

/// True if the last added effect is a free curve.
pub fn ends_with_curve(study: &Study, hypothesis: &Hypothesis) -> bool {
    hypothesis.effects.last().is_some_and(|c| study.is_curve(c.effect))
}
