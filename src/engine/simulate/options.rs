//! Options of the integrator: tolerances from nominal values, and limits of the step size.

use crate::integrate::options::Options;

use super::settings::Settings;
use super::state_selection::LIMIT;
use super::system::HybridSystem;
use super::time_features::TimeFeatures;

/// Maximum step, in sampling intervals of the recordings that drive the model.
pub(super) const MAX_STEP_INTERVALS: f64 = 4.0;
/// Tolerances are not sharpened beyond this.
const MIN_RTOL: f64 = 1e-12;
/// Minimum number of steps of a run.
pub(super) const MIN_STEPS: f64 = 50.0;

/// Options of the integrator for a model at its start.
pub fn options(
    system: &HybridSystem<'_>,
    settings: &Settings,
    features: &TimeFeatures<'_>,
) -> Options {
    let program = system.machine.program;
    let nominals = program.layout.nominals.iter().map(|slot| {
        let size = system.machine.get(*slot).abs();
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    });
    let mut nominals: Vec<f64> = nominals.collect();
    nominals.resize(program.order().max(1), 1.0);
    // Dependent candidates must meet the tolerance too, although they react more strongly.
    let reaction = if program.state_sets.is_empty() { 1.0 } else { LIMIT * LIMIT };
    let tolerance = (settings.tolerance / reaction).max(MIN_RTOL.min(settings.tolerance));
    let mut options = Options::with_nominals(tolerance, &nominals);
    options.max_steps = settings.most_steps;
    // Shorter features of the signals could be stepped over.
    let machine = &system.machine;
    options.max_step = MAX_STEP_INTERVALS * machine.input_signals.spacing();
    options.max_step = options.max_step.min(machine.delays.shortest_delay(&machine.memory));
    if settings.stop > settings.start {
        // While nothing changes, the error does not limit the step, and a pulse or a pair of
        // crossings could be stepped over.
        let default = (settings.stop - settings.start) / MIN_STEPS;
        options.max_step = options.max_step.min(settings.max_step.unwrap_or(default));
    }
    options.max_step = options.max_step.min(features.max_step);
    if program.order() == 0 && settings.stop > settings.start {
        // A constant state does not limit the step, but events must not be stepped over.
        options.max_step = options.max_step.min(settings.spacing.unwrap_or(settings.interval));
    }
    options
}
