//! The loop: step, look for events, record, settle, go on.

use std::time::{Duration, Instant};

use crate::base::diag::Diagnostic;
use crate::base::source::{SourceMap, Span};
use crate::integrate::outcome::Step;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::ir::program::{Program, Sequence};
use crate::ir::trajectory::Trajectory;

use super::bound_warnings::Limits;
use super::columns::{columns, constants};
use super::event::chattering::Recent;
use super::event::duplicate_event::Echo;
use super::event::instant::Cause;
use super::event::iterate::Search;
use super::event::time_events::Clocks;
use super::event::zeno::Pile;
use super::extrema::Extremes;
use super::failure::non_finite::{Reader, relation_text};
use super::failure::{Failure, no_start, of_fault, of_integration};
use super::initialization::initialise;
use super::method::{Choice, Integrator};
use super::options::options;
use super::record::{Recorder, Sink};
use super::sensitivity::{Input, Sensitivity, with_inputs};
use super::settings::Settings;
use super::state_selection::Selection;
use super::system::{Model, of_domain};
use crate::integrate::system::System;
use crate::runtime::machine::Fault;

/// How far beyond the end of a branch another one is looked for first, as a part of the run.
const FIRST_LEAP: f64 = 1e-12;

/// How often that distance grows tenfold.
const LEAPS: i32 = 7;

/// Points of each step that the history of a delayed expression keeps.
const POINTS: u32 = 5;

/// Part of a run that a step may last at least, though it reads what is only coming: beyond what is known
/// the course goes on along its last slope.
const LEAST_LOOK: f64 = 1e-4;

/// How often the start is computed until what is delayed begins as it is.
const FIRST_LOOKS: usize = 5;

/// What a run cost.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Statistics {
    /// Work of the integrator.
    pub integration: Stats,
    /// Which integrator that was.
    pub method: Choice,
    /// Instants at which a relation on the trajectory switched.
    pub state_events: u64,
    /// Instants known in advance: comparisons with time, and clocks.
    pub time_events: u64,
    /// How often other variables became states.
    pub selections: u64,
    /// Rows recorded.
    pub rows: u64,
    /// Time spent.
    pub elapsed: Duration,
    /// Where the run ended, s: before the stop if the model terminated it.
    pub end: f64,
    /// The text of the `terminate` that ended it.
    pub terminated: Option<String>,
    /// The sink ended it.
    pub interrupted: bool,
    /// Assertions of level warning that were violated, each once.
    pub warnings: Vec<Diagnostic>,
    /// The extreme values that were wanted; none where the variable never counted.
    pub extremes: Vec<Option<f64>>,
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// All rows and events.
    pub trajectory: Trajectory,
    /// What it cost.
    pub statistics: Statistics,
}

/// Runs a program and keeps the whole trajectory. `sources` gives events their place.
pub fn simulate(
    program: &Program,
    settings: &Settings,
    sources: &SourceMap,
) -> Result<Run, Failure> {
    let mut trajectory = Trajectory::default();
    let statistics = simulate_to(program, settings, sources, &mut trajectory)?;
    Ok(Run { trajectory, statistics })
}

/// Runs a program and hands each row and event to `sink` as it comes; what was handed over before a
/// failure is valid.
pub fn simulate_to(
    program: &Program,
    settings: &Settings,
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    run_to(program, settings, &[], sources, sink)
}

/// As [`simulate_to`], and after each row hands over the derivatives of its values by the inputs
/// ([`Sink::slopes`]). They are right across events, and along the surface of a relation that the
/// solution slides on.
pub fn simulate_with_sensitivities(
    program: &Program,
    settings: &Settings,
    inputs: &[Input],
    sources: &SourceMap,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    if !program.algebraics.is_empty() {
        return Err(Failure::settings(
            "a run can be differentiated in the reduced mode only: this program leaves algebraic loops to the integrator"
                .to_owned(),
        ));
    }
    if !(program.layout.delays.is_empty() && program.layout.transports.is_empty()) {
        return Err(Failure::settings(
            "a run with `delay` or `spatialDistribution` can not be differentiated yet".to_owned(),
        ));
    }
    let Some(settings) = with_inputs(program, settings, inputs) else {
        return Err(Failure::settings(
            "a run can be differentiated by its inputs only: parameters and starts that are no constants"
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
    let begun = Instant::now();
    let mut simulation = Simulation::begin(program, settings, inputs, sources, sink)?;
    let outcome = simulation.run();
    simulation.recorder.flush(simulation.sink);
    simulation.sink.end();
    outcome?;
    let mut statistics = simulation.statistics;
    statistics.integration = *simulation.stepper.stats();
    statistics.method = simulation.stepper.describe(statistics.method);
    statistics.extremes = simulation.extremes.found();
    statistics.elapsed = begun.elapsed();
    Ok(statistics)
}

/// A run under way.
pub struct Simulation<'p, 's> {
    pub(super) program: &'p Program,
    pub(super) sources: &'s SourceMap,
    pub(super) sink: &'s mut dyn Sink,
    pub(super) model: Model<'p>,
    pub(super) stepper: Integrator,
    pub(super) clocks: Clocks,
    pub(super) selection: Selection,
    pub(super) search: Search,
    pub(super) recorder: Recorder,
    pub(super) statistics: Statistics,
    pub(super) start: f64,
    pub(super) stop: f64,
    pub(super) t: f64,
    pub(super) y: Vec<f64>,
    pub(super) warned: Vec<bool>,
    pub(super) limits: Limits,
    pub(super) texts: Vec<Option<String>>,
    pub(super) recent: Recent,
    /// Where events have piled up, as long as nothing says how it goes on from there.
    pub(super) pile: Option<Pile>,
    pub(super) echo: Echo,
    pub(super) ended: bool,
    pub(super) extremes: Extremes,
    pub(super) sensitivity: Option<Box<Sensitivity>>,
}

impl<'p, 's> Simulation<'p, 's> {
    fn begin(
        program: &'p Program,
        settings: &Settings,
        inputs: &[Input],
        sources: &'s SourceMap,
        sink: &'s mut dyn Sink,
    ) -> Result<Self, Failure> {
        let mut model = Model::new(program);
        model.instance.execute(&settings.execution);
        let t = settings.start;
        let mut sensitivity = None;
        if !inputs.is_empty() {
            sensitivity = Sensitivity::new(&model, inputs).map(Box::new);
        }
        if let Some(s) = &mut sensitivity {
            s.attach(&mut model.instance);
        }
        let mut begun = initialise(&mut model.instance, settings);
        for _ in 0..FIRST_LOOKS {
            if !model.instance.looks_back() || begun.is_err() || !first_values(&mut model, t) {
                break;
            }
            begun = initialise(&mut model.instance, settings);
        }
        if let Some(s) = &mut sensitivity {
            s.detach(&mut model.instance);
            s.stand(program, t);
        }
        let (clocks, selection, settled) = begun.map_err(|e| no_start(&model.instance, e, t))?;
        let n = program.order().max(1);
        let mut y = vec![0.0; n];
        y[..program.order()].copy_from_slice(model.instance.states());
        let (wanted, options) = (settings.method, options(&model, settings));
        let integrator = Integrator::new(wanted, program, sensitivity.is_some(), &model, options);
        let (stepper, method) = integrator.map_err(|e| Failure::settings(e.to_string()))?;
        let mut recorder = Recorder::new(program, settings);
        let spacing = settings.spacing.unwrap_or(settings.interval);
        sink.begin(columns(program));
        recorder.tell_courses(program, sink);
        sink.expect(recorder.expected_rows());
        if sink.wants_constants() {
            sink.constants(constants(&model.instance));
        }
        let mut simulation = Simulation {
            program,
            sources,
            sink,
            model,
            stepper,
            clocks,
            selection,
            search: Search::new(program),
            recorder,
            statistics: Statistics { method, ..Statistics::default() },
            start: settings.start,
            stop: settings.stop,
            t,
            y,
            warned: vec![false; program.asserts.len()],
            limits: Limits::new(program, settings.tolerance),
            texts: vec![None; program.watches.len()],
            recent: Recent::new(settings.stop - settings.start),
            pile: None,
            echo: Echo::new(settings.stop - settings.start),
            ended: false,
            extremes: Extremes::new(program, &settings.extremes, t, spacing),
            sensitivity,
        };
        simulation.model.instance.undetermined = None;
        simulation.record(t)?;
        simulation.limits.settle(program);
        simulation.warn_of_undetermined(t);
        simulation.recorder.flush_first(simulation.sink);
        simulation.check_assertions(t)?;
        simulation.act_on(settled, t)?;
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
            let instant = self.clocks.next_instant(&self.model.instance, self.t);
            let instance = &self.model.instance;
            let delayed = instance.delayed.next_corner(&instance.memory);
            let corner = instance.played.next_corner().min(delayed);
            let leash = self.t
                + instance
                    .transports
                    .leash(&instance.memory)
                    .max(LEAST_LOOK * (self.stop - self.start));
            let t_stop = instant.min(corner).min(self.stop).min(leash);
            let mut reached = self.step(t_stop)?;
            let mut switched = self.first_switch()?;
            if self.model.beyond && switched.is_none() && self.has_left_the_domain() {
                // No relation would have kept the step inside: so must the step itself.
                self.stepper.interpolate(self.t, &mut self.y);
                if let Some(s) = &mut self.sensitivity {
                    s.restart(self.t);
                }
                self.model.strict = true;
                let repeated = self.restart().and_then(|()| self.step(t_stop));
                self.model.strict = false;
                reached = repeated?;
                switched = self.first_switch()?;
            }
            match switched {
                Some(at) => self.event(at, Cause::State)?,
                None if reached && t_stop == instant => self.event(t_stop, Cause::Time)?,
                None if reached && t_stop == corner => self.corner(t_stop)?,
                None if self.end_of_sliding()?.is_some() => {}
                None => {
                    let t = self.stepper.t();
                    if self.model.instance.keeps_courses() {
                        self.note_delayed(t, false)?;
                    }
                    self.complete_step(t)?;
                    if self.select()? {
                        self.restart()?;
                    }
                }
            }
        }
        self.statistics.end = self.t;
        let ends_by_itself = !self.statistics.interrupted;
        if self.program.reads_terminal && ends_by_itself { self.finish() } else { Ok(()) }
    }

    /// Adds to the histories of delayed expressions: what they are now, or the course of the last step
    /// up to `end`.
    pub(super) fn note_delayed(&mut self, end: f64, now: bool) -> Result<(), Failure> {
        if !self.model.instance.looks_back() {
            return Ok(());
        }
        let note = |model: &mut Model<'_>, t: f64, after_event: bool| {
            let instance = &mut model.instance;
            instance.delayed.note(t, &instance.memory, after_event);
            instance.transports.note(t, &instance.memory, after_event);
        };
        if now {
            let evaluated = self.model.evaluate_all(end, &self.y);
            evaluated.map_err(|f| of_fault(&self.model.instance, f, end))?;
            note(&mut self.model, end, true);
            return Ok(());
        }
        let begin = self.t.max(self.stepper.t_previous());
        // What rests between events has a course of two points.
        let points = if self.model.instance.keeps_courses() { POINTS } else { 1 };
        for k in 1..=points {
            let part = f64::from(k) / f64::from(points);
            let t = if k == points { end } else { begin + part * (end - begin) };
            self.go_to(t)?;
            note(&mut self.model, t, false);
        }
        Ok(())
    }

    /// Checks and records the step that ends at `t` without an event, and stands there.
    fn complete_step(&mut self, t: f64) -> Result<(), Failure> {
        self.search.heed(&self.model.instance);
        self.check_pile()?;
        self.warn_of_undetermined(t);
        // What fails at the end may have failed before.
        let at_end = self.check_assertions_of_step();
        self.vary()?;
        self.record_grid(t, true)?;
        at_end?;
        self.t = t;
        Ok(())
    }

    /// Goes on past a corner of what recordings say about inputs. Only what jumps there is an event.
    fn corner(&mut self, t: f64) -> Result<(), Failure> {
        let instance = &self.model.instance;
        if instance.delayed.next_corner(&instance.memory) <= t {
            return self.event(t, Cause::Time);
        }
        self.note_delayed(t, false)?;
        self.complete_step(t)?;
        if !self.model.instance.played.pass(t) {
            return Ok(());
        }
        if !self.program.watches.is_empty() {
            return self.event(t, Cause::Time);
        }
        self.go_to(t)?;
        if let Some(s) = &mut self.sensitivity {
            s.restart(t);
        }
        self.restart()
    }

    fn first_switch(&mut self) -> Result<Option<f64>, Failure> {
        let switched = self.search.first_switch(&mut self.model, &self.stepper);
        switched.map_err(|f| of_fault(&self.model.instance, f, self.stepper.t()))
    }

    fn has_left_the_domain(&mut self) -> bool {
        let left = !self.model.is_inside(self.stepper.t(), self.stepper.y());
        self.model.instance.fault = None;
        left
    }

    /// One accepted step; true if it ends at `t_stop`.
    fn step(&mut self, t_stop: f64) -> Result<bool, Failure> {
        self.model.beyond = false;
        self.model.instance.leaps = false;
        self.model.instance.undetermined = None;
        let mut outcome = self.stepper.step(&mut self.model, t_stop);
        if outcome.is_err() && self.lost_a_branch() {
            let told = self.model.instance.told();
            match self.leap(t_stop) {
                Some(leapt) => {
                    self.model.instance.forget(told);
                    outcome = leapt;
                }
                // What failed first is what is told.
                None => self.model.instance.tell(told),
            }
        }
        self.model.instance.leaps = true;
        let step =
            outcome.map_err(|e| of_integration(&self.model.instance, e, self.stepper.t()))?;
        // What a shorter step could avoid is no failure.
        self.model.instance.fault = None;
        Ok(matches!(step, Step::Reached { .. }))
    }

    /// True if a loop had no solution near the last one.
    fn lost_a_branch(&self) -> bool {
        matches!(
            self.model.instance.fault,
            Some(Fault::Diverged { .. } | Fault::Singular { .. } | Fault::NotFinite { .. })
        )
    }

    /// A step that begins on another branch of an algebraic loop, just beyond the end of the one that the
    /// solution was on; `None` if there is none.
    fn leap(&mut self, t_stop: f64) -> Option<Result<Step, crate::integrate::outcome::Failure>> {
        let (t, y) = (self.stepper.t(), self.stepper.y().to_vec());
        // As the last step went: the derivatives here may be beyond the end already.
        let before = self.stepper.t_previous();
        let mut slope = y.clone();
        self.stepper.interpolate(before, &mut slope);
        for (slope, y) in slope.iter_mut().zip(&y) {
            *slope = if t > before { (y - *slope) / (t - before) } else { 0.0 };
        }
        let mut moved = y.clone();
        for k in 0..LEAPS {
            let way = (self.stop - self.start) * FIRST_LEAP * 10.0_f64.powi(k);
            let beyond = t + way;
            if beyond >= t_stop {
                return None;
            }
            // The states go on to where the branch is no more.
            for ((m, y), slope) in moved.iter_mut().zip(&y).zip(&slope) {
                *m = y + way * slope;
            }
            self.model.instance.leaps = true;
            let found = self.model.rhs(beyond, &moved, &mut vec![0.0; y.len()]).is_ok();
            self.model.instance.leaps = false;
            self.model.instance.fault = None;
            if !found {
                continue;
            }
            let jacobian = JacobianMemory::Forget;
            if self.stepper.restart(&mut self.model, beyond, &moved, jacobian).is_err() {
                continue;
            }
            let step = self.stepper.step(&mut self.model, t_stop);
            if step.is_ok() {
                self.t = beyond;
                return Some(step);
            }
        }
        None
    }

    pub(super) fn restart(&mut self) -> Result<(), Failure> {
        let begun = self.stepper.restart(&mut self.model, self.t, &self.y, JacobianMemory::Forget);
        begun.map_err(|e| of_integration(&self.model.instance, e, self.t))
    }

    /// Selects states anew at the end of a step if necessary; true if they changed.
    fn select(&mut self) -> Result<bool, Failure> {
        if self.selection.is_empty() {
            return Ok(false);
        }
        let t = self.stepper.t();
        self.go_to(t)?;
        self.renew(t)
    }

    /// Selects states anew, if necessary, where the variables are in the memory.
    pub(super) fn renew(&mut self, t: f64) -> Result<bool, Failure> {
        self.look(t)?;
        if let Some(s) = &mut self.sensitivity {
            s.attach(&mut self.model.instance);
        }
        let renewed = self.selection.renew(&mut self.model.instance);
        if let Some(s) = &mut self.sensitivity {
            s.detach(&mut self.model.instance);
        }
        let changed = renewed.map_err(|f| of_fault(&self.model.instance, f, self.t))?;
        if changed {
            self.statistics.selections += 1;
            self.y.copy_from_slice(self.model.instance.states());
            if let Some(s) = &mut self.sensitivity {
                s.stand(self.program, t);
            }
        }
        Ok(changed)
    }

    /// Evaluates everything at an instant of the last step, relations held.
    pub(super) fn go_to(&mut self, t: f64) -> Result<(), Failure> {
        if t == self.stepper.t() {
            self.y.copy_from_slice(self.stepper.y());
        } else {
            self.stepper.interpolate(t, &mut self.y);
        }
        let mut evaluated = self.model.evaluate_all(t, &self.y);
        if evaluated.is_err_and(of_domain) && self.model.beyond {
            evaluated = self.model.evaluate_all_beyond(t, &self.y);
        }
        evaluated.map_err(|f| of_fault(&self.model.instance, f, t))
    }

    /// Records the rows of the grid up to `end`, and looks for extreme values up to there.
    pub(super) fn record_grid(&mut self, end: f64, inclusive: bool) -> Result<(), Failure> {
        self.seek_extremes(end)?;
        while let Some(at) = self.recorder.due(end, inclusive) {
            self.go_to(at)?;
            // A long step may come back to where they hold.
            self.check_assertions(at)?;
            self.take_row(at)?;
            self.put_row(at);
            self.recorder.advance();
        }
        Ok(())
    }

    /// Records the row at `t` with the states in `self.y`.
    pub(super) fn record(&mut self, t: f64) -> Result<(), Failure> {
        let evaluated = self.model.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
        self.take_row(t)?;
        self.heed_extremes();
        self.put_row(t);
        Ok(())
    }

    /// Takes the values in the memory as the next row.
    pub(super) fn take_row(&mut self, t: f64) -> Result<(), Failure> {
        let mut taken = self.recorder.take(&self.model.instance);
        if taken.is_err() && self.model.beyond {
            let evaluated = self.model.evaluate_all_beyond(t, &self.y);
            evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
            taken = self.recorder.take(&self.model.instance);
        }
        if taken.is_ok() {
            let (memory, said) = (&self.model.instance.memory, &mut self.statistics.warnings);
            self.limits.look(self.program, memory, t, said);
            self.look_at_row(t)?;
        }
        taken.map_err(|v| {
            let reader = Reader::new(self.program, &self.model.instance.memory);
            Failure::numerics(t, reader.not_finite(v, Sequence::Continuous, t))
        })
    }

    pub(super) fn put_row(&mut self, t: f64) {
        self.statistics.rows += 1;
        self.recorder.put(t, self.sink);
        if let Some(s) = &self.sensitivity {
            self.recorder.flush(self.sink);
            self.sink.slopes(s.slopes());
        }
    }

    pub(super) fn relation_text(&mut self, k: u32) -> String {
        let program = self.program;
        self.texts[k as usize].get_or_insert_with(|| relation_text(program, k)).clone()
    }

    pub(super) fn relation_span(&self, k: u32) -> Span {
        self.program.blocks.dae.relations[k as usize].origin.span
    }

    pub(super) fn place(&self, span: Span) -> String {
        self.sources.place(span).unwrap_or_default()
    }
}

/// Begins the histories of delayed expressions; true if what they begin with has changed.
fn first_values(model: &mut Model<'_>, t: f64) -> bool {
    let mut y = vec![0.0; model.instance.program.order().max(1)];
    let n = model.instance.program.order();
    y[..n].copy_from_slice(model.instance.states());
    if model.evaluate_all(t, &y).is_err() {
        return false;
    }
    let instance = &mut model.instance;
    let delayed = instance.delayed.begin(t, &instance.memory);
    instance.transports.begin(t, &mut instance.memory) || delayed
}
