//! A model at one instant, with all variables evaluated: where a run arrives, where it comes to rest, or where its
//! equations are solved with derivatives of zero.
//!
//! *In:* a program and the settings of a run. *Out:* an [`OperatingPoint`], from which [`super::linearize`] takes
//! derivatives.
//!
//! A model *settles* if it is simulated until it no longer moves; then Newton's method makes the point exact. So of
//! several steady states it is the one that the model itself comes to, and it is never an unstable one. *Solving* starts
//! Newton's method at the initial values instead: it is immediate, and finds unstable steady states too.
//!
//! Natural monotonicity test: P. Deuflhard, *Newton Methods for Nonlinear Problems*, 2004, section 3.3.1. A matrix
//! without full rank, as for a position that is free, is inverted as by Moore and Penrose: the nearest steady state.

use crate::base::diag::Diagnostic;
use crate::base::source::{SourceMap, Span};
use crate::integrate::system::System;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Event};
use crate::numeric::eigenvalues::eigenvalues;
use crate::numeric::pseudo_inverse::PseudoInverse;

use super::cause::RunCause;
use super::event::iterate::iterate;
use super::event::time_events::Clocks;
use super::failure::{Failure, of_fault, start_failure};
use super::initialization::initialise;
use super::record::Sink;
use super::run::arrive;
use super::settings::Settings;
use super::system::HybridSystem;

/// Each run until rest is longer than the last one by this factor.
const LONGER: f64 = 10.0;
/// Number of runs until rest.
const MAX_RUNS: i32 = 6;
/// Steps of each of them.
const MAX_STEPS: u64 = 300_000;
/// A model rests if Newton's method would move each state by less than this, relative to its size.
const AT_REST: f64 = 1e-3;
/// Relative change of the states by the last correction of Newton's method.
const CONVERGED: f64 = 1e-11;
/// The same, where rounding allows no more.
const ACCEPTED: f64 = 1e-7;
/// Corrections of Newton's method.
const MAX_CORRECTIONS: u32 = 60;
/// Shortest fraction of a correction.
const MIN_DAMPING: f64 = 1e-6;
/// Updates of relations while equations are solved.
const MAX_SWITCHES: u32 = 30;
/// Multiples of the elapsed time at which a model that rests must still rest: none is a multiple of another.
const LATER: [f64; 3] = [1.618_033_988_7, std::f64::consts::E, LONGER];

/// A model at one instant.
pub struct OperatingPoint<'p> {
    /// The system, with all variables evaluated.
    pub system: HybridSystem<'p>,
    /// The instant, s.
    pub time: f64,
    /// The states; one 0 for a model without states.
    pub y: Vec<f64>,
}

impl<'p> OperatingPoint<'p> {
    /// Where a run arrives at its stop time, or where the model ends it before.
    pub fn of_run(
        program: &'p Program,
        settings: &Settings,
        sources: &SourceMap,
    ) -> Result<Self, Failure> {
        let (system, time, y) = arrive(program, settings, sources, &mut Ignore)?;
        let mut point = OperatingPoint { system, time, y };
        point.evaluate()?;
        Ok(point)
    }

    /// The start of a run, with other values for some of its states, by position. Discrete variables follow them.
    pub fn at(
        program: &'p Program,
        settings: &Settings,
        states: &[(usize, f64)],
    ) -> Result<Self, Failure> {
        let (mut point, clocks) = OperatingPoint::start(program, settings)?;
        for (k, value) in states {
            point.y[*k] = *value;
        }
        point.switch(&clocks)?;
        point.evaluate()?;
        Ok(point)
    }

    /// Where the model comes to rest.
    pub fn settled(
        program: &'p Program,
        settings: &Settings,
        sources: &SourceMap,
    ) -> Result<Self, Failure> {
        let span =
            if settings.stop > settings.start { settings.stop - settings.start } else { 1.0 };
        let mut settings = settings.clone().without_grid();
        settings.most_steps = settings.most_steps.min(MAX_STEPS);
        let mut last = None;
        for k in 0..MAX_RUNS {
            settings.stop = settings.start + span * LONGER.powi(k);
            settings.interval = settings.stop - settings.start;
            let point = OperatingPoint::of_run(program, &settings, sources);
            let mut point = match point {
                Ok(point) => point,
                Err(failure) if is_exhausted(&failure) && last.is_some() => break,
                Err(failure) => return Err(failure),
            };
            let elapsed = (point.time - settings.start).max(0.0);
            match point.rests(elapsed)? {
                None => return Ok(point),
                Some(moving) => last = Some((point.time, moving)),
            }
            if point.time < settings.stop {
                // The model has ended the run.
                break;
            }
        }
        let (time, state) = last.unwrap_or((settings.stop, 0));
        let name = program.component(state).map_or("", |v| program.name(v));
        let cause = RunCause::NotSettled { time, state: name.to_owned() };
        Err(Failure::numerics(time, Diagnostic::new(cause, Span::NONE)))
    }

    /// Where all derivatives are zero, searched from the start of a run.
    pub fn solved(program: &'p Program, settings: &Settings) -> Result<Self, Failure> {
        let (mut point, clocks) = OperatingPoint::start(program, settings)?;
        point.evaluate()?;
        for _ in 0..MAX_SWITCHES {
            if let Err(state) = point.solve()? {
                return Err(point.unsolved(state));
            }
            let before = point.relations();
            point.switch(&clocks)?;
            if point.relations() == before {
                point.evaluate()?;
                return Ok(point);
            }
        }
        Err(point.unsolved(0))
    }

    fn start(program: &'p Program, settings: &Settings) -> Result<(Self, Clocks), Failure> {
        if let Some(what) = settings.fault() {
            return Err(Failure::settings(what));
        }
        let mut system = HybridSystem::new(program);
        let time = settings.start;
        let started = initialise(&mut system.machine, settings);
        let (clocks, ..) = started.map_err(|e| start_failure(&system.machine, e, time))?;
        let mut y = vec![0.0; program.order().max(1)];
        y[..program.order()].copy_from_slice(system.machine.states());
        Ok((OperatingPoint { system, time, y }, clocks))
    }

    /// Evaluates all variables, with relations held.
    pub fn evaluate(&mut self) -> Result<(), Failure> {
        let evaluated = self.system.evaluate_all(self.time, &self.y);
        evaluated.map_err(|f| of_fault(&self.system.machine, f, self.time))
    }

    /// Lets relations and discrete variables follow the states.
    fn switch(&mut self, clocks: &Clocks) -> Result<(), Failure> {
        let program = self.system.machine.program;
        self.system.machine.set_point(self.time, &self.y[..program.order()]);
        let iterated = iterate(&mut self.system.machine, clocks, true);
        iterated.map_err(|e| start_failure(&self.system.machine, e.into(), self.time))?;
        self.y[..program.order()].copy_from_slice(self.system.machine.states());
        Ok(())
    }

    /// The held values of all relations.
    fn relations(&self) -> Vec<f64> {
        let program = self.system.machine.program;
        let first = program.layout.relations as usize;
        self.system.machine.memory[first..first + program.events.relation_triggers.len()].to_vec()
    }

    /// The sizes that changes of the states are compared with.
    fn sizes(&self) -> Vec<f64> {
        let machine = &self.system.machine;
        let size = |(k, y): (usize, &f64)| {
            let nominal = machine.program.layout.nominals.get(k).map_or(1.0, |s| machine.get(*s));
            let nominal = nominal.abs();
            y.abs().max(if nominal > 0.0 && nominal.is_finite() { nominal } else { 1.0 })
        };
        self.y.iter().enumerate().map(size).collect()
    }

    /// The derivatives, and the inverse of their matrix, in units of the sizes of the states.
    fn linear(&mut self, sizes: &[f64]) -> Result<(Vec<f64>, Option<PseudoInverse>), Failure> {
        let n = self.y.len();
        let time = self.time;
        let failed = |system: &HybridSystem<'p>| {
            let fault = system.machine.fault;
            fault.map_or_else(
                || Failure::bug(time, "the derivatives cannot be evaluated"),
                |fault| of_fault(&system.machine, fault, time),
            )
        };
        let (mut rates, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
        if self.system.rhs(time, &self.y, &mut rates).is_err() {
            return Err(failed(&self.system));
        }
        if self.system.jacobian(time, &self.y, &mut matrix).is_err() {
            return Err(failed(&self.system));
        }
        for k in 0..self.system.machine.program.order() {
            // How long a model has been at rest is no motion.
            if self.counts_time(k, rates[k]) {
                rates[k] = 0.0;
                (0..n).for_each(|j| (matrix[k + n * j], matrix[j + n * k]) = (0.0, 0.0));
            }
        }
        for (k, rate) in rates.iter_mut().enumerate() {
            *rate /= sizes[k];
        }
        for j in 0..n {
            for i in 0..n {
                matrix[i + n * j] *= sizes[j] / sizes[i];
            }
        }
        // Rows of equal size: rates in 1/s differ by orders of magnitude between fast and slow states.
        for i in 0..n {
            let row = (0..n).map(|j| matrix[i + n * j].abs()).fold(0.0, f64::max);
            if row > 0.0 {
                rates[i] /= row;
                (0..n).for_each(|j| matrix[i + n * j] /= row);
            }
        }
        let inverse = PseudoInverse::new(n, &matrix);
        Ok((rates, inverse))
    }

    /// A state that counts the time, s, as since the last motion of a body that sticks.
    fn counts_time(&self, state: usize, rate: f64) -> bool {
        let program = self.system.machine.program;
        let unit = |v: VarId| program.blocks.dae.variables[v].unit.as_str() == "s";
        rate == 1.0 && program.component(state).is_some_and(unit)
    }

    /// Newton's correction in units of `sizes`; the position of a state that it cannot bring to rest, if there is one.
    fn correction(&mut self, sizes: &[f64]) -> Result<(Vec<f64>, Option<usize>), Failure> {
        let (mut step, inverse) = self.linear(sizes)?;
        let fastest = largest(&step);
        step.iter_mut().for_each(|x| *x = -*x);
        let solvable = inverse.is_some_and(|inverse| inverse.solve_in_place(&mut step));
        Ok((step, (!solvable).then_some(fastest)))
    }

    /// Solves for derivatives of zero, with relations held. The inner error is the position of a state that moves on.
    fn solve(&mut self) -> Result<Result<(), usize>, Failure> {
        if self.system.machine.program.order() == 0 {
            return Ok(Ok(()));
        }
        for _ in 0..MAX_CORRECTIONS {
            let sizes = self.sizes();
            let (rates, inverse) = self.linear(&sizes)?;
            let Some(inverse) = inverse else { return Ok(Err(largest(&rates))) };
            let mut step: Vec<f64> = rates.iter().map(|x| -x).collect();
            let solvable = inverse.solve_in_place(&mut step);
            let size = norm(&step);
            if size <= CONVERGED {
                self.displace(&step, &sizes, 1.0);
                return Ok(if solvable { Ok(()) } else { Err(largest(&rates)) });
            }
            let start = self.y.clone();
            let mut damping = 1.0;
            loop {
                self.displace(&step, &sizes, damping);
                let next = match self.linear(&sizes) {
                    Ok((rates, _)) => {
                        let mut next: Vec<f64> = rates.iter().map(|x| -x).collect();
                        inverse.solve_in_place(&mut next);
                        norm(&next)
                    }
                    Err(_) => f64::INFINITY,
                };
                if next <= (1.0 - 0.25 * damping) * size {
                    break;
                }
                if size <= ACCEPTED && solvable {
                    self.y = start;
                    return Ok(Ok(()));
                }
                damping *= 0.5;
                self.y.clone_from(&start);
                if damping < MIN_DAMPING {
                    return Ok(Err(largest(&step)));
                }
            }
        }
        Ok(Err(0))
    }

    fn displace(&mut self, step: &[f64], sizes: &[f64], part: f64) {
        for ((y, step), size) in self.y.iter_mut().zip(step).zip(sizes) {
            *y += part * step * size;
        }
    }

    /// Makes the point exact if the model rests there, after the time `elapsed`; otherwise the position of a state that
    /// moves.
    fn rests(&mut self, elapsed: f64) -> Result<Option<usize>, Failure> {
        let n = self.system.machine.program.order();
        if self.system.sliding.is_some() {
            return Ok(Some(0));
        }
        let sizes = self.sizes();
        let (step, moving) = self.correction(&sizes)?;
        if moving.is_some() || norm(&step) > AT_REST {
            return Ok(Some(moving.unwrap_or_else(|| largest(&step)).min(n.saturating_sub(1))));
        }
        let arrived = self.y.clone();
        let is_solved =
            matches!(self.solve(), Ok(Ok(()))) && norm_between(&arrived, self) <= AT_REST;
        if !is_solved || self.evaluate().is_err() || self.switches() {
            // At a border that rounding would cross, the point of the run is as good.
            self.y = arrived;
            self.evaluate()?;
        }
        let time = self.time;
        for factor in LATER {
            self.time = time + (factor - 1.0) * elapsed;
            let later = self.correction(&sizes);
            self.time = time;
            let (step, moving) = later?;
            if moving.is_some() || norm(&step) > AT_REST {
                let moving = moving.unwrap_or_else(|| largest(&step));
                return Ok(Some(moving.min(n.saturating_sub(1))));
            }
        }
        self.evaluate()?;
        Ok(self.unstable())
    }

    /// A relation would change here.
    fn switches(&self) -> bool {
        let machine = &self.system.machine;
        let layout = &machine.program.layout;
        let count = machine.program.events.relation_triggers.len() as u32;
        (0..count).any(|k| machine.get(layout.candidates + k) != machine.get(layout.relations + k))
    }

    /// The position of the first state, if small deviations grow: a run passes such a point, and only seems to rest.
    fn unstable(&mut self) -> Option<usize> {
        let n = self.system.machine.program.order();
        let mut matrix = vec![0.0; n * n];
        if n == 0 || self.system.jacobian(self.time, &self.y, &mut matrix).is_err() {
            return None;
        }
        let outcome = self.evaluate();
        let found = eigenvalues(n, &matrix)?;
        let size = found.iter().map(|x| x.abs()).fold(0.0, f64::max);
        let grows = found.first().is_some_and(|x| x.re > 1e-9 * size);
        (outcome.is_err() || grows).then_some(0)
    }

    fn unsolved(&self, state: usize) -> Failure {
        let program = self.system.machine.program;
        let name = program.component(state).map_or("", |v| program.name(v)).to_owned();
        let cause = RunCause::NoSteadyState { time: self.time, state: name };
        Failure::numerics(self.time, Diagnostic::new(cause, Span::NONE))
    }
}

/// The largest relative distance of the states from others.
fn norm_between(other: &[f64], point: &OperatingPoint<'_>) -> f64 {
    let sizes = point.sizes();
    let all = point.y.iter().zip(other).zip(&sizes);
    all.map(|((a, b), size)| (a - b).abs() / size).fold(0.0, f64::max)
}

fn norm(x: &[f64]) -> f64 {
    // A NaN must count as large.
    x.iter().fold(0.0, |m: f64, x| if x.is_nan() { f64::INFINITY } else { m.max(x.abs()) })
}

fn largest(x: &[f64]) -> usize {
    (0..x.len()).max_by(|a, b| x[*a].abs().total_cmp(&x[*b].abs())).unwrap_or(0)
}

fn is_exhausted(failure: &Failure) -> bool {
    failure.diagnostic.is(|cause| matches!(cause, RunCause::TooManySteps { .. }))
}

/// Keeps nothing.
struct Ignore;

impl Sink for Ignore {
    fn begin(&mut self, _: Vec<Column>) {}
    fn wants_constants(&self) -> bool {
        false
    }
    fn row(&mut self, _: f64, _: &[f64]) {}
    fn event(&mut self, _: Event) {}
}
