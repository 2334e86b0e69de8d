//! The loop: step, look for events, record, settle, go on.

use std::time::{Duration, Instant};

use crate::base::diag::Diagnostic;
use crate::base::source::{SourceMap, Span};
use crate::integrate::options::Options;
use crate::integrate::outcome::Step;
use crate::integrate::radau::Radau;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::ir::expr::{Binary, Const, ExprId};
use crate::ir::program::{Program, Sequence, Slot, Watch};
use crate::ir::trajectory::{Event, Trajectory};

use super::clock::Clocks;
use super::error::{Failure, FailureKind, no_start, of_fault, of_integration, unsettled};
use super::events::{Search, Settled, Unsettled, settle};
use super::explain::{Reader, relation_text};
use super::initial::initialise;
use super::record::{Recorder, Sink, columns};
use super::selection::{LIMIT, Selection};
use super::settings::Settings;
use super::sliding::Sliding;
use super::system::{Model, of_domain};

/// So many events in so short a time are chattering, not physics.
const CHATTER_EVENTS: usize = 64;
/// The short time, as a part of the whole run.
const CHATTER_SPAN: f64 = 1e-7;

/// So many events of one relation alone in the short time, and its two sides are asked whether they
/// meet.
const MEETING_EVENTS: u32 = 4;
/// Halvings of a step to find the end of a motion along a surface.
const HALVINGS: u32 = 50;

/// Tolerances are not sharpened beyond this.
const SHARPEST: f64 = 1e-12;

/// First shift of an event that its evaluation does not confirm, in spacings of doubles.
const NUDGE: f64 = 8.0;

/// What a run cost.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Statistics {
    /// Work of the integrator.
    pub integration: Stats,
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
    /// Assertions of level warning that were violated, each once.
    pub warnings: Vec<Diagnostic>,
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
    if let Some(what) = settings.fault() {
        return Err(Failure::settings(what));
    }
    let begun = Instant::now();
    let mut simulation = Simulation::begin(program, settings, sources, sink)?;
    simulation.run()?;
    let mut statistics = simulation.statistics;
    statistics.integration = *simulation.stepper.stats();
    statistics.elapsed = begun.elapsed();
    Ok(statistics)
}

/// A run under way.
struct Simulation<'p, 's> {
    program: &'p Program,
    sources: &'s SourceMap,
    sink: &'s mut dyn Sink,
    model: Model<'p>,
    stepper: Radau,
    clocks: Clocks,
    selection: Selection,
    search: Search,
    recorder: Recorder,
    statistics: Statistics,
    start: f64,
    stop: f64,
    t: f64,
    y: Vec<f64>,
    warned: Vec<bool>,
    texts: Vec<Option<String>>,
    recent: Recent,
    ended: bool,
}

/// The times of the last events, to notice chattering.
struct Recent {
    times: [f64; CHATTER_EVENTS],
    at: usize,
    span: f64,
    /// The last relation that switched alone, how often in a row, and since when.
    alone: Option<(u32, u32, f64)>,
}

/// What leads to an event.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cause {
    State,
    Time,
}

impl<'p, 's> Simulation<'p, 's> {
    fn begin(
        program: &'p Program,
        settings: &Settings,
        sources: &'s SourceMap,
        sink: &'s mut dyn Sink,
    ) -> Result<Self, Failure> {
        let mut model = Model::new(program);
        model.instance.execute(&settings.execution);
        let t = settings.start;
        let begun = initialise(&mut model.instance, settings);
        let (clocks, selection, settled) = begun.map_err(|e| no_start(&model.instance, e, t))?;
        let n = program.order().max(1);
        let mut y = vec![0.0; n];
        y[..program.order()].copy_from_slice(model.instance.states());
        let stepper = Radau::for_system(&model, options(&model, settings))
            .map_err(|e| Failure::settings(e.to_string()))?;
        let recorder = Recorder::new(program, t, settings.stop, settings.interval);
        sink.begin(columns(program));
        let span = CHATTER_SPAN * (settings.stop - settings.start);
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
            statistics: Statistics::default(),
            start: settings.start,
            stop: settings.stop,
            t,
            y,
            warned: vec![false; program.asserts.len()],
            texts: vec![None; program.watches.len()],
            recent: Recent { times: [f64::NEG_INFINITY; CHATTER_EVENTS], at: 0, span, alone: None },
            ended: false,
        };
        simulation.record(t)?;
        simulation.check_assertions(t)?;
        simulation.act_on(settled, t)?;
        Ok(simulation)
    }

    fn run(&mut self) -> Result<(), Failure> {
        self.restart()?;
        while self.t < self.stop && !self.ended {
            let instant = self.clocks.next_instant(&self.model.instance, self.t);
            let t_stop = instant.min(self.stop);
            let mut reached = self.step(t_stop)?;
            let mut switched = self.first_switch()?;
            if self.model.beyond && switched.is_none() && self.has_left_the_domain() {
                // No relation would have kept the step inside: so must the step itself.
                self.stepper.interpolate(self.t, &mut self.y);
                self.model.strict = true;
                let repeated = self.restart().and_then(|()| self.step(t_stop));
                self.model.strict = false;
                reached = repeated?;
                switched = self.first_switch()?;
            }
            match switched {
                Some(at) => self.event(at, Cause::State)?,
                None if reached && t_stop == instant => self.event(t_stop, Cause::Time)?,
                None if self.end_of_sliding()?.is_some() => {}
                None => {
                    let t = self.stepper.t();
                    self.search.heed(&self.model.instance);
                    self.check_assertions(t)?;
                    self.record_grid(t, true)?;
                    self.t = t;
                    if self.select()? {
                        self.restart()?;
                    }
                }
            }
        }
        self.statistics.end = self.t;
        if self.program.reads_terminal { self.finish() } else { Ok(()) }
    }

    /// The event at the end of the run, for what happens `when terminal()`.
    fn finish(&mut self) -> Result<(), Failure> {
        let t = self.t;
        let terminal = self.program.layout.terminal;
        self.model.instance.set(terminal, 1.0);
        let outcome = settle(&mut self.model.instance, &self.clocks);
        let settled = outcome.map_err(|u| unsettled(&self.model.instance, u, t))?;
        if settled.changed {
            let n = self.program.order();
            self.y[..n].copy_from_slice(self.model.instance.states());
            self.record(t)?;
        }
        self.act_on(settled, t)
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
        let outcome = self.stepper.step(&mut self.model, t_stop);
        let step =
            outcome.map_err(|e| of_integration(&self.model.instance, e, self.stepper.t()))?;
        // What a shorter step could avoid is no failure.
        self.model.instance.fault = None;
        Ok(matches!(step, Step::Reached { .. }))
    }

    fn restart(&mut self) -> Result<(), Failure> {
        let begun = self.stepper.restart(&mut self.model, self.t, &self.y, JacobianMemory::Forget);
        begun.map_err(|e| of_integration(&self.model.instance, e, self.t))
    }

    /// Everything that happens at one instant of the last step.
    fn event(&mut self, t: f64, cause: Cause) -> Result<(), Failure> {
        self.record_grid(t, false)?;
        // Whatever happens, both sides are looked at anew.
        self.model.sliding = None;
        self.search.ignore(None);
        let held = self.held_relations();
        let mut nudge =
            NUDGE * f64::EPSILON * t.abs().max(self.stepper.t() - self.stepper.t_previous());
        let (mut t, mut ticked) = (t, false);
        let mut triggers: Vec<u32> = Vec::new();
        let settled = loop {
            self.go_to(t)?;
            self.take_row(t)?;
            triggers.extend(self.search.switched(&self.model.instance));
            ticked |= self.clocks.raise(&mut self.model.instance, t);
            let before = self.model.instance.memory.clone();
            let settled = match self.settle() {
                // Where relations meet, rounding may turn one by the other: a little later it will not.
                Err(Unsettled::Restless(..)) if cause == Cause::State && t < self.stepper.t() => {
                    self.model.instance.memory.copy_from_slice(&before);
                    t = (t + nudge).min(self.stepper.t());
                    nudge *= 4.0;
                    continue;
                }
                outcome => outcome.map_err(|u| unsettled(&self.model.instance, u, t))?,
            };
            // The event sequence may round an operand to the other side: a little later it will not.
            if settled.changed || cause == Cause::Time || t >= self.stepper.t() {
                break settled;
            }
            t = (t + nudge).min(self.stepper.t());
            nudge *= 4.0;
        };
        self.t = t;
        let n = self.program.order();
        self.y[..n].copy_from_slice(self.model.instance.states());
        if settled.changed {
            self.put_row(t);
            self.record(t)?;
            while self.recorder.due(t, true).is_some() {
                self.recorder.advance();
            }
        } else {
            self.record_grid(t, true)?;
            self.go_to(t)?;
        }
        let flipped = self.flipped(&held, &triggers);
        self.announce(t, cause, ticked, &flipped, settled);
        if !ticked && !self.slides(t, &flipped, settled)? {
            self.guard_against_chattering(t, &flipped)?;
        }
        self.check_assertions(t)?;
        self.act_on(settled, t)?;
        if !self.ended && t < self.stop {
            if !self.selection.is_empty() {
                let evaluated = self.model.evaluate_all(t, &self.y);
                evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
                self.renew()?;
            }
            self.restart()?;
        }
        Ok(())
    }

    /// Selects states anew at the end of a step if necessary; true if they changed.
    fn select(&mut self) -> Result<bool, Failure> {
        if self.selection.is_empty() {
            return Ok(false);
        }
        self.go_to(self.stepper.t())?;
        self.renew()
    }

    /// Selects states anew, if necessary, where the variables are in the memory.
    fn renew(&mut self) -> Result<bool, Failure> {
        let renewed = self.selection.renew(&mut self.model.instance);
        let changed = renewed.map_err(|f| of_fault(&self.model.instance, f, self.t))?;
        if changed {
            self.statistics.selections += 1;
            self.y.copy_from_slice(self.model.instance.states());
        }
        Ok(changed)
    }

    /// The event iteration, beyond the domain of functions where it can not be helped: new
    /// relations and old branches meet in it.
    fn settle(&mut self) -> Result<Settled, Unsettled> {
        let mut outcome = settle(&mut self.model.instance, &self.clocks);
        if let Err(Unsettled::Fault(fault)) = outcome
            && of_domain(fault)
        {
            self.model.instance.inside = true;
            outcome = settle(&mut self.model.instance, &self.clocks);
            self.model.instance.inside = false;
        }
        outcome
    }

    /// Evaluates everything at an instant of the last step, relations held.
    fn go_to(&mut self, t: f64) -> Result<(), Failure> {
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

    /// Records the rows of the grid up to `end`.
    fn record_grid(&mut self, end: f64, inclusive: bool) -> Result<(), Failure> {
        while let Some(at) = self.recorder.due(end, inclusive) {
            self.go_to(at)?;
            self.take_row(at)?;
            self.put_row(at);
            self.recorder.advance();
        }
        Ok(())
    }

    /// Records the row at `t` with the states in `self.y`.
    fn record(&mut self, t: f64) -> Result<(), Failure> {
        let evaluated = self.model.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
        self.take_row(t)?;
        self.put_row(t);
        Ok(())
    }

    /// Takes the values in the memory as the next row.
    fn take_row(&mut self, t: f64) -> Result<(), Failure> {
        let mut taken = self.recorder.take(&self.model.instance);
        if taken.is_err() && self.model.beyond {
            let evaluated = self.model.evaluate_all_beyond(t, &self.y);
            evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
            taken = self.recorder.take(&self.model.instance);
        }
        taken.map_err(|v| {
            let reader = Reader::new(self.program, &self.model.instance.memory);
            Failure::numerics(t, reader.not_finite(v, Sequence::Continuous, t))
        })
    }

    fn put_row(&mut self, t: f64) {
        self.statistics.rows += 1;
        self.recorder.put(t, self.sink);
    }

    fn held_relations(&self) -> Vec<f64> {
        let first = self.program.layout.relations;
        (0..self.program.watches.len() as Slot)
            .map(|k| self.model.instance.get(first + k))
            .collect()
    }

    /// Relations that led to the event, and those that differ from what was held; with the value
    /// that they took.
    fn flipped(&self, held: &[f64], triggers: &[u32]) -> Vec<(u32, bool)> {
        let now = self.held_relations();
        let pairs = held.iter().zip(&now).enumerate();
        let changed = pairs.filter(|(k, (a, b))| a != b || triggers.contains(&(*k as u32)));
        changed.map(|(k, (before, _))| (k as u32, *before == 0.0)).collect()
    }

    /// Counts the event and tells the sink.
    fn announce(
        &mut self,
        t: f64,
        cause: Cause,
        ticked: bool,
        flipped: &[(u32, bool)],
        settled: Settled,
    ) {
        // A switching that the event iteration does not confirm is rounding, not an event.
        if !settled.changed {
            return;
        }
        match cause {
            Cause::State => self.statistics.state_events += 1,
            Cause::Time => self.statistics.time_events += 1,
        }
        for &(k, truth) in flipped {
            if self.program.watches[k as usize] == Watch::Discrete {
                continue;
            }
            let what = format!("{} became {truth}", self.relation_text(k));
            let place = self.place(self.relation_span(k));
            self.sink.event(Event { time: t, what, place });
        }
        if ticked {
            let event = Event { time: t, what: "sample".to_owned(), place: String::new() };
            self.sink.event(event);
        } else if flipped.is_empty() {
            let event = Event { time: t, what: "time event".to_owned(), place: String::new() };
            self.sink.event(event);
        }
    }

    fn relation_text(&mut self, k: u32) -> String {
        let program = self.program;
        self.texts[k as usize].get_or_insert_with(|| relation_text(program, k)).clone()
    }

    fn relation_span(&self, k: u32) -> Span {
        self.program.blocks.dae.relations[k as usize].origin.span
    }

    fn place(&self, span: Span) -> String {
        self.sources.place(span).unwrap_or_default()
    }

    /// Stays on the surface of a relation that switched alone several times in no time, if its two
    /// sides meet there; true if so.
    fn slides(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        settled: Settled,
    ) -> Result<bool, Failure> {
        let &[(k, truth)] = flipped else {
            self.recent.alone = None;
            return Ok(false);
        };
        if settled.acted || self.program.watches[k as usize] != Watch::State {
            self.recent.alone = None;
            return Ok(false);
        }
        let (times, since) = match self.recent.alone {
            Some((last, times, since)) if last == k && t - since <= self.recent.span => {
                (times + 1, since)
            }
            _ => (1, t),
        };
        self.recent.alone = Some((k, times, since));
        if times < MEETING_EVENTS {
            return Ok(false);
        }
        let op = self.program.blocks.dae.relations[k as usize].op;
        let rising = matches!(op, Binary::Greater | Binary::GreaterEqual);
        let instance = &mut self.model.instance;
        let mut sliding = Sliding::along(k, instance, self.stop - self.start);
        let n = self.program.order();
        let rates = sliding.rates(instance, t, &self.y[..n]);
        if !rates.is_ok_and(|rates| rates.meet(rising)) {
            let back = sliding.switch(instance, usize::from(truth));
            back.map_err(|f| of_fault(&self.model.instance, f, t))?;
            return Ok(false);
        }
        self.model.sliding = Some(sliding);
        self.search.ignore(Some(k));
        self.recent.alone = None;
        let evaluated = self.model.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
        self.tell_of_sliding(t, k, "stays where it switches");
        Ok(true)
    }

    /// Leaves a surface that the last step should not have followed to its end; where it left.
    fn end_of_sliding(&mut self) -> Result<Option<f64>, Failure> {
        let Some(mut sliding) = self.model.sliding.take() else { return Ok(None) };
        let (mut inside, mut outside) = (self.stepper.t_previous(), self.stepper.t());
        let n = self.program.order();
        let mut part_at = |s: &mut Self, t: f64| {
            s.stepper.interpolate(t, &mut s.y);
            let rates = sliding.rates(&mut s.model.instance, t, &s.y[..n]);
            rates.map(|r| r.part()).map_err(|f| of_fault(&s.model.instance, f, t))
        };
        let is_inside = |part: f64| (0.0..=1.0).contains(&part);
        let mut part = part_at(self, outside)?;
        if is_inside(part) {
            self.model.sliding = Some(sliding);
            return Ok(None);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            let there = part_at(self, middle)?;
            if is_inside(there) {
                inside = middle;
            } else {
                (outside, part) = (middle, there);
            }
        }
        let (t, k) = (outside, sliding.relation());
        self.model.sliding = Some(sliding);
        self.record_grid(t, true)?;
        self.stepper.interpolate(t, &mut self.y);
        if let Some(sliding) = self.model.sliding.take() {
            let left = sliding.switch(&mut self.model.instance, usize::from(part > 0.5));
            left.map_err(|f| of_fault(&self.model.instance, f, t))?;
        }
        self.t = t;
        self.tell_of_sliding(t, k, "switches again");
        self.restart()?;
        Ok(Some(t))
    }

    fn tell_of_sliding(&mut self, t: f64, k: u32, what: &str) {
        let what = format!("{} {what}", self.relation_text(k));
        let place = self.place(self.relation_span(k));
        self.sink.event(Event { time: t, what, place });
    }

    fn guard_against_chattering(&mut self, t: f64, flipped: &[(u32, bool)]) -> Result<(), Failure> {
        let recent = &mut self.recent;
        let oldest = recent.times[recent.at];
        recent.times[recent.at] = t;
        recent.at = (recent.at + 1) % CHATTER_EVENTS;
        if t - oldest > recent.span {
            return Ok(());
        }
        let duration = t - oldest;
        let k = flipped.first().map(|f| f.0);
        let what =
            k.map_or_else(|| "a relation".to_owned(), |k| format!("`{}`", self.relation_text(k)));
        let span = k.map_or(Span::NONE, |k| self.relation_span(k));
        let message = format!(
            "at time {t} s {what} switches without end: {CHATTER_EVENTS} events within {duration:e} s"
        );
        let diagnostic = Diagnostic::error("MO0911", span, message)
            .label("this relation chatters")
            .help("give the two branches a hysteresis or a smooth transition, or model the state between them (locked, resting) explicitly");
        Err(Failure::numerics(t, diagnostic))
    }

    /// Assertions outside of when-clauses, as evaluated last.
    fn check_assertions(&mut self, t: f64) -> Result<(), Failure> {
        for k in 0..self.program.asserts.len() {
            let cells = self.program.asserts[k];
            if cells.at_events || self.model.instance.get(cells.condition) != 0.0 {
                continue;
            }
            let warning = self.program.blocks.dae.asserts[k].assert.warning;
            if !warning {
                return Err(self.assertion(k, t));
            }
            if !std::mem::replace(&mut self.warned[k], true) {
                let failure = self.assertion(k, t);
                let severity = crate::base::diag::Severity::Warning;
                self.statistics.warnings.push(Diagnostic { severity, ..*failure.diagnostic });
            }
        }
        Ok(())
    }

    fn assertion(&self, k: usize, t: f64) -> Failure {
        let guarded = &self.program.blocks.dae.asserts[k];
        let reader = Reader::new(self.program, &self.model.instance.memory);
        let message = format!("at time {t} s: {}", self.message(guarded.assert.message));
        let diagnostic = Diagnostic::error("MO0912", guarded.origin.span, message)
            .label(format!("`{}` is false", reader.text(guarded.assert.condition)));
        Failure { kind: FailureKind::Assertion, time: t, diagnostic: Box::new(diagnostic) }
    }

    /// The text of a `String` expression.
    fn message(&self, e: ExprId) -> String {
        match self.program.blocks.dae.graph.as_const(e) {
            Some(Const::String(text)) => text.to_string(),
            _ => Reader::new(self.program, &self.model.instance.memory).text(e),
        }
    }

    /// Failed assertions and terminations of an event iteration.
    fn act_on(&mut self, settled: Settled, t: f64) -> Result<(), Failure> {
        if let Some(k) = settled.failed {
            return Err(self.assertion(k, t));
        }
        if let Some(k) = settled.terminate {
            let message = self.program.blocks.dae.terminates[k].message;
            self.statistics.terminated = Some(self.message(message));
            self.ended = true;
        }
        Ok(())
    }
}

fn options(model: &Model<'_>, settings: &Settings) -> Options {
    let program = model.instance.program;
    let nominals = program.layout.nominals.iter().map(|slot| {
        let size = model.instance.get(*slot).abs();
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    });
    let mut nominals: Vec<f64> = nominals.collect();
    nominals.resize(program.order().max(1), 1.0);
    // What is not selected meets the tolerance too, though it and its rate react stronger.
    let reaction = if program.state_sets.is_empty() { 1.0 } else { LIMIT * LIMIT };
    let tolerance = (settings.tolerance / reaction).max(SHARPEST.min(settings.tolerance));
    let mut options = Options::with_nominals(tolerance, &nominals);
    if program.order() == 0 && settings.stop > settings.start {
        // Nothing limits the error of a resting state, but events must not be stepped over.
        options.max_step = settings.interval;
    }
    options
}
