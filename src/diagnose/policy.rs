//! The choices of the search for missing effects that are not derived from theory: limits, thresholds and
//! stopping rules.
//!
//! All of them stand here with their unit and their consequence. Sums of squares are in units of the
//! sensors' noise; a *reduced* sum is divided by the degrees of freedom and near 1 where the model explains
//! the data. A *share* is a part of the sum of squares that is left to explain.

use crate::calibrate::policy::FitPolicy;
use crate::numeric::least_squares::Stopping;

/// Choices of a search for missing effects.
#[derive(Clone, PartialEq, Debug)]
pub struct SearchPolicy {
    /// Rules of the fits.
    pub fit: FitPolicy,

    /// The effects that the search is restricted to, by their names with or without the package; `parameter` for those that let
    /// parameters vary. Default empty: all.
    pub only: Vec<String>,

    /// Reduced sum of the training recordings below which nothing is left to explain. Default 1.03.
    /// Smaller values search for effects in drift and rounding.
    pub resolved_train: f64,
    /// The same for recordings that were never fitted. Default 1.1.
    pub resolved_validation: f64,
    /// Reduced sum of the training recordings without effects below which a first effect is to be supported by as many samples
    /// as the correlation of the residuals leaves independent. Default 1.5: above, noise does not explain the sum.
    pub faint_below: f64,
    /// Standard deviations of the reduced sum of pure noise that those limits exceed 1 by at least: with few samples,
    /// noise alone exceeds them. Default 2.
    pub resolved_deviations: f64,
    /// Share of the excess of the validation sum over 1 that effects must explain for the verdict
    /// `effect_found`, unless they explain everything. Default 0.9. A curve that is swapped for a named law must explain the
    /// same share of what that law leaves.
    pub explained_share: f64,
    /// Reduced sum above which the verdict is `unexplained` even then. Default 3. Above it, effects beyond `usual_effects`
    /// need not explain `second_share`.
    pub explained_limit: f64,
    /// The most effects that may leave something to explain; more of them are a partial explanation. Default 3.
    pub most_that_leave_something: usize,
    /// A run of a training recording by a model with effects is abandoned after this many times the steps of the calibrated model, and
    /// `further_steps`. Default 20. Effects that make a model stiff or let it chatter are rarely what it lacks, and take
    /// most of the time.
    pub steps_factor: u64,
    /// Steps that any such run may take. Default 2000.
    pub further_steps: u64,
    /// Share of the excess over noise, of the fitted recordings and of those held out, below which a partial explanation is
    /// not worth to be named. Default 0.1.
    pub partial_share: f64,
    /// Decrease of the Bayesian information criterion that counts as evidence. Default 30, well above what
    /// the best of hundreds of places reaches by chance. Smaller values find weaker effects, and false ones.
    pub evidence: f64,

    /// Deviation, in standard deviations of a standard normal variable, above which residuals have structure.
    /// Default 4.5, which noise reaches in one of 100 000 tests. Larger values overlook weak effects where
    /// the plan declares too little noise. Structure of less than a share `resolved_train - 1` of the power is
    /// negligible.
    pub structure_limit: f64,
    /// Deviation of the noise from what the plan declares that is reported, as a share. Default 0.05.
    pub noticeable_noise: f64,
    /// The same in standard errors; both must be exceeded. Default 4.
    pub noise_errors: f64,

    /// Places in one model of a score test. Default 48. More places per model cost fewer runs, each of
    /// which propagates more derivatives.
    pub batch: usize,
    /// The same for the smallest models. Default 12.
    pub least_batch: usize,
    /// Instants of recordings for a score test or a short fit. Default 10 000.
    pub score_instants: usize,
    /// Instants that suffice to preselect candidates for that test. Default 3000.
    pub preselection_instants: usize,
    /// Candidates that are preselected. Default 64. With at most twice as many there is no preselection.
    pub preselected: usize,

    /// Effects that forward selection adds at most. Default 5.
    pub max_effects: usize,
    /// Of these, the effects that are searched for while anything is left to explain. Default 2.
    pub usual_effects: usize,
    /// Reduced sum above which further effects are searched for. Default 2.
    pub many_effects_above: f64,
    /// Share that each of these further effects must promise, and explain. Default 0.1.
    pub notable_share: f64,
    /// Places that are fitted after a score test. Default 5.
    pub fitted_places: usize,
    /// Times as many, and pairs and full fits too, where the training recordings have no more than
    /// `preselection_instants`. Default 2.
    pub proposals_if_short: usize,
    /// Of these, parameters that vary. Default 3: they describe much and name nothing.
    pub fitted_variations: usize,
    /// Besides these, parameters with another value than the model gives them. Default 2.
    pub fitted_values: usize,
    /// Of these, terms that are products of variables. Default 1.
    pub fitted_products: usize,
    /// Share of the promise of a parameter that varies along a curve which the best straight line must promise to be fitted
    /// first. Default 0.9.
    pub straight_share: f64,
    /// Of these, laws that the model chooses. Default 2: what they promise counts other parameters as well.
    pub fitted_choices: usize,
    /// Places that are fitted besides because they promise most for recordings that were never fitted.
    /// Default 2.
    pub fitted_by_validation: usize,
    /// Candidates of a preliminary fit, where a large effect makes the score unreliable. Default 32.
    pub preliminary_fits: usize,
    /// Of these, the ones that are fitted first, if they leave less than `most_share`. Default 3.
    pub preferred_preliminary_fits: usize,
    /// When a preliminary fit stops, and once more for the best of them. Default: 4 steps.
    pub preliminary_fit: Stopping,
    /// Fits of the same effects at the same places. Default 3. More repeat what is known from other starts.
    pub fits_of_the_same: usize,
    /// Share of what an effect that explains nearly everything leaves which a second effect must explain. Default 0.7. Less
    /// is more often a fault of the first law's form than a second phenomenon.
    pub second_share: f64,
    /// Share of the excess which a single effect must explain, of the fitted recordings and of the others, so that pairs
    /// without it are not searched for; less than `many_effects_above` must be left as well. Of recordings that were never
    /// fitted, `explained_share` is enough if nothing is left of the others. Default 0.99.
    pub dominant_share: f64,
    /// Steps of all fits after which no further fit begins. Default 1400; with short recordings, more by the
    /// square of `proposals_if_short`.
    pub max_steps: u64,
    /// An effect whose amplitudes are all within this many standard errors of zero is a candidate for
    /// elimination. Default 10.
    pub weak_below: f64,
    /// If nothing explains the data, the calibration is repeated thoroughly; it escaped a local minimum if
    /// its sum of squares is below this share of the quick one. Default 0.7.
    pub escaped_share: f64,

    /// When a short fit stops. Default: a predicted decrease of 1e-3 of the sum, or 10 steps.
    pub short_fit: Stopping,
    /// Shares of the promised amplitudes that are tried as the start of a short fit, since the score is
    /// linear and overshoots. Default 1, 0.5, 0.2, 0.07, 0.02 and 0, where nothing is worse than without the effect.
    pub start_shares: [f64; 6],
    /// Short fits that are continued to convergence. Default 3.
    pub long_fits: usize,
    /// A short fit is continued only if its excess over 1 is within this factor of the least. Default 2.
    pub long_fit_factor: f64,
    /// A fit explains most of the excess if it leaves less than this share of it. Default 0.5.
    pub most_share: f64,
    /// A short fit that explains this share of the excess, but for [`Self::leading_excess`], is continued
    /// before the next proposal is fitted. Default 0.98. Smaller values continue more fits.
    pub leading_share: f64,
    /// Excess of the reduced sum that such a fit may leave in any case. Default 0.3.
    pub leading_excess: f64,
    /// Beside such a fit, a short fit of a curve or of a parameter that varies whose sum of squares still exceeds its own by this factor after a few steps is given
    /// up. Default 4.
    pub trailing_factor: f64,
    /// Reduced sum without effects above which preliminary and short fits begin at the plan's values as well: a large effect
    /// has dragged the calibrated ones far away. Default 5.
    pub large_effect_above: f64,
    /// Reduced sum without effects above which candidates are looked at in runs that follow the recordings. Default 200: they
    /// cost about ten seconds for the valve, and below, free runs found the cause of most specimens.
    pub follow_above: f64,
    /// A short fit from another start is given up if its sum of squares exceeds the best one by this factor.
    /// Default 2.
    pub hopeless_factor: f64,
    /// Excess of the validation sum over 1 that marks a fit which explains most as a possible local
    /// minimum. Default 0.1.
    pub local_minimum_above: f64,
    /// Other shape parameters from which such a fit is started again. Default 2.
    pub other_shapes: usize,
    /// If a pair of effects leaves nothing to explain, pairs are still fitted whose promise is lower by at
    /// most this share. Default 0.01.
    pub pair_margin: f64,

    /// Effects with at least this many amplitudes are free curves; the others are parametric. Default 4.
    pub curve_amplitudes: usize,
    /// A parametric effect is preferred to a free curve that leaves more than `resolved_validation` if it explains this
    /// share of what the curve explains.
    /// Default 0.95.
    pub parametric_share: f64,
    /// But not if its sum of squares, of the fitted recordings or of the others, exceeds that of the curve by this
    /// factor. Default 5.
    pub parametric_factor: f64,
    /// Where much is left to explain, an effect of the machine is preferred to one of a sensor or an actuator if its
    /// criterion is larger by at most this share. Default 0.1.
    pub instrument_share: f64,

    /// Formulas that are fitted in the place of a free curve. Default 7.
    pub fitted_formulas: usize,

    /// Candidates from which pairs are formed. Default 120. The number of pairs grows with its square.
    pub pair_candidates: usize,
    /// Of these, parameters that vary. Default 8.
    pub pair_variations: usize,
    /// Pairs that are fitted, at most half of them with a sensor or an actuator, and half with a parameter that varies.
    /// Default 8.
    pub fitted_pairs: usize,
    /// Of these, pairs that share an effect at a place. Default 3.
    pub pairs_per_member: usize,

    /// Rounds of swapping effects. Default 3.
    pub swap_rounds: usize,
    /// Alternatives to a single parametric effect that are fitted. Default 3.
    pub alternatives: usize,
    /// Share of the accepted effect's own promise that an alternative must promise, as must any effect to be fitted after a
    /// sensor that explains everything. Default 0.7.
    pub alternative_share: f64,
    /// Share of the greatest first promise that an alternative must have promised to be scored again.
    /// Default 0.25.
    pub alternative_promise: f64,
    /// Excess, as a share of the excess without effects, up to which an alternative is fitted to
    /// convergence after a short fit. Default 0.02.
    pub alternative_excess: f64,
}

impl SearchPolicy {
    /// Reduced sum of the training recordings below which nothing is left to explain, for a number of samples.
    pub fn train_limit(&self, samples: usize) -> f64 {
        self.resolved_train.max(1.0 + self.noise_of_sum(samples))
    }

    /// The same for recordings that were never fitted.
    pub fn validation_limit(&self, samples: usize) -> f64 {
        self.resolved_validation.max(1.0 + self.noise_of_sum(samples))
    }

    /// What noise adds to a reduced sum: its variance is 2/n for n independent samples.
    fn noise_of_sum(&self, samples: usize) -> f64 {
        self.resolved_deviations * (2.0 / samples.max(1) as f64).sqrt()
    }
}

impl Default for SearchPolicy {
    fn default() -> Self {
        let fit = FitPolicy::default();
        SearchPolicy {
            only: Vec::new(),
            // Amplitudes start at a promised size, and parameters that a plan leaves unbounded compensate for what is missing:
            // their steps stay short.
            fit: FitPolicy { full: Stopping { by_data: false, ..fit.full }, ..fit },
            resolved_train: 1.03,
            resolved_validation: 1.1,
            faint_below: 1.5,
            resolved_deviations: 2.0,
            explained_share: 0.9,
            explained_limit: 3.0,
            most_that_leave_something: 3,
            steps_factor: 20,
            further_steps: 2_000,
            partial_share: 0.1,
            evidence: 30.0,
            structure_limit: 4.5,
            noticeable_noise: 0.05,
            noise_errors: 4.0,
            batch: 48,
            least_batch: 12,
            score_instants: 10_000,
            preselection_instants: 3_000,
            preselected: 64,
            max_effects: 5,
            usual_effects: 2,
            many_effects_above: 2.0,
            notable_share: 0.1,
            fitted_places: 5,
            proposals_if_short: 2,
            fitted_variations: 3,
            fitted_values: 2,
            fitted_products: 1,
            preliminary_fits: 32,
            preferred_preliminary_fits: 3,
            preliminary_fit: Stopping {
                decrease: 1e-2,
                step: 1e-4,
                iterations: 4,
                reach: 1.0,
                by_data: false,
            },
            straight_share: 0.9,
            fitted_choices: 2,
            fitted_by_validation: 2,
            fits_of_the_same: 3,
            second_share: 0.7,
            dominant_share: 0.99,
            max_steps: 1400,
            weak_below: 10.0,
            escaped_share: 0.7,
            short_fit: Stopping {
                decrease: 1e-3,
                step: 1e-5,
                iterations: 10,
                reach: 1.0,
                by_data: false,
            },
            start_shares: [1.0, 0.5, 0.2, 0.07, 0.02, 0.0],
            long_fits: 3,
            long_fit_factor: 2.0,
            most_share: 0.5,
            leading_share: 0.98,
            leading_excess: 0.3,
            trailing_factor: 4.0,
            follow_above: 200.0,
            large_effect_above: 5.0,
            hopeless_factor: 2.0,
            local_minimum_above: 0.1,
            other_shapes: 2,
            pair_margin: 0.01,
            curve_amplitudes: 4,
            parametric_share: 0.95,
            parametric_factor: 5.0,
            instrument_share: 0.1,
            fitted_formulas: 7,
            pair_candidates: 120,
            pair_variations: 8,
            fitted_pairs: 8,
            pairs_per_member: 3,
            swap_rounds: 3,
            alternatives: 3,
            alternative_share: 0.7,
            alternative_promise: 0.25,
            alternative_excess: 0.02,
        }
    }
}
