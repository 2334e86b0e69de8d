//! The values of a foreign model in the memory of its program: inputs and parameters on their way to it, and rows on
//! their way from it to the sink.

use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::ir::expr::VarId;
use crate::ir::foreign::{Foreign, ForeignRole, ForeignSignal, ForeignTask, ForeignType};
use crate::ir::program::{Program, Slot};
use crate::runtime::machine::Machine;
use crate::simulate::cause::{NonFinite, RunCause};
use crate::simulate::columns::constants;
use crate::simulate::extrema::ExtremumRequest;
use crate::simulate::failure::{Failure, of_fault};
use crate::simulate::record::{Recorder, Sink, begin};
use crate::simulate::settings::Settings;

/// A variable that the foreign model computes.
struct Watched {
    value: usize,
    slot: Slot,
    /// Where expressions read it, if it is a Real.
    signal: Option<Slot>,
    is_real: bool,
}

/// The memory and the rows of a run.
pub(super) struct Rows<'p> {
    pub machine: Machine<'p>,
    pub recorder: Recorder,
    /// Distance of the rows, s.
    interval: f64,
    /// Rows so far.
    pub count: u64,
    file: String,
    watched: Vec<Watched>,
    /// Inputs that signals drive: number of the value, and slot of the signal.
    driven: Vec<(usize, Slot)>,
    /// Some recorded variables are expressions.
    has_expressions: bool,
    extrema: Vec<(ExtremumRequest, Option<f64>)>,
}

impl<'p> Rows<'p> {
    /// Evaluates the parameters and finds out what the run looks at.
    pub fn new(
        foreign: &Foreign,
        program: &'p Program,
        settings: &Settings,
    ) -> Result<Self, Failure> {
        let mut machine = Machine::new(program);
        for &(v, value) in &settings.parameters {
            machine.set_parameter(v, value);
        }
        for &(v, value) in &settings.starts {
            machine.set_start(v, value);
        }
        machine.set_input_signals(&settings.courses, settings.start);
        let evaluated = machine.run(&program.tapes.parameters);
        evaluated.map_err(|f| of_fault(&machine, f, settings.start))?;
        let interface = foreign.model.interface();
        let signal = |v: VarId| {
            let own = program.layout.signals.iter().find(|(s, order, _)| *s == v && *order == 0);
            own.map(|(.., slot)| *slot)
        };
        let is_foreign: FastSet<VarId> = foreign.variables.iter().map(|(v, _)| *v).collect();
        let has_expressions = !program.recorded.iter().all(|v| is_foreign.contains(v))
            || !settings.extrema.is_empty();
        let wanted: FastSet<VarId> = program.recorded.iter().copied().collect();
        let (mut watched, mut driven) = (Vec::new(), Vec::new());
        for (v, k) in &foreign.variables {
            let variable = &interface.variables[*k];
            if matches!(variable.role, ForeignRole::Parameter | ForeignRole::Constant) {
                continue;
            }
            let is_driven = settings.courses.iter().any(|(c, _)| c == v);
            if is_driven {
                driven.push((variable.value, signal(*v).unwrap_or_else(|| program.slot(*v))));
            }
            if has_expressions || wanted.contains(v) {
                watched.push(Watched {
                    value: variable.value,
                    slot: program.slot(*v),
                    signal: signal(*v).filter(|_| !is_driven),
                    is_real: variable.ty == ForeignType::Real,
                });
            }
        }
        driven.sort_unstable();
        driven.dedup_by_key(|pair| pair.0);
        // Measures look at rows: a sweep that keeps none still needs them.
        let spacing = settings.spacing.filter(|_| has_expressions && settings.instants.is_none());
        let interval = spacing.map_or(settings.interval, |spacing| spacing.min(settings.interval));
        let recorder = Recorder::new(program, &Settings { interval, ..settings.clone() });
        Ok(Rows {
            machine,
            recorder,
            interval,
            count: 0,
            file: foreign.model.file().to_owned(),
            watched,
            driven,
            has_expressions,
            extrema: settings.extrema.iter().map(|e| (e.clone(), None)).collect(),
        })
    }

    /// The run in terms of the foreign model.
    pub fn task(&mut self, settings: &Settings) -> ForeignTask {
        let signals = &self.machine.input_signals;
        let signal = |(value, slot): &(usize, Slot)| signals.to_foreign(*slot, *value);
        let signals: Vec<ForeignSignal> = self.driven.iter().filter_map(signal).collect();
        ForeignTask {
            span: [settings.start, settings.stop],
            tolerance: settings.tolerance,
            method: settings.method.name().to_owned(),
            most_steps: settings.most_steps,
            max_step: settings.max_step,
            interval: self.interval,
            spacing: settings.spacing.unwrap_or(settings.interval),
            instants: settings.instants.clone(),
            values: self.overridden(settings.start),
            signals,
            watched: self.watched.iter().map(|w| (w.value, w.is_real)).collect(),
        }
    }

    /// Parameters, start values and inputs that differ from those of the model, by their numbers.
    fn overridden(&mut self, foreign_start: f64) -> Vec<(usize, f64)> {
        let program = self.machine.program;
        let Some(foreign) = &program.foreign else { return Vec::new() };
        let interface = foreign.model.interface();
        let mut out = Vec::new();
        for (v, k) in &foreign.variables {
            let variable = &interface.variables[*k];
            if !variable.may_be_set {
                continue;
            }
            let start = || {
                let starts = &program.layout.starts;
                starts.iter().find(|(s, ..)| s == v).map(|(.., slot)| *slot)
            };
            let value = match variable.role {
                ForeignRole::Parameter => self.machine.value(*v),
                _ => start().map_or(f64::NAN, |slot| self.machine.get(slot)),
            };
            // An input that an override binds is a constant of the program.
            let value = if value.is_nan() { self.machine.value(*v) } else { value };
            if value.is_finite() && value != variable.start.unwrap_or(0.0) {
                out.push((variable.value, value));
            }
        }
        self.inputs_at(foreign_start, &mut out);
        // A signal counts more than a start value.
        out.sort_by_key(|pair| pair.0);
        out.reverse();
        out.dedup_by_key(|pair| pair.0);
        out.reverse();
        out
    }

    /// Adds the driven inputs at an instant.
    fn inputs_at(&mut self, t: f64, out: &mut Vec<(usize, f64)>) {
        self.machine.set_point(t, &[]);
        let memory = &self.machine.memory;
        out.extend(self.driven.iter().map(|(value, slot)| (*value, memory[*slot as usize])));
    }

    /// Announces the run to the sink.
    pub fn begin(&self, sink: &mut dyn Sink) {
        let program = self.machine.program;
        begin(program, sink);
        sink.expect(self.recorder.expected_rows());
        if sink.wants_constants() {
            sink.constants(constants(&self.machine));
        }
    }

    /// Passes the breakpoints of the inputs up to `t`, s, or those before it.
    pub fn advance_inputs(&mut self, t: f64, inclusive: bool) {
        let Machine { input_signals, memory, .. } = &mut self.machine;
        loop {
            let next = input_signals.next_breakpoint(memory);
            if next > t || (next == t && !inclusive) {
                break;
            }
            input_signals.advance_past(next, memory);
        }
    }

    /// Records the watched values.
    pub fn put(&mut self, t: f64, values: &[f64], sink: &mut dyn Sink) -> Result<(), Failure> {
        self.machine.set_point(t, &[]);
        for (w, value) in self.watched.iter().zip(values) {
            self.machine.memory[w.slot as usize] = *value;
            if let Some(signal) = w.signal {
                self.machine.memory[signal as usize] = *value;
            }
        }
        if self.has_expressions {
            self.evaluate(t)?;
        }
        let not_finite = |rows: &Self, v: VarId| {
            let name = rows.machine.program.name(v).to_owned();
            let value = rows.machine.value(v);
            let cause = RunCause::NotFinite { time: t, value: NonFinite::Unknown { name, value } };
            let diagnostic = Diagnostic::new(cause, Span::NONE);
            Failure::numerics(t, diagnostic.note(format!("it is a variable of `{}`", rows.file)))
        };
        if let Err(v) = self.recorder.take(&self.machine) {
            return Err(not_finite(self, v));
        }
        self.recorder.put(t, sink);
        self.count += 1;
        self.update_extrema();
        Ok(())
    }

    /// Evaluates the expressions of measures.
    fn evaluate(&mut self, t: f64) -> Result<(), Failure> {
        let program = self.machine.program;
        let tapes = &program.tapes;
        let layout = &program.layout;
        let run = |machine: &mut Machine<'p>| {
            machine.run(&tapes.rhs)?;
            machine.run(&tapes.roots)?;
            for k in 0..program.events.relation_triggers.len() as Slot {
                machine.copy(layout.relations + k, layout.candidates + k);
            }
            if self.count == 0 {
                machine.run(&tapes.initial)?;
            }
            machine.run(&tapes.event)?;
            machine.run(&tapes.discrete)?;
            machine.run(&tapes.rhs)?;
            machine.run(&tapes.roots)?;
            machine.run(&tapes.outputs)?;
            for (_, slot, pre) in &layout.pre {
                machine.copy(*pre, *slot);
            }
            Ok(())
        };
        let outcome = run(&mut self.machine);
        outcome.map_err(|fault| of_fault(&self.machine, fault, t))
    }

    fn update_extrema(&mut self) {
        let machine = &self.machine;
        for (request, best) in &mut self.extrema {
            let is = |v: Option<VarId>, wanted: bool| {
                v.is_none_or(|v| (machine.value(v) != 0.0) == wanted)
            };
            let value = machine.value(request.variable);
            let better = best.is_none_or(|best| (value > best) == request.greatest);
            if better && is(request.after, true) && is(request.before, false) {
                *best = Some(value);
            }
        }
    }

    /// The extrema over all rows.
    pub fn extrema(&self) -> Vec<Option<f64>> {
        self.extrema.iter().map(|(_, best)| *best).collect()
    }
}
