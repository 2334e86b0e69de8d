//! The simulation loop: step, locate events, record, execute events.

use std::time::{Duration, Instant};

use crate::base::activity;
use crate::base::diag::Diagnostic;
use crate::base::source::{SourceMap, Span};
use crate::integrate::outcome::Step;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::JacobianMemory;
use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::ir::trajectory::Trajectory;

use super::bound_warnings::BoundWarnings;
use super::cause::RunCause;
use super::columns::constants;
use super::event::chattering::EventHistory;
use super::event::duplicate_event::DuplicateFilter;
use super::event::instant::Cause;
use super::event::locate::Locator;
use super::event::time_events::Clocks;
use super::event::zeno::{Accumulation, Bounces};
use super::extrema::ExtremaSearch;
use super::failure::non_finite::relation_text;
use super::failure::{Failure, FailureKind, of_fault, of_integration, start_failure};
use super::initialization::{Start, StartError, initialise};
use super::integers::integers;
use super::method::{Choice, Integrator};
use super::options::options;
use super::record::{Recorder, Sink, begin};
use super::rows::has_own_rows;
use super::sensitivity::{Input, Sensitivity, with_inputs};
use super::settings::Settings;
use super::slow_progress::ProgressWatch;
use super::state_selection::StateSelector;
use super::system::{HybridSystem, is_domain_fault};
use super::time_features::TimeFeatures;
use crate::integrate::system::System;
use crate::runtime::machine::Fault;

/// First shift beyond the end of a solution branch, as a fraction of the run.
const FIRST_BRANCH_SHIFT: f64 = 1e-12;

/// Number of shifts, each ten times the previous one.
const MAX_BRANCH_SHIFTS: i32 = 7;

/// Minimum limit of a step by histories, as a fraction of the run. A longer step extrapolates a
/// history along its last slope.
const MIN_STEP_FRACTION: f64 = 1e-4;

/// Maximum number of initializations until the initial values of histories are consistent.
const MAX_HISTORY_ITERATIONS: usize = 30;

/// Statistics of a run.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Statistics {
    /// Counters of the integrator.
    pub integration: Stats,
    /// The integration method.
    pub method: Choice,
    /// Number of events triggered by state-dependent relations.
    pub state_events: u64,
    /// Number of time events: comparisons with time, and clocks.
    pub time_events: u64,
    /// Number of changes of the selected states.
    pub selections: u64,
    /// Rows recorded.
    pub rows: u64,
    /// Elapsed wall-clock time.
    pub elapsed: Duration,
    /// End of the run, s; before the stop time if the model terminated it.
    pub end: f64,
    /// Message of the `terminate` that ended it.
    pub terminated: Option<String>,
    /// The sink ended it.
    pub interrupted: bool,
    /// Violated assertions of level warning, each once.
    pub warnings: Vec<Diagnostic>,
    /// The requested extrema; `None` if the condition of the request was never true.
    pub extrema: Vec<Option<f64>>,
    /// The time of each, s.
    pub extremum_times: Vec<f64>,
    /// The inputs by which a differentiated run has no derivatives, by position: they act on an FMU in the model.
    pub hidden: Vec<usize>,
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// All rows and events.
    pub trajectory: Trajectory,
    /// Its statistics.
    pub statistics: Statistics,
}

/// Runs a program and returns the whole trajectory. `sources` gives the source positions of events.
pub fn simulate(
    program: &Program,
    settings: &Settings,
    sources: &SourceMap,
) -> Result<Run, Failure> {
    let mut trajectory = Trajectory::default();
    let statistics = simulate_to(program, settings, sources, &mut trajectory)?;
    Ok(Run { trajectory, statistics })
}

/// Runs a program and passes each row and event to `sink` immediately; everything passed before a
/// failure is valid.
pub fn simulate_to(
    program: &Program,
    settings: &Settings,
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    run_to(program, settings, &[], sources, sink)
}

/// As [`simulate_to`], with the derivatives of each row with respect to `inputs`
/// ([`Sink::slopes`]). They are exact across events and during sliding. Fails if an input acts on an FMU in the model,
/// through which derivatives cannot be followed.
pub fn simulate_with_sensitivities(
    program: &Program,
    settings: &Settings,
    inputs: &[Input],
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    let statistics = simulate_with_known_sensitivities(program, settings, inputs, sources, sink)?;
    if statistics.hidden.is_empty() {
        return Ok(statistics);
    }
    Err(without_sensitivities(settings.start, "a parameter acts on an FMU in the model"))
}

/// True if a program reads past values that only a run can know.
fn has_histories(program: &Program, settings: &Settings) -> bool {
    let layout = &program.layout;
    let is_driven = |input| settings.courses.iter().any(|(v, _)| *v == input);
    let mut delays = layout.delays.iter();
    !(layout.transports.is_empty() && delays.all(|d| d.input.is_some_and(is_driven)))
}

fn without_sensitivities(time: f64, why: &'static str) -> Failure {
    Failure::numerics(time, Diagnostic::new(RunCause::NoSensitivities { time, why }, Span::NONE))
}

/// As [`simulate_with_sensitivities`], but [`Statistics::hidden`] lists the inputs by which the derivatives of the rows
/// mean nothing.
pub fn simulate_with_known_sensitivities(
    program: &Program,
    settings: &Settings,
    inputs: &[Input],
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    if !program.algebraics.is_empty() {
        return Err(Failure::settings(
            "a run can be differentiated only in the reduced mode: this program leaves algebraic loops to the integrator"
                .to_owned(),
        ));
    }
    if has_histories(program, settings) {
        let why = "the model delays a computed variable";
        return Err(without_sensitivities(settings.start, why));
    }
    let Some(settings) = with_inputs(program, settings, inputs) else {
        return Err(Failure::settings(
            "sensitivities exist only with respect to inputs: parameters and start values that are not constants"
                .to_owned(),
        ));
    };
    run_to(program, &settings, inputs, sources, sink)
}

fn run_to(
    program: &Program,
    settings: &Settings,
    inputs: &[Input],
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    if let Some(what) = settings.fault() {
        return Err(Failure::settings(what));
    }
    let started = Instant::now();
    activity::note(format!("simulating at time {} s", settings.start));
    if let Some(foreign) = &program.foreign {
        return super::foreign::run_to(foreign, program, settings, inputs, sink);
    }
    // Of a failure of an earlier run nobody wants to know.
    let _ = external_failure(program);
    let begun = Simulation::begin(program, settings, inputs, sources, sink);
    let mut simulation = begun.map_err(|failure| with_external(program, failure))?;
    let outcome = simulation.run().map_err(|failure| with_external(program, failure));
    program.externals().all().iter().for_each(|f| f.release());
    simulation.recorder.flush(simulation.sink);
    simulation.sink.end();
    outcome?;
    simulation.warn_of_unresolved_relations();
    let mut statistics = simulation.statistics;
    statistics.integration = *simulation.stepper.stats();
    statistics.method = simulation.stepper.describe(statistics.method);
    statistics.extrema = simulation.extrema.found();
    statistics.extremum_times = simulation.extrema.times();
    statistics.hidden = simulation.sensitivity.as_ref().map_or_else(Vec::new, |s| s.hidden());
    statistics.elapsed = started.elapsed();
    Ok(statistics)
}

/// Why an external function gave no number on this thread.
fn external_failure(program: &Program) -> Option<Box<Diagnostic>> {
    program.externals().all().iter().find_map(|f| f.take_failure())
}

/// A failure, or that of the external function behind it.
fn with_external(program: &Program, failure: Failure) -> Failure {
    match external_failure(program) {
        Some(diagnostic) => Failure { kind: FailureKind::Numerics, diagnostic, ..failure },
        None => failure,
    }
}

/// Runs a program to its end; returns the system there, the instant, s, and the states.
pub(super) fn arrive<'p>(
    program: &'p Program,
    settings: &Settings,
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<(HybridSystem<'p>, f64, Vec<f64>), Failure> {
    if let Some(what) = settings.fault() {
        return Err(Failure::settings(what));
    }
    if program.foreign.is_some() {
        return Err(Failure::settings("an FMU cannot be linearized".to_owned()));
    }
    let mut simulation = Simulation::begin(program, settings, &[], sources, sink)?;
    simulation.run()?;
    if simulation.stepper.t() == simulation.t {
        simulation.y.copy_from_slice(simulation.stepper.y());
    }
    Ok((simulation.system, simulation.t, simulation.y))
}

/// What is due after a step.
#[derive(Clone, Copy)]
pub(crate) enum Due {
    /// An event at this instant, s.
    Event(f64, Cause),
    /// The end of a smooth piece of an input or a history at this instant, and whether a clock ticks there.
    Breakpoint(f64, bool),
    /// The step is complete at this instant.
    Nothing(f64),
}

/// A run in progress.
pub struct Simulation<'p, 's> {
    pub(super) program: &'p Program,
    pub(super) sources: &'s SourceMap,
    pub(super) sink: &'s mut dyn Sink,
    pub(super) system: HybridSystem<'p>,
    pub(super) stepper: Integrator,
    pub(super) clocks: Clocks,
    pub(super) selection: StateSelector,
    pub(super) locator: Locator,
    pub(super) time_features: TimeFeatures<'p>,
    pub(super) recorder: Recorder,
    pub(super) statistics: Statistics,
    pub(super) start: f64,
    pub(super) stop: f64,
    /// Relative error that is allowed.
    pub(super) tolerance: f64,
    /// Memory for the delayed expressions within a step.
    pub(super) history_samples: Vec<f64>,
    /// No step goes beyond this instant, s; infinite unless the run is advanced from outside.
    pub(super) limit: f64,
    pub(super) t: f64,
    pub(super) y: Vec<f64>,
    pub(super) reported_asserts: Vec<bool>,
    pub(super) bound_warnings: BoundWarnings,
    pub(super) relation_texts: Vec<Option<String>>,
    pub(super) history: EventHistory,
    /// An accumulation of events that has not been resolved yet.
    pub(super) accumulation: Option<Accumulation>,
    /// For each relation, its events that may be bounces.
    pub(super) bounces: Vec<Bounces>,
    pub(super) duplicates: DuplicateFilter,
    pub(super) progress: ProgressWatch,
    /// Integer variables with their slots.
    pub(super) integers: Vec<(VarId, Slot)>,
    pub(super) ended: bool,
    pub(super) extrema: ExtremaSearch,
    pub(super) sensitivity: Option<Box<Sensitivity>>,
    /// Rows between steps need no full evaluation.
    pub(super) has_own_rows: bool,
}

impl<'p, 's> Simulation<'p, 's> {
    pub(super) fn begin(
        program: &'p Program,
        settings: &Settings,
        inputs: &[Input],
        sources: &'s SourceMap,
        sink: &'s mut dyn Sink,
    ) -> Result<Self, Failure> {
        let mut system = HybridSystem::new(program);
        system.machine.set_execution(&settings.execution);
        let t = settings.start;
        let mut sensitivity = None;
        if !inputs.is_empty() {
            sensitivity = Sensitivity::new(&system, inputs).map(Box::new);
        }
        if let Some(s) = &mut sensitivity {
            s.attach(&mut system.machine);
        }
        let started = initialise_with_histories(&mut system, settings);
        if let Some(s) = &mut sensitivity {
            s.detach(&mut system.machine);
            s.restart_from_memory(program, t);
        }
        let (clocks, selection, effects) =
            started.map_err(|e| start_failure(&system.machine, e, t))?;
        let n = program.order().max(1);
        let mut y = vec![0.0; n];
        y[..program.order()].copy_from_slice(system.machine.states());
        let time_features = TimeFeatures::new(&mut system.machine, settings);
        let (wanted, options) = (settings.method, options(&system, settings, &time_features));
        let integrator = Integrator::new(wanted, program, sensitivity.is_some(), &system, options);
        let (stepper, method) = integrator.map_err(|e| Failure::settings(e.to_string()))?;
        let mut recorder = Recorder::new(program, settings);
        let spacing = settings.spacing.unwrap_or(settings.interval);
        begin(program, sink);
        recorder.announce_storage(program, sink);
        sink.expect(recorder.expected_rows());
        if sink.wants_constants() {
            sink.constants(constants(&system.machine));
        }
        let has_own_rows = has_own_rows(&system, settings);
        let mut simulation = Simulation {
            program,
            sources,
            sink,
            system,
            stepper,
            clocks,
            selection,
            locator: Locator::new(program),
            time_features,
            recorder,
            statistics: Statistics { method, ..Statistics::default() },
            start: settings.start,
            stop: settings.stop,
            tolerance: settings.tolerance,
            history_samples: Vec::new(),
            limit: f64::INFINITY,
            t,
            y,
            reported_asserts: vec![false; program.events.asserts.len()],
            bound_warnings: BoundWarnings::new(program, settings.tolerance),
            relation_texts: vec![None; program.events.relation_triggers.len()],
            history: EventHistory::new(settings.stop - settings.start),
            accumulation: None,
            bounces: vec![Bounces::default(); program.events.relation_triggers.len()],
            duplicates: DuplicateFilter::new(settings.stop - settings.start),
            progress: ProgressWatch::new(settings.start),
            integers: integers(program),
            ended: false,
            extrema: ExtremaSearch::new(program, &settings.extrema, t, spacing),
            sensitivity,
            has_own_rows,
        };
        simulation.record(t)?;
        simulation.bound_warnings.drop_parameters(program);
        simulation.warn_of_undetermined(t);
        simulation.recorder.flush_first(simulation.sink);
        simulation.check_integers(t)?;
        simulation.check_assertions(t)?;
        simulation.handle_effects(effects, t)?;
        Ok(simulation)
    }

    fn run(&mut self) -> Result<(), Failure> {
        self.restart()?;
        while self.t < self.stop && !self.ended {
            if !self.sink.goes_on(self.t) {
                self.statistics.interrupted = true;
                self.ended = true;
                break;
            }
            let due = self.step_once()?;
            self.conclude(due)?;
        }
        self.statistics.end = self.t;
        let ends_by_itself = !self.statistics.interrupted;
        // What follows reads variables that are not recorded.
        self.complete_memory()?;
        if self.program.events.reads_terminal && ends_by_itself {
            self.terminal_event()
        } else {
            Ok(())
        }
    }

    /// One accepted step of the integrator; what is due within it or at its end.
    pub(crate) fn step_once(&mut self) -> Result<Due, Failure> {
        let instant = self.clocks.next_instant(&self.system.machine, self.t);
        let machine = &self.system.machine;
        let delayed = machine.delays.next_breakpoint(&machine.memory);
        let breakpoint = machine.input_signals.next_breakpoint(&machine.memory).min(delayed);
        let history_limit = self.t
            + machine
                .transports
                .max_step(&machine.memory)
                .max(MIN_STEP_FRACTION * (self.stop - self.start));
        let t_stop = instant.min(breakpoint).min(self.stop).min(self.limit).min(history_limit);
        let (machine, event) = (&self.system.machine, instant.min(self.stop));
        let t_stop = self.time_features.end_of_step(machine, self.t, t_stop, event);
        let mut reached = self.step(t_stop)?;
        let mut switched = self.first_switch()?;
        if self.system.left_domain && switched.is_none() && self.has_left_the_domain() {
            // The step left the domain without an event: repeat it without clamping.
            self.stepper.interpolate(self.t, &mut self.y);
            if let Some(s) = &mut self.sensitivity {
                s.restart(self.t);
            }
            self.system.strict = true;
            let repeated = self.restart().and_then(|()| self.step(t_stop));
            self.system.strict = false;
            reached = repeated?;
            switched = self.first_switch()?;
        }
        Ok(match switched {
            Some(at) => Due::Event(at, Cause::State),
            None if reached && t_stop == breakpoint => Due::Breakpoint(t_stop, t_stop == instant),
            None if reached && t_stop == instant => Due::Event(t_stop, Cause::Time),
            None => Due::Nothing(self.stepper.t()),
        })
    }

    /// Executes what is due after a step.
    pub(crate) fn conclude(&mut self, due: Due) -> Result<(), Failure> {
        match due {
            Due::Event(at, cause) => self.event(at, cause),
            Due::Breakpoint(t, ticks) => self.breakpoint(t, ticks),
            Due::Nothing(t) => {
                if self.end_of_sliding()?.is_some() {
                    return Ok(());
                }
                if self.system.machine.records_history() {
                    self.record_history(t, false)?;
                }
                self.complete_step(t)?;
                if self.reselect_after_step()? {
                    self.restart()?;
                }
                Ok(())
            }
        }
    }

    /// Warns of relations that may have changed unseen, and of oscillations that no step followed.
    fn warn_of_unresolved_relations(&mut self) {
        let found: Vec<u32> = self.locator.unresolved().collect();
        for k in found {
            let relation = relation_text(self.program, k);
            let cause = RunCause::UnresolvedRelation { relation };
            let span = self.relation_span(k);
            self.statistics.warnings.push(Diagnostic::new(cause, span));
        }
        if let Some(periods) = self.time_features.unresolved_periods {
            let cause = RunCause::UnresolvedOscillation { periods };
            self.statistics.warnings.push(Diagnostic::new(cause, Span::NONE));
        }
    }

    /// Checks and records the step that ends at `t` without an event, and advances to `t`.
    fn complete_step(&mut self, t: f64) -> Result<(), Failure> {
        self.locator.on_step(&self.system.machine);
        self.note_turns()?;
        self.check_accumulation()?;
        self.warn_of_undetermined(t);
        // An assertion violated at the end may have been violated at an earlier row.
        let at_end = self.check_assertions_of_step();
        self.advance_sensitivities()?;
        self.record_grid(t, true)?;
        at_end?;
        self.t = t;
        self.watch_progress(t)
    }

    /// Advances past a breakpoint of an input signal. It is an event only if a value or rate jumps, or
    /// if a clock `ticks` at the same instant; whatever is sampled there sees the value after the jump.
    /// So is a jump of a discrete input, and one that arrives with a delay, whose instant depends on a parameter.
    fn breakpoint(&mut self, t: f64, ticks: bool) -> Result<(), Failure> {
        let machine = &self.system.machine;
        let arrives = machine.input_signals.delay_of_jump(t, &machine.memory).is_some();
        let steps = machine.input_signals.has_event(t, &machine.memory);
        if arrives || steps || machine.delays.next_breakpoint(&machine.memory) <= t {
            return self.event(t, Cause::Time);
        }
        self.record_history(t, false)?;
        self.complete_step(t)?;
        let machine = &mut self.system.machine;
        let slopes_jump = machine.input_signals.has_delayed_breakpoint(t, &machine.memory);
        let jumps = machine.input_signals.advance_past(t, &machine.memory);
        if ticks || (jumps && !self.program.events.relation_triggers.is_empty()) {
            self.event(t, Cause::Time)?;
        } else if jumps {
            self.record_history(t, true)?;
            self.evaluate_at(t)?;
            if let Some(s) = &mut self.sensitivity {
                s.restart(t);
            }
            self.restart()?;
        } else {
            self.stepper.pass_kink();
            if let Some(s) = &mut self.sensitivity {
                match slopes_jump {
                    true => s.restart(t),
                    false => s.pass_kink(),
                }
            }
        }
        if jumps && self.recorder.has_row_at(t) {
            self.record(t)?;
        }
        Ok(())
    }

    fn first_switch(&mut self) -> Result<Option<f64>, Failure> {
        let switched = self.locator.first_switch(&mut self.system, &*self.stepper);
        switched.map_err(|f| of_fault(&self.system.machine, f, self.stepper.t()))
    }

    fn has_left_the_domain(&mut self) -> bool {
        let left = !self.system.is_in_domain(self.stepper.t(), self.stepper.y());
        self.system.machine.fault = None;
        left
    }

    /// One accepted step; true if it ends at `t_stop`.
    fn step(&mut self, t_stop: f64) -> Result<bool, Failure> {
        self.system.left_domain = false;
        self.system.machine.branch_switch = false;
        self.system.machine.undetermined = None;
        let mut outcome = self.stepper.step(&mut self.system, t_stop);
        if outcome.is_err() && self.lost_a_branch() {
            let saved = self.system.machine.save_fault();
            match self.switch_branch(t_stop) {
                Some(switched) => {
                    self.system.machine.discard_fault(saved);
                    outcome = switched;
                }
                // Report the first failure.
                None => self.system.machine.restore_fault(saved),
            }
        }
        self.system.machine.branch_switch = true;
        let step =
            outcome.map_err(|e| of_integration(&self.system.machine, e, self.stepper.t()))?;
        // Faults that a shorter step avoided do not count.
        self.system.machine.fault = None;
        Ok(matches!(step, Step::Reached { .. }))
    }

    /// True if an algebraic loop has no solution near the last one.
    fn lost_a_branch(&self) -> bool {
        matches!(
            self.system.machine.fault,
            Some(Fault::Diverged { .. } | Fault::Singular { .. } | Fault::NotFinite { .. })
        )
    }

    /// A step that starts on another solution branch of an algebraic loop, just beyond the end of
    /// the current one; `None` if there is no such branch.
    fn switch_branch(
        &mut self,
        t_stop: f64,
    ) -> Option<Result<Step, crate::integrate::outcome::Failure>> {
        let (t, y) = (self.stepper.t(), self.stepper.y().to_vec());
        // The slope of the last step: derivatives may not exist at its end.
        let before = self.stepper.t_previous();
        let mut slope = y.clone();
        self.stepper.interpolate(before, &mut slope);
        for (slope, y) in slope.iter_mut().zip(&y) {
            *slope = if t > before { (y - *slope) / (t - before) } else { 0.0 };
        }
        let mut shifted = y.clone();
        for k in 0..MAX_BRANCH_SHIFTS {
            let shift = (self.stop - self.start) * FIRST_BRANCH_SHIFT * 10.0_f64.powi(k);
            let beyond = t + shift;
            if beyond >= t_stop {
                return None;
            }
            // Extrapolate the states beyond the end of the branch.
            for ((m, y), slope) in shifted.iter_mut().zip(&y).zip(&slope) {
                *m = y + shift * slope;
            }
            self.system.machine.branch_switch = true;
            let found = self.system.rhs(beyond, &shifted, &mut vec![0.0; y.len()]).is_ok();
            self.system.machine.branch_switch = false;
            self.system.machine.fault = None;
            if !found {
                continue;
            }
            let jacobian = JacobianMemory::Forget;
            if self.stepper.restart(&mut self.system, beyond, &shifted, jacobian).is_err() {
                continue;
            }
            let step = self.stepper.step(&mut self.system, t_stop);
            if step.is_ok() {
                self.t = beyond;
                return Some(step);
            }
        }
        None
    }

    pub(super) fn restart(&mut self) -> Result<(), Failure> {
        self.locator.forget_samples();
        self.time_features.after_event();
        let started =
            self.stepper.restart(&mut self.system, self.t, &self.y, JacobianMemory::Forget);
        started.map_err(|e| of_integration(&self.system.machine, e, self.t))
    }

    /// Updates the state selection at the end of a step; true if it changed.
    fn reselect_after_step(&mut self) -> Result<bool, Failure> {
        if self.selection.is_empty() {
            return Ok(false);
        }
        let t = self.stepper.t();
        self.evaluate_at(t)?;
        self.reselect_states(t)
    }

    /// Updates the state selection at the point in the memory; true if it changed.
    pub(super) fn reselect_states(&mut self, t: f64) -> Result<bool, Failure> {
        self.evaluate_sensitivities(t)?;
        if let Some(s) = &mut self.sensitivity {
            s.attach(&mut self.system.machine);
        }
        let renewed = self.selection.update(&mut self.system.machine);
        if let Some(s) = &mut self.sensitivity {
            s.detach(&mut self.system.machine);
        }
        let changed = renewed.map_err(|f| of_fault(&self.system.machine, f, self.t))?;
        if changed {
            self.statistics.selections += 1;
            self.y.copy_from_slice(self.system.machine.states());
            if let Some(s) = &mut self.sensitivity {
                s.restart_from_memory(self.program, t);
            }
        }
        Ok(changed)
    }

    /// Takes the states at an instant of the last step.
    pub(super) fn interpolate(&mut self, t: f64) {
        if t == self.stepper.t() {
            self.y.copy_from_slice(self.stepper.y());
        } else {
            self.stepper.interpolate(t, &mut self.y);
        }
    }

    /// Evaluates all variables at an instant of the last step, with relations held.
    pub(super) fn evaluate_at(&mut self, t: f64) -> Result<(), Failure> {
        self.interpolate(t);
        let mut evaluated = self.system.evaluate_all(t, &self.y);
        if evaluated.is_err_and(is_domain_fault) && self.system.left_domain {
            evaluated = self.system.evaluate_all_clamped(t, &self.y);
        }
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))
    }

    pub(super) fn relation_text(&mut self, k: u32) -> String {
        let program = self.program;
        self.relation_texts[k as usize].get_or_insert_with(|| relation_text(program, k)).clone()
    }

    pub(super) fn relation_span(&self, k: u32) -> Span {
        self.program.blocks.dae.relations[k as usize].origin.span
    }

    pub(super) fn place(&self, span: Span) -> String {
        self.sources.place(span).unwrap_or_default()
    }
}

/// Initializes all variables, and the histories of delayed variables with their initial values.
pub fn initialise_with_histories(
    system: &mut HybridSystem<'_>,
    settings: &Settings,
) -> Result<Start, StartError> {
    let mut started = initialise(&mut system.machine, settings)?;
    let mut unsettled = None;
    for _ in 0..MAX_HISTORY_ITERATIONS {
        if !system.machine.has_history() {
            break;
        }
        let is_settled;
        (is_settled, unsettled) = first_values(system, settings.start);
        if is_settled {
            break;
        }
        started = initialise(&mut system.machine, settings)?;
    }
    match unsettled {
        Some(delayed) => Err(StartError::History(delayed)),
        None => Ok(started),
    }
}

/// Starts the histories of delayed variables and transport lines; whether their initial values are those that they had, and
/// a delayed variable of which they are not.
fn first_values(system: &mut HybridSystem<'_>, t: f64) -> (bool, Option<VarId>) {
    let mut y = vec![0.0; system.machine.program.order().max(1)];
    let n = system.machine.program.order();
    y[..n].copy_from_slice(system.machine.states());
    if system.evaluate_all(t, &y).is_err() {
        return (true, None);
    }
    let machine = &mut system.machine;
    let delayed = machine.delays.begin(t, &machine.memory);
    let is_moved = machine.transports.begin(t, &mut machine.memory);
    (!is_moved && delayed.is_none(), delayed)
}
