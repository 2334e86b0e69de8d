//! The evidence for a hypothesis where the residuals are coloured.
//!
//! Thousands of samples whose residuals are correlated tell no more than a few independent ones, and the sum of their
//! squares in units of the sensor's noise says little where the model is far off. The number of samples is therefore
//! divided by the correlation time of the residuals that are left, and the variance of each signal counts as unknown:
//! the criterion is n ln(S/n) with the effective number n in place of the sum of squares S (G. Schwarz, *Estimating the
//! dimension of a model*, Annals of Statistics 6, 1978. The parameters are fitted to the training recordings alone, so
//! their number of samples is that of the penalty. Effective number: G. V. Bayley, J. M. Hammersley, *The
//! "effective" number of independent observations in an autocorrelated time series*, Supplement to the Journal of the
//! Royal Statistical Society 8, 1946).

use crate::calibrate::data::{Recording, Split};
use crate::calibrate::fit::search as local_search;
use crate::calibrate::problem::Problem;
use crate::calibrate::sums::Sums;
use crate::numeric::whiteness::Residuals;

use super::backward_elimination::without;
use super::hypothesis::{Hypothesis, groups};
use super::residual::of_hypothesis;
use super::result::Diagnosis;
use super::revise::accept_instead;
use super::search::Search;
use super::study::Study;

/// Removes effects that leave much to explain and that so few independent samples do not support.
pub fn eliminate_unsupported(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let policy = search.policy();
    for k in (0..groups(&diagnosis.after.effects).count()).rev() {
        let after = &diagnosis.after;
        let number = groups(&after.effects).count();
        if number < 2 || after.is_resolved(policy) || !search.may_continue() {
            return;
        }
        let Some(own) = groups(&after.effects).nth(k) else { continue };
        let names: Vec<String> = own.iter().map(|c| c.name.clone()).collect();
        let refit = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            local_search(p, &start, &policy.fit.full, &mut |_, _| search.on_step())
        };
        let Some(rest) = without(search.study, after, &names, refit) else { continue };
        let gain = effective_gain(search.study, &rest, after);
        search.note(&format!("evidence of {}, coloured residuals: {gain:.1}", names.join(", ")));
        if gain <= 0.0 {
            accept_instead(search, diagnosis, rest);
        }
    }
}

/// Whether so few independent samples support a first effect: their gain exceeds what the best of all candidates, `number`,
/// gains by chance from noise, the greatest of as many squares of normal variables.
pub fn supports_first(study: &Study, from: &Hypothesis, to: &Hypothesis, number: usize) -> bool {
    effective_gain(study, from, to) > 2.0 * (number.max(1) as f64).ln()
}

/// By how much the criterion over training and validation recordings falls from one hypothesis to another; infinite if the
/// residuals of the other are too few to tell.
fn effective_gain(study: &Study, from: &Hypothesis, to: &Hypothesis) -> f64 {
    let residuals = of_hypothesis(study, to);
    let all: Vec<&Recording> = Split::ALL.into_iter().flat_map(|s| study.data.of(s)).collect();
    let (mut gain, mut fitted) = (0.0, 0.0);
    for k in 0..study.plan.signals.len() {
        let seen = all.iter().zip(&residuals).filter(|(r, _)| r.split != Split::Test);
        let runs = seen.filter_map(|(_, signals)| Some(signals.get(k)?.as_slice())).collect();
        let Some(own) = Residuals::new(runs) else { return f64::INFINITY };
        let independent = own.count() as f64 / own.correlation_time();
        let of = |h: &Hypothesis| square(h, k);
        gain += independent * (of(from) / of(to)).ln();
        fitted += independent * share_of_training(to, k);
    }
    let parameters = to.values.len() as f64 - from.values.len() as f64;
    gain - parameters * fitted.max(1.0).ln()
}

/// The share of the samples of a signal that are in training recordings.
fn share_of_training(hypothesis: &Hypothesis, signal: usize) -> f64 {
    let number = |sums: &Sums| -> usize {
        sums.counts.iter().filter_map(|of_recording| of_recording.get(signal)).sum()
    };
    let (train, validation) = (number(&hypothesis.train), number(&hypothesis.validation));
    train as f64 / (train + validation).max(1) as f64
}

/// The sum of squares of a signal over training and validation recordings.
fn square(hypothesis: &Hypothesis, signal: usize) -> f64 {
    let both = [&hypothesis.train, &hypothesis.validation];
    let squares = both.into_iter().flat_map(|sums| &sums.squares);
    squares.filter_map(|of_recording| of_recording.get(signal)).sum()
}
