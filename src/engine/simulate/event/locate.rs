//! Event location: finds the first instant within a step at which a relation changes.
//!
//! In: a step of the integrator with its dense output. Out: the instant, enclosed from the right.
//! Relations are probed at points within the step; the crossing is enclosed by a bracketing root
//! finder on the zero-crossing indicators. Between probes an indicator may touch zero, or cross it
//! twice: [`super::dips`] finds where.

use crate::integrate::stepper::Stepper;
use crate::ir::program::{Program, RelationTrigger};
use crate::numeric::root::locate;
use crate::runtime::machine::{Fault, Machine};
use crate::simulate::system::{HybridSystem, MAX_ENDLESS_CALLS};

use super::dips::Samples;

/// Number of steps within which an indicator turns more than once, and their share of all steps, from
/// which on its changes may be missed.
const RESTLESS: u32 = 4;
const RESTLESS_SHARE: f64 = 0.002;
/// Of so many steps, one is looked at more closely: the slope of the indicators at its start is compared
/// with their range at the probes. One that turns between all probes may look calm at these.
const STEPS_PER_SLOPE: u32 = 8;
/// Distance over which a slope is taken, as a fraction of the step.
const SLOPE_FRACTION: f64 = 1e-6;
/// Ratio of the change that the slope foretells for the step, and the range at the probes, above which
/// the indicator turns between them. For a sine it is half the phase of the step, in radians, or less.
const FAST: f64 = 3.0;
/// Such steps, and their share, from which on changes may be missed.
const FAST_STEPS: u32 = 4;
const FAST_SHARE: f64 = 0.05;
/// Points within a step, as fractions, at which relations are probed in addition to its end.
const PROBES: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Maximum number of failed evaluations within one step.
const MAX_FAILURES: u32 = 100;
/// Width of the interval that encloses a crossing, in spacings of doubles at its time.
const ENCLOSURE_WIDTH: f64 = 4.0;

/// Locates changes of state-dependent relations.
pub struct Locator {
    relations: Vec<u32>,
    point: Vec<f64>,
    /// Temporarily not monitored.
    ignored: Option<u32>,
    /// Hysteresis of each relation: minimum absolute value of its indicator after a change.
    hysteresis: Vec<f64>,
    samples: Samples,
    /// For each relation, the number of steps in which its indicator turned more than once.
    restless: Vec<u32>,
    /// Number of steps looked at.
    looks: u32,
    /// For each relation, the number of steps at whose start its indicator changed too fast for them.
    fast: Vec<u32>,
    /// Number of steps in which this was compared.
    slope_looks: u32,
    /// Indicators at the start of a step.
    start: Vec<f64>,
}

/// First hysteresis of a chattering relation, in units of its operands.
const FIRST_HYSTERESIS: f64 = 1e-13;
/// Growth factor of the hysteresis while the relation keeps chattering.
const HYSTERESIS_GROWTH: f64 = 100.0;
/// Maximum hysteresis.
const MAX_HYSTERESIS: f64 = 1e-7;

/// Bisections of the interval between two samples in search of a change. The distance of an
/// extremum from a sample falls to the rounding error of the indicator, relative to its change
/// over the interval.
const MAX_DIP_DEPTH: u32 = 26;

/// The zero-crossing indicators of all relations in the memory.
fn indicators<'a>(machine: &'a Machine<'_>) -> &'a [f64] {
    let program = machine.program;
    let first = program.layout.indicators as usize;
    &machine.memory[first..first + program.events.relation_triggers.len()]
}

impl Locator {
    /// Monitors all state-dependent relations of a program.
    pub fn new(program: &Program) -> Self {
        let relations: Vec<u32> = (0..program.events.relation_triggers.len() as u32)
            .filter(|k| program.events.relation_triggers[*k as usize] == RelationTrigger::State)
            .collect();
        let hysteresis = vec![0.0; program.events.relation_triggers.len()];
        let samples = Samples::new(program.events.relation_triggers.len());
        let point = vec![0.0; program.order().max(1)];
        let restless = vec![0; relations.len()];
        let (fast, start) = (restless.clone(), Vec::new());
        Locator {
            relations,
            point,
            ignored: None,
            hysteresis,
            samples,
            restless,
            looks: 0,
            fast,
            slope_looks: 0,
            start,
        }
    }

    /// Widens the hysteresis of chattering relations: smaller changes are rounding errors of
    /// operands at the threshold. False if all have reached the maximum.
    pub fn widen_hysteresis(&mut self, relations: impl Iterator<Item = u32>) -> bool {
        let mut widened = false;
        for k in relations {
            let margin = &mut self.hysteresis[k as usize];
            let wider = (*margin * HYSTERESIS_GROWTH).max(FIRST_HYSTERESIS);
            if wider <= MAX_HYSTERESIS {
                *margin = wider;
                widened = true;
            }
        }
        widened
    }

    /// The hysteresis of a relation.
    pub fn hysteresis(&self, relation: u32) -> f64 {
        self.hysteresis[relation as usize]
    }

    /// Stops monitoring a relation, or monitors all (`None`).
    pub fn ignore(&mut self, relation: Option<u32>) {
        self.ignored = relation;
    }

    /// Resumes monitoring an ignored relation as soon as its candidate value equals its held value.
    pub fn on_step(&mut self, machine: &Machine<'_>) {
        let layout = &machine.program.layout;
        self.ignored = self
            .ignored
            .filter(|k| machine.get(layout.candidates + k) != machine.get(layout.relations + k));
    }

    /// True if there are no relations to monitor.
    pub fn is_empty(&self) -> bool {
        self.relations.is_empty()
    }

    /// The first instant within the last step at which a relation has changed, enclosed from the
    /// right.
    pub fn first_switch(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
    ) -> Result<Option<f64>, Fault> {
        if self.relations.is_empty() {
            return Ok(None);
        }
        let (t0, t1) = (stepper.t_previous(), stepper.t());
        let quiet_until = if self.ignored.is_none() { system.quiet_until(t0, t1) } else { None };
        let mut left = quiet_until.unwrap_or(t0);
        let mut failures_left = MAX_FAILURES;
        self.samples.begin(t0);
        if quiet_until.is_some() {
            for (t, indicators) in system.probes_between(t0, t1) {
                self.samples.add(t, indicators);
            }
        }
        let probes = PROBES.map(|fraction| t0 + fraction * (t1 - t0)).into_iter();
        for target in probes.filter(|_| quiet_until.is_none()).chain([t1]) {
            let mut right = target;
            while left < target {
                match self.evaluate(system, stepper, right) {
                    Ok(()) if self.switched(&system.machine).next().is_some() => {
                        self.look_beyond(system, stepper, right);
                        return Ok(Some(self.enclose(system, stepper, left, right)));
                    }
                    Ok(()) => {
                        self.samples.add(right, indicators(&system.machine));
                        (left, right) = (right, target);
                    }
                    // The held branch may end within the step, but not before its relation changes.
                    Err(fault) => {
                        failures_left = failures_left.saturating_sub(1);
                        right = left + 0.5 * (right - left);
                        let is_endless = system.machine.endless_calls > MAX_ENDLESS_CALLS;
                        if failures_left > 0 && left < right && !is_endless {
                            continue;
                        }
                        // Between the ends the interpolant may leave the domain; the end decides.
                        if target < t1 {
                            break;
                        }
                        return Err(fault);
                    }
                }
            }
        }
        let found = self.first_dip(system, stepper)?;
        if found.is_none() {
            let moved = self.compare_slopes(system, stepper);
            self.count_restless();
            if moved {
                self.evaluate(system, stepper, t1)?;
            }
        }
        self.samples.end(t1);
        Ok(found)
    }

    /// Counts the relations that are restless in a step in which one has changed by `seen`, with samples
    /// up to its end; the memory is then somewhere in the step.
    fn look_beyond(&mut self, system: &mut HybridSystem<'_>, stepper: &dyn Stepper, seen: f64) {
        self.samples.add(seen, indicators(&system.machine));
        let (t0, t1) = (stepper.t_previous(), stepper.t());
        let later = PROBES.map(|fraction| t0 + fraction * (t1 - t0)).into_iter().chain([t1]);
        for t in later.filter(|t| *t > seen) {
            // Beyond the event the held branch need not have values.
            if self.evaluate(system, stepper, t).is_ok() {
                self.samples.add(t, indicators(&system.machine));
            }
        }
        self.compare_slopes(system, stepper);
        self.count_restless();
        self.samples.clear();
        // As it was: what has changed is read from the memory.
        let _ = self.evaluate(system, stepper, seen);
    }

    /// Counts the relations whose indicators start this step with a slope that does not fit to their
    /// samples, if it is one of the steps for this; true if the memory was moved.
    fn compare_slopes(&mut self, system: &mut HybridSystem<'_>, stepper: &dyn Stepper) -> bool {
        let (t0, t1) = (stepper.t_previous(), stepper.t());
        let distance = SLOPE_FRACTION * (t1 - t0);
        let is_resolved = distance > ENCLOSURE_WIDTH * f64::EPSILON * t0.abs().max(t1.abs());
        if !self.looks.is_multiple_of(STEPS_PER_SLOPE) || !is_resolved {
            return false;
        }
        if self.evaluate(system, stepper, t0).is_err() {
            return true;
        }
        self.start.clear();
        self.start.extend_from_slice(indicators(&system.machine));
        if self.evaluate(system, stepper, t0 + distance).is_err() {
            return true;
        }
        self.slope_looks += 1;
        let next = indicators(&system.machine);
        let ignored = self.ignored;
        let looked_at = self.relations.iter().zip(&mut self.fast);
        for (k, count) in looked_at.filter(|(k, _)| ignored != Some(**k)) {
            let (g, h) = (self.start[*k as usize], next[*k as usize]);
            let foretold = ((h - g) / SLOPE_FRACTION).abs();
            *count += u32::from(self.samples.is_outrun(*k, g, foretold / FAST));
        }
        true
    }

    fn count_restless(&mut self) {
        self.looks += 1;
        // Along its threshold, a relation stays as it is, and its indicator is rounding.
        let ignored = self.ignored;
        let looked_at = self.relations.iter().zip(&mut self.restless);
        for (k, count) in looked_at.filter(|(k, _)| ignored != Some(**k)) {
            *count += u32::from(self.samples.is_restless(*k));
        }
    }

    /// The relations whose indicators turned so often within steps that changes may have been missed.
    pub fn unresolved(&self) -> impl Iterator<Item = u32> {
        let share = f64::from(self.looks) * RESTLESS_SHARE;
        let fast_share = f64::from(self.slope_looks) * FAST_SHARE;
        let reaches = |n: u32, least: u32, share: f64| n >= least && f64::from(n) >= share;
        (0..self.relations.len())
            .filter(move |i| {
                reaches(self.restless[*i], RESTLESS, share)
                    || reaches(self.fast[*i], FAST_STEPS, fast_share)
            })
            .map(|i| self.relations[i])
    }

    /// Forgets the samples of the last step: the indicators may have jumped.
    pub fn forget_samples(&mut self) {
        self.samples.clear();
    }

    /// The first instant at which a relation changes between two samples that agree; without one,
    /// the memory stays at the end of the step.
    fn first_dip(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
    ) -> Result<Option<f64>, Fault> {
        let (mut from, mut moved) = (0, false);
        while let Some((interval, depth)) = self.samples.next_suspect(&self.relations, from) {
            from = interval;
            let middle = self.samples.middle(interval);
            let (left, right) = self.samples.interval(interval);
            if depth >= MAX_DIP_DEPTH || !(left < middle && middle < right) {
                from = interval + 1;
                continue;
            }
            moved = true;
            if self.evaluate(system, stepper, middle).is_err() {
                from = interval + 1;
                continue;
            }
            if self.switched(&system.machine).next().is_some() {
                return Ok(Some(self.enclose(system, stepper, left, middle)));
            }
            if !self.samples.insert(interval, middle, indicators(&system.machine)) {
                break;
            }
        }
        if moved {
            self.evaluate(system, stepper, stepper.t())?;
        }
        Ok(None)
    }

    /// Shrinks the interval around the first change and returns its right end.
    fn enclose(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
        left: f64,
        right: f64,
    ) -> f64 {
        let candidates: Vec<u32> = self.switched(&system.machine).collect();
        let at_right = self.largest_overshoot(&system.machine, &candidates);
        // At the left end all candidates agree with their held values.
        let at_left = match self.evaluate(system, stepper, left) {
            Ok(()) => -self.smallest_distance(&system.machine, &candidates),
            Err(_) => -f64::MIN_POSITIVE,
        };
        let tolerance = ENCLOSURE_WIDTH * f64::EPSILON * right.abs().max(right - left);
        let signed = |t: f64| match self.evaluate(system, stepper, t) {
            Ok(()) if self.switched(&system.machine).next().is_some() => {
                self.largest_overshoot(&system.machine, &candidates)
            }
            Ok(()) => -self.smallest_distance(&system.machine, &candidates),
            Err(_) => f64::MIN_POSITIVE,
        };
        locate(signed, (left, at_left), (right, at_right), tolerance).map_or(right, |b| b.right)
    }

    fn evaluate(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
        t: f64,
    ) -> Result<(), Fault> {
        if t == stepper.t() {
            if system.is_current_at(t, stepper.y()) {
                return Ok(());
            }
            self.point.copy_from_slice(stepper.y());
        } else {
            stepper.interpolate(t, &mut self.point);
        }
        system.evaluate_roots_clamped(t, &self.point)
    }

    /// The relations whose candidate value differs from the held one.
    pub fn switched<'a>(&'a self, machine: &'a Machine<'_>) -> impl Iterator<Item = u32> + 'a {
        let layout = &machine.program.layout;
        self.relations
            .iter()
            .copied()
            .filter(|k| self.ignored != Some(*k))
            .filter(|k| machine.get(layout.candidates + k) != machine.get(layout.relations + k))
            .filter(|k| {
                let margin = self.hysteresis[*k as usize];
                margin == 0.0 || machine.get(layout.indicators + k).abs() > margin
            })
    }

    /// Largest absolute indicator of the candidates that have changed; positive.
    fn largest_overshoot(&self, machine: &Machine<'_>, candidates: &[u32]) -> f64 {
        let indicators = machine.program.layout.indicators;
        let switched = self.switched(machine).filter(|k| candidates.contains(k));
        let far = switched.map(|k| machine.get(indicators + k).abs()).fold(0.0, f64::max);
        if far > 0.0 && far.is_finite() { far } else { f64::MIN_POSITIVE }
    }

    /// Smallest absolute indicator of the candidates; not negative.
    fn smallest_distance(&self, machine: &Machine<'_>, candidates: &[u32]) -> f64 {
        let indicators = machine.program.layout.indicators;
        let near = candidates.iter().map(|k| machine.get(indicators + k).abs());
        let near = near.fold(f64::INFINITY, f64::min);
        if near.is_finite() { near } else { f64::MIN_POSITIVE }
    }
}
