//! Exact derivatives of measures by parameters and start values.
//!
//! *In:* the rows of a run with sensitivities, whose model has the variables of [`super::model`] for them. *Out:* the
//! derivatives of each measure. A time is the final value of a state that counts until then, a value at an event is that of
//! a discrete variable that keeps it, and both have exact sensitivities where the event moves. The derivative of an extreme
//! value is that of its variable at a fixed time, because its rate is 0 there (J. M. Danskin, *The Theory of Max-Min*,
//! 1967); one at an event has none, and is left to differences. The arithmetic between the functions is differentiated by
//! tangents along the tape that computes it.

use std::sync::Arc;

use super::model::{expression, held, held_integral, integral, stopwatch};
use super::observe::Plan;
use super::text::Function;
use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::ir::trajectory::{Column, Event};
use crate::runtime::machine::Machine;
use crate::runtime::tangent::Tangents;
use crate::simulate::record::Sink;
use crate::simulate::sensitivity::{Input, with_inputs};
use crate::simulate::settings::Settings;

/// Difference of two values of a measure, relative to it, that the error of integration explains.
const AGREEMENT: f64 = 1e-3;
/// Distance of an extreme value from an event at which it belongs to the event, relative to the length of the run.
const NEAR: f64 = 1e-9;

/// Takes the rows of a run with sensitivities.
pub struct SlopeRows {
    /// The instants of the extreme values, s.
    instants: Arc<[f64]>,
    time: f64,
    first: Option<Row>,
    last: Row,
    at: Vec<(f64, Row)>,
    events: Vec<f64>,
}

#[derive(Clone, Default)]
struct Row {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl SlopeRows {
    /// For the extreme values at these instants, s, and the settings of the run that takes them.
    pub fn new(times: &[f64], settings: &mut Settings) -> SlopeRows {
        let mut all: Vec<f64> = times.to_vec();
        all.retain(|t| *t > settings.start && *t < settings.stop);
        all.sort_by(f64::total_cmp);
        all.dedup();
        let instants: Arc<[f64]> = all.iter().copied().chain([settings.stop]).collect();
        settings.instants = Some(Arc::clone(&instants));
        let (first, last, at, events) = (None, Row::default(), Vec::new(), Vec::new());
        SlopeRows { instants, time: settings.start, first, last, at, events }
    }
}

impl Sink for SlopeRows {
    fn begin(&mut self, _columns: Vec<Column>) {}
    fn row(&mut self, time: f64, values: &[f64]) {
        self.time = time;
        self.last.values = values.to_vec();
    }
    fn slopes(&mut self, slopes: &[f64]) {
        self.last.slopes = slopes.to_vec();
        if self.first.is_none() {
            self.first = Some(self.last.clone());
        }
        if self.instants.contains(&self.time) {
            self.at.push((self.time, self.last.clone()));
        }
    }
    fn event(&mut self, event: Event) {
        self.events.push(event.time);
    }
}

impl Plan {
    /// The derivatives of each measure by each input; none if one of them has none. `values` are those of the measures in a
    /// run without sensitivities, and `times` those of its extreme values, s.
    pub fn slopes(
        &self,
        program: &Program,
        settings: &Settings,
        inputs: &[Input],
        rows: &SlopeRows,
        values: &[Option<f64>],
        times: &[f64],
    ) -> Option<Vec<Vec<f64>>> {
        let functions =
            Functions { plan: self, program, settings, count: inputs.len(), rows, times };
        let all = functions.all()?;
        let settings = with_inputs(program, settings, inputs)?;
        let mut machine = Machine::new(program);
        let known = self.known.iter().map(|v| (*v, 1.0));
        let values_of = self.values.iter().zip(&all).map(|(v, (value, _))| (*v, *value));
        for (v, value) in settings.parameters.iter().copied().chain(values_of).chain(known) {
            machine.set_parameter(v, value);
        }
        for &(v, value) in &settings.starts {
            machine.set_start(v, value);
        }
        machine.run(&program.tapes.parameters).ok()?;
        let mut tangents = Tangents::new(program.image.len(), inputs.len());
        for (direction, input) in inputs.iter().enumerate() {
            if let Input::Parameter(v) = input {
                tangents.of_mut(parameter_slot(program, *v)?)[direction] = 1.0;
            }
        }
        for (v, (_, slopes)) in self.values.iter().zip(&all) {
            tangents.of_mut(parameter_slot(program, *v)?).copy_from_slice(slopes);
        }
        tangents.propagate(&mut machine, &program.tapes.parameters).ok()?;
        let mut out = Vec::new();
        for (v, value) in self.results.iter().zip(values) {
            let again = machine.value(*v);
            // The variables of the derivatives must have seen the same: a condition that is true from the start has no event.
            if (again - (*value)?).abs() > AGREEMENT * again.abs().max(1e-9) {
                return None;
            }
            let slopes = tangents.of(program.slot(*v)).to_vec();
            out.push(slopes.iter().all(|x| x.is_finite()).then_some(slopes)?);
        }
        Some(out)
    }
}

fn parameter_slot(program: &Program, v: VarId) -> Option<Slot> {
    let inputs = &program.layout.parameter_inputs;
    inputs.iter().find(|(p, _)| *p == v).map(|(_, slot)| *slot)
}

/// The functions of the measures of a run.
struct Functions<'a> {
    plan: &'a Plan,
    program: &'a Program,
    settings: &'a Settings,
    count: usize,
    rows: &'a SlopeRows,
    times: &'a [f64],
}

type Sloped = (f64, Vec<f64>);

impl Functions<'_> {
    /// Value and derivatives of each.
    fn all(&self) -> Option<Vec<Sloped>> {
        let mut times = self.times.iter();
        let mut out = Vec::new();
        for function in &self.plan.measures.functions {
            out.push(match function {
                Function::When(c) => self.moved(self.of(&stopwatch(*c), &self.rows.last)?),
                Function::Initial(e) => self.of(&expression(*e), self.rows.first.as_ref()?)?,
                Function::Final(e) => self.of(&expression(*e), &self.rows.last)?,
                Function::At(e, c) => self.of(&held(*e, *c), &self.rows.last)?,
                Function::ExtremumRequest { of, .. } => self.extremum(*of, *times.next()?)?,
                Function::Integral { of, range, mean } => {
                    let begin = match range.from {
                        Some(c) => self.of(&held_integral(*of, c), &self.rows.last)?,
                        None => self.of(&integral(*of), self.rows.first.as_ref()?)?,
                    };
                    let happened = range.until.filter(|c| self.has_happened(*c));
                    let end = match happened {
                        Some(c) => self.of(&held_integral(*of, c), &self.rows.last)?,
                        None => self.of(&integral(*of), &self.rows.last)?,
                    };
                    let sum = self.minus(&end, &begin);
                    if *mean {
                        let time = |c: Option<usize>, otherwise: f64| match c {
                            Some(c) => {
                                self.of(&stopwatch(c), &self.rows.last).map(|t| self.moved(t))
                            }
                            None => Some((otherwise, vec![0.0; self.count])),
                        };
                        let from = time(range.from, self.settings.start)?;
                        let length = self.minus(&time(happened, self.rows.time)?, &from);
                        let mean = sum.0 / length.0;
                        let each = sum.1.iter().zip(&length.1);
                        (mean, each.map(|(s, l)| (s - mean * l) / length.0).collect())
                    } else {
                        sum
                    }
                }
            });
        }
        Some(out)
    }

    /// A stopwatch starts at 0.
    fn moved(&self, (value, slopes): Sloped) -> Sloped {
        (self.settings.start + value, slopes)
    }

    fn minus(&self, a: &Sloped, b: &Sloped) -> Sloped {
        (a.0 - b.0, a.1.iter().zip(&b.1).map(|(a, b)| a - b).collect())
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.program.recorded.iter().position(|v| self.program.name(*v) == name)
    }

    /// A variable in a row.
    fn of(&self, name: &str, row: &Row) -> Option<Sloped> {
        let k = self.position(name)?;
        let slopes = row.slopes.get(k * self.count..(k + 1) * self.count)?;
        Some((*row.values.get(k)?, slopes.to_vec()))
    }

    fn has_happened(&self, c: usize) -> bool {
        let position = self.position(&super::model::happened(c));
        position.and_then(|k| self.rows.last.values.get(k)).is_some_and(|x| *x != 0.0)
    }

    /// The extreme value of an expression at `t`, s.
    fn extremum(&self, e: usize, t: f64) -> Option<Sloped> {
        let name = expression(e);
        if t == self.settings.start {
            return self.of(&name, self.rows.first.as_ref()?);
        }
        let near = NEAR * (self.settings.stop - self.settings.start);
        if self.rows.events.iter().any(|at| (at - t).abs() <= near) {
            return None;
        }
        let row = self.rows.at.iter().find(|(at, _)| *at == t).map(|(_, row)| row)?;
        self.of(&name, row)
    }
}
