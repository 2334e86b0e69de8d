//! Slow progress: steps so short that the run would take millions of them.
//!
//! A comparison inside `noEvent`, or a function that jumps without an event, is invisible to the
//! location of events: where it switches back and forth, each switch costs a rejected step, and the
//! steps collapse. When a run makes little progress, the truth of all such comparisons is recorded
//! for some steps; the one that switches most is named, with the remedy: by an error if the limit of
//! steps would end the run anyway.

use crate::base::activity;
use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::Span;
use crate::ir::expr::{ExprId, Node};
use crate::ir::program::Program;

use super::cause::RunCause;
use super::failure::Failure;
use super::failure::non_finite::Explainer;
use super::run::Simulation;

/// Steps between two looks at the progress.
const WINDOW: u32 = 20_000;
/// Steps between two notes of the activity.
const STEPS_PER_NOTE: u32 = 16;
/// Minimum progress within a window, as a fraction of the run: less means a million steps.
const PROGRESS: f64 = 0.02;
/// Less than this means that the limit of ten million steps ends the run.
const LEAST_PROGRESS: f64 = 0.002;
/// Steps for which comparisons are recorded.
const SAMPLES: u32 = 200;
/// Progress within a window, as a fraction of the run, below which a run has hundreds of millions of
/// steps.
const HOPELESS_PROGRESS: f64 = 1e-4;
/// Number of such windows in succession after which a run is ended.
const HOPELESS_WINDOWS: u32 = 25;
/// Less than this fraction of [`HOPELESS_PROGRESS`] is seen sooner.
const CLEARLY: f64 = 0.5;
/// Number of such windows in succession after which a run is ended.
const CLEARLY_HOPELESS_WINDOWS: u32 = 8;
/// Ratio of the progress of the last and the first of them above which the steps become longer.
const RECOVERY: f64 = 2.0;
/// Minimum number of switches among these that counts as the cause.
const SWITCHES: u32 = 40;

/// The progress of a run.
pub struct ProgressWatch {
    steps: u32,
    /// Start of the window, s.
    since: f64,
    observed: Vec<Observed>,
    /// Samples still to be taken.
    left: u32,
    /// The cause was looked for already.
    is_done: bool,
    /// The run will not end within the limit of steps.
    is_hopeless: bool,
    /// Events among the steps of the window.
    events: u32,
    /// Windows in succession with hopeless progress, and that of the first of them.
    hopeless: (u32, f64),
}

/// A comparison without events.
struct Observed {
    expression: ExprId,
    truth: f64,
    switches: u32,
}

impl ProgressWatch {
    /// For a run that starts at `start`, s.
    pub fn new(start: f64) -> Self {
        ProgressWatch {
            steps: 0,
            since: start,
            observed: Vec::new(),
            left: 0,
            is_done: false,
            is_hopeless: false,
            events: 0,
            hopeless: (0, 0.0),
        }
    }
}

impl Simulation<'_, '_> {
    /// Counts an event at `t`, s, as a step.
    pub(super) fn watch_event(&mut self, t: f64) -> Result<(), Failure> {
        self.progress.events += 1;
        self.watch_progress(t)
    }

    /// Counts a step that ends at `t`, s. If steps are short because of a comparison, warns once, or
    /// fails if there would be too many of them.
    pub(super) fn watch_progress(&mut self, t: f64) -> Result<(), Failure> {
        self.progress.steps += 1;
        if self.progress.steps.is_multiple_of(STEPS_PER_NOTE) {
            activity::note(format!("simulating at time {t} s"));
        }
        if self.progress.left > 0 {
            return self.sample_comparisons(t);
        } else if self.progress.steps >= WINDOW {
            let done = (t - self.progress.since) / (self.stop - self.start);
            let is_slow = done < PROGRESS;
            self.progress.is_hopeless = done < LEAST_PROGRESS;
            let events = std::mem::take(&mut self.progress.events);
            self.progress.steps = 0;
            self.progress.since = t;
            self.check_hopeless(t, done, 2 * events > WINDOW)?;
            if is_slow && !self.progress.is_done {
                self.progress.is_done = true;
                self.progress.observed = comparisons(self.program);
                self.progress.left = if self.progress.observed.is_empty() { 0 } else { SAMPLES };
            }
        }
        Ok(())
    }

    /// Fails after many windows that made no progress to speak of, without getting faster.
    fn check_hopeless(&mut self, time: f64, done: f64, of_events: bool) -> Result<(), Failure> {
        let (windows, first) = self.progress.hopeless;
        if done >= HOPELESS_PROGRESS || (windows > 0 && done > RECOVERY * first) {
            self.progress.hopeless = (0, 0.0);
            return Ok(());
        }
        self.progress.hopeless = if windows == 0 { (1, done) } else { (windows + 1, first) };
        let most = match done < CLEARLY * HOPELESS_PROGRESS {
            true => CLEARLY_HOPELESS_WINDOWS,
            false => HOPELESS_WINDOWS,
        };
        if windows + 1 < most {
            return Ok(());
        }
        // A solution between the borders of a hysteresis that moves no further than from one to the other.
        if let Some(chattering) = self.history.avoided.take() {
            return Err(chattering);
        }
        let total = (f64::from(WINDOW) / done).min(1e300);
        // Two digits: the estimate is no better.
        let scale = 10_f64.powf(total.log10().floor() - 1.0);
        let total = (total / scale).round() * scale;
        let doing = if of_events { "the intervals between events" } else { "steps" };
        let cause = RunCause::HopelessProgress { time, total, doing };
        Err(Failure::numerics(time, Diagnostic::new(cause, Span::NONE)))
    }

    fn sample_comparisons(&mut self, t: f64) -> Result<(), Failure> {
        self.progress.left -= 1;
        let explainer = Explainer::new(self.program, &self.system.machine.memory);
        for observed in &mut self.progress.observed {
            let truth = explainer.number(observed.expression);
            observed.switches += u32::from(truth != observed.truth);
            observed.truth = truth;
        }
        if self.progress.left > 0 {
            return Ok(());
        }
        let most = self.progress.observed.iter().max_by_key(|o| o.switches);
        let Some(most) = most.filter(|most| most.switches >= SWITCHES) else { return Ok(()) };
        let cause = RunCause::HiddenSwitching {
            time: t,
            expression: explainer.text(most.expression),
            switches: most.switches,
            steps: SAMPLES,
        };
        let span = span_of(self.program, most.expression);
        let diagnostic = Diagnostic::new(cause, span)
            .label("without an event the steps shrink at each of its switches");
        if self.progress.is_hopeless {
            return Err(Failure::numerics(t, diagnostic.with_severity(Severity::Error)));
        }
        self.statistics.warnings.push(diagnostic);
        Ok(())
    }
}

/// The comparisons in the equations that do not cause events, and functions that jump.
fn comparisons(program: &Program) -> Vec<Observed> {
    let graph = &program.blocks.dae.graph;
    let is_relation = |e: &ExprId| match graph.node(*e) {
        Node::Binary(op, ..) => op.is_relation(),
        Node::Unary(op, _) => op.shape().is_piecewise_constant(),
        _ => false,
    };
    let used = used_expressions(program);
    let found = used.into_iter().filter(is_relation);
    found.map(|expression| Observed { expression, truth: 0.0, switches: 0 }).collect()
}

/// All expressions of the continuous equations, operands before the expressions that use them.
fn used_expressions(program: &Program) -> Vec<ExprId> {
    let mut roots = Vec::new();
    for block in &program.blocks.continuous {
        block.for_each_expression(&mut |e| roots.push(e));
    }
    program.blocks.dae.graph.postorder(roots)
}

/// The place of the equation that an expression is part of.
fn span_of(program: &Program, e: ExprId) -> Span {
    let graph = &program.blocks.dae.graph;
    for block in &program.blocks.continuous {
        let mut contains = false;
        block.for_each_expression(&mut |root| contains |= graph.postorder([root]).contains(&e));
        let mut span = Span::NONE;
        if contains {
            block.for_each_assignment(&mut |a| {
                if span.is_none() {
                    let explainer = Explainer::new(program, &[]);
                    span = explainer.span(a.source);
                }
            });
        }
        if !span.is_none() {
            return span;
        }
    }
    Span::NONE
}
