//! The choices of a calibration that are not derived from theory: limits, thresholds and stopping rules.
//!
//! All of them stand here with their unit and their consequence. Sums of squares are in units of the
//! sensors' noise, so a *reduced* sum (sum of squares by degree of freedom) is near 1 where the model
//! explains the data. Steps of the search are in its own coordinates, in which a change by 1 multiplies a
//! positive parameter by e ([`super::parameter::Scale`]).

use crate::numeric::least_squares::Stopping;

/// Choices of a fit and of the profiles that follow it.
#[derive(Clone, PartialEq, Debug)]
pub struct FitPolicy {
    /// When a fit stops. Default: a predicted decrease of 1e-7 of the sum, or 60 steps.
    pub full: Stopping,
    /// The same where even the best fit is expected to be poor. Default: 1e-5, or 25 steps.
    pub quick: Stopping,
    /// The same while recordings are trimmed, when only the direction matters. Default: 1e-4, or 15 steps.
    pub trimmed: Stopping,

    /// Reduced sum of squares below which a fit needs no improvement. Default 1.05. Larger values accept
    /// local minima that a restart would leave.
    pub adequate: f64,
    /// Decrease, as a share of the sum of squares, that counts as an improvement. Default 1e-3.
    pub improvement: f64,
    /// Points around the plan's start at which the sum of squares is evaluated if the fit from the start is
    /// not adequate. Default 12. Each costs one run per recording.
    pub restart_points: usize,
    /// Of these, the points with the least sum of squares from which fits begin. Default 2.
    pub restarts: usize,
    /// Half-width of the box of restart points, in coordinates of the search. Default 0.6, a factor of
    /// about two to either side.
    pub restart_spread: f64,

    /// Rounds of trimming recordings in one fit. Default 4.
    pub trimming_rounds: usize,
    /// A recording is trimmed if its reduced sum exceeds that of the median recording by this factor.
    /// Default 1.3. Smaller values trim more, and lose information.
    pub outlier_factor: f64,
    /// Reduced sum of the kept recordings below which trimming has led somewhere, and the fit to all
    /// recordings resumes from there. Default 1.5.
    pub trimmed_adequate: f64,
    /// The same if their sum has fallen below this share of what it was before trimming. Default 0.6.
    pub trimmed_decrease: f64,
    /// In a model that may lack an effect, a poor fit is normal: there trimming is tried only if the worst
    /// recording exceeds the median by this factor, or if the median is below `trimmed_adequate`.
    /// Default 2.5.
    pub hindering_factor: f64,
    /// A recording jumps to another trajectory if its sum of squares rises across a failed step by this
    /// share of the mean over all recordings. Default 0.1.
    pub jump_share: f64,

    /// Restarts of the fit from better minima that profiles run into. Default 3; after that, intervals come
    /// from standard errors.
    pub profile_restarts: usize,
    /// Runs of all recordings for one end of one interval. Default 5.
    pub profile_runs: u32,
    /// Relative error, of the root of the increase, at which the end of an interval is interpolated.
    /// Default 0.1.
    pub profile_precision: f64,
    /// Decrease of the sum of squares that the other parameters may still promise at a point of a profile,
    /// without another run. Default 0.4; the end of an interval is where the sum has grown by 3.84.
    pub profile_gain: f64,
    /// Longest distance of a point of a profile from the minimum, in coordinates of the search. Default 2,
    /// a factor of about seven.
    pub profile_reach: f64,
    /// A point of a profile whose sum of squares is lower than the minimum by this much is a better
    /// minimum, not rounding. Default 0.5.
    pub profile_improvement: f64,
}

impl Default for FitPolicy {
    fn default() -> Self {
        FitPolicy {
            full: Stopping {
                decrease: 1e-7,
                step: 1e-7,
                iterations: 60,
                reach: 1.0,
                by_data: true,
            },
            quick: Stopping {
                decrease: 1e-5,
                step: 1e-6,
                iterations: 25,
                reach: 1.0,
                by_data: false,
            },
            trimmed: Stopping {
                decrease: 1e-4,
                step: 1e-5,
                iterations: 15,
                reach: 1.0,
                by_data: false,
            },
            adequate: 1.05,
            improvement: 1e-3,
            restart_points: 12,
            restarts: 2,
            restart_spread: 0.6,
            trimming_rounds: 4,
            outlier_factor: 1.3,
            trimmed_adequate: 1.5,
            trimmed_decrease: 0.6,
            hindering_factor: 2.5,
            jump_share: 0.1,
            profile_restarts: 3,
            profile_runs: 5,
            profile_precision: 0.1,
            profile_gain: 0.4,
            profile_reach: 2.0,
            profile_improvement: 0.5,
        }
    }
}
