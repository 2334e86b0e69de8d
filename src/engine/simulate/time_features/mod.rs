//! Instants at which the model's expressions of time alone have an extremum, a zero or a jump.
//!
//! In: the tapes of the derivatives and of the zero-crossing indicators. Out: instants that become
//! ends of steps, and the largest step that resolves the oscillations that relations depend on.
//!
//! The error estimate of a step sees only the points at which the step evaluates the model, so a
//! pulse between them goes unnoticed. Its expression gives it away: the argument of
//! `exp(-((time - 0.5)/1e-4)^2)` has its extremum at the pulse, and is wide where the pulse is
//! narrow. So the expressions of time and parameters are evaluated over the whole run on a grid,
//! and a step ends at each of their extrema; if there is a pulse, the error estimate sees it and
//! the steps shrink to its width.
//!
//! Where a sine or cosine has more periods than that grid resolves, and a function that may make a pulse or a kink of it
//! reads it, the run is looked over part by part on a finer grid ([`windows`]). So are expressions of variables that
//! change at events only, from one event to the next.

mod dependence;
mod look;
mod windows;

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::ir::program::Slot;
use crate::runtime::machine::Machine;

use super::settings::Settings;

use dependence::{Expressions, slots_of_relations};
use look::Look;
use windows::{Windows, spacing_for};

/// Minimum number of intervals of the grid.
const MIN_INTERVALS: f64 = 200.0;
/// Maximum number of intervals of the grid.
const MAX_INTERVALS: f64 = 1000.0;
/// Maximum number of instructions that one look over the run executes: some milliseconds.
const MAX_INSTRUCTIONS: f64 = 2e6;
/// Instants closer than this, as a fraction of the run, are one.
const RESOLUTION: f64 = 1e-9;
/// Maximum number of steps that oscillations in relations may ask for, and of intervals of the grid for others.
const MAX_OSCILLATION_STEPS: f64 = 2e7;
/// Minimum number of steps where oscillations in relations ask for more than that.
const STEPS_IF_UNRESOLVED: f64 = 1e6;
/// Minimum number of intervals between two events.
const MIN_INTERVALS_BETWEEN_EVENTS: f64 = 16.0;
/// Intervals that are looked over at once between events: what follows the next event was looked over in vain.
const INTERVALS_AT_ONCE: f64 = 64.0;

/// The features of a run's expressions of time.
pub struct TimeFeatures<'p> {
    /// Ascending, s.
    instants: Vec<f64>,
    next: usize,
    resolution: f64,
    /// A quarter of the shortest period of a sine or cosine of time that a relation depends on, s;
    /// infinity if there is none.
    pub max_step: f64,
    /// Periods of a sine or cosine in the run, if they are more than steps can follow.
    pub unresolved_periods: Option<f64>,
    /// Oscillations that are too fast for a look over the whole run.
    oscillations: Option<Windows<'p>>,
    between_events: Option<BetweenEvents<'p>>,
}

/// Expressions of time and of variables that change at events only.
struct BetweenEvents<'p> {
    windows: Windows<'p>,
    /// Slots that the expressions read.
    inputs: Vec<Slot>,
    /// Distance of the points of the grid, s.
    spacing: f64,
    /// There was an event since the last look.
    is_stale: bool,
}

impl<'p> TimeFeatures<'p> {
    /// Looks over the run of an initialized machine.
    pub fn new(machine: &mut Machine<'p>, settings: &Settings) -> TimeFeatures<'p> {
        let (start, stop) = (settings.start, settings.stop);
        let resolution = RESOLUTION * (stop - start);
        let mut features = TimeFeatures {
            instants: vec![],
            next: 0,
            resolution,
            max_step: f64::INFINITY,
            unresolved_periods: None,
            oscillations: None,
            between_events: None,
        };
        if stop > start {
            let of_time = Expressions::of_time(machine.program);
            features.look_between_events(machine, settings, &of_time);
            if !of_time.code.is_empty() {
                features.look_over_run(machine, settings, &of_time);
            }
        }
        features
    }

    fn look_over_run(
        &mut self,
        machine: &mut Machine<'p>,
        settings: &Settings,
        of_time: &Expressions,
    ) {
        let (start, stop) = (settings.start, settings.stop);
        let spacing = spacing_of_run(settings, of_time);
        let mut look = Look::new(machine.program, machine.snapshot(), of_time, of_time.watched());
        look.budget = MAX_INSTRUCTIONS;
        look.scan(start, stop, ((stop - start) / spacing).round() as usize);
        let least_spacing = (stop - start) / MAX_OSCILLATION_STEPS;
        let in_relations = look.fastest(&slots_of_relations(machine.program));
        let sharpened = of_time.sharpened();
        let in_functions = look.fastest(&sharpened);
        self.max_step = FRAC_PI_2 / in_relations;
        let fine = spacing_for(in_functions);
        if fine.min(self.max_step) < least_spacing {
            let fastest = in_relations.max(in_functions);
            self.unresolved_periods = Some(fastest * (stop - start) / TAU);
            self.max_step = self.max_step.max((stop - start) / STEPS_IF_UNRESOLVED);
        }
        if (least_spacing..spacing).contains(&fine) {
            look.budget = f64::INFINITY;
            let windows = Windows::new(look, sharpened, (start, stop), fine, MAX_INTERVALS);
            self.oscillations = Some(windows);
            return;
        }
        machine.recycle(look.memory);
        self.instants = look.found;
        self.instants.sort_by(f64::total_cmp);
        let resolution = self.resolution;
        self.instants.dedup_by(|a, b| *a - *b <= resolution);
    }

    /// Prepares the look from one event to the next.
    fn look_between_events(
        &mut self,
        machine: &mut Machine<'p>,
        settings: &Settings,
        of_time: &Expressions,
    ) {
        let expressions = Expressions::between_events(machine.program);
        let watched = expressions.watched_besides(of_time);
        if watched.is_empty() {
            return;
        }
        let (start, stop) = (settings.start, settings.stop);
        let look = Look::new(machine.program, machine.snapshot(), &expressions, watched);
        let (sharpened, least) = (expressions.sharpened(), (stop - start) / MAX_OSCILLATION_STEPS);
        let windows = Windows::new(look, sharpened, (start, stop), least, INTERVALS_AT_ONCE);
        self.between_events = Some(BetweenEvents {
            windows,
            inputs: expressions.inputs(),
            spacing: spacing_of_run(settings, &expressions),
            is_stale: true,
        });
    }

    /// What changes at events only may have changed.
    pub fn after_event(&mut self) {
        if let Some(between) = &mut self.between_events {
            between.is_stale = true;
        }
    }

    /// The end of a step that starts at `t` and must not pass `t_stop`, s: the first instant
    /// between them, if there is one. `t` must not decrease. The next event that time causes is at `event`.
    pub fn end_of_step(&mut self, machine: &Machine<'_>, t: f64, t_stop: f64, event: f64) -> f64 {
        // Just before another stop it would only add a tiny step.
        let (after, before) = (t + self.resolution, t_stop - self.resolution);
        while self.instants.get(self.next).is_some_and(|at| *at <= after) {
            self.next += 1;
        }
        let known = self.instants.get(self.next).copied().filter(|at| *at < before);
        let fast = self.oscillations.as_mut().and_then(|w| w.first_between(after, before));
        let between = self.between_events.as_mut();
        let held = between.and_then(|b| b.first_between(machine, (t, event), after, before));
        [known, fast, held].into_iter().flatten().fold(t_stop, f64::min)
    }
}

impl BetweenEvents<'_> {
    /// The first instant between two others, s, where no event is expected in `free`.
    fn first_between(
        &mut self,
        machine: &Machine<'_>,
        free: (f64, f64),
        after: f64,
        before: f64,
    ) -> Option<f64> {
        let length = free.1 - free.0;
        if self.is_stale && length > 0.0 {
            for slot in &self.inputs {
                self.windows.look.memory[*slot as usize] = machine.memory[*slot as usize];
            }
            let spacing = self.spacing.min(length / MIN_INTERVALS_BETWEEN_EVENTS);
            self.windows.restart(free, spacing);
            self.is_stale = false;
        }
        self.windows.first_between(after, before)
    }
}

/// Distance of the points of the grid on which the whole run is looked over, s.
fn spacing_of_run(settings: &Settings, expressions: &Expressions) -> f64 {
    let length = settings.stop - settings.start;
    let interval = settings.spacing.unwrap_or(settings.interval);
    let intervals = (length / interval)
        .clamp(MIN_INTERVALS, MAX_INTERVALS)
        .min(MAX_INSTRUCTIONS / expressions.code.len().max(1) as f64)
        .floor();
    length / intervals.max(1.0)
}
