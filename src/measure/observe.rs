//! The observation of a run for measures, and their values after it.

use super::error;
use super::model::{
    KNOWN, expression, happened, held, held_integral, integral, is_internal, stopwatch,
};
use super::text::{Function, Measures};
use crate::base::diag::Problems;
use crate::ir::dae::VariableKind;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Constant, Event};
use crate::runtime::machine::Machine;
use crate::simulate::extrema::ExtremumRequest;
use crate::simulate::record::Sink;
use crate::simulate::run::Statistics;
use crate::simulate::settings::Settings;

/// Measures in a compiled program.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) measures: Measures,
    /// The variables of the user among those that are recorded: they come first.
    pub shown: usize,
    /// The parameters that take the values of the functions, and the one that marks them as known.
    pub(super) values: Vec<VarId>,
    pub(super) known: Option<VarId>,
    /// The parameters that are the measures.
    pub(super) results: Vec<VarId>,
    /// The extreme values that the run must find.
    pub(super) extrema: Vec<ExtremumRequest>,
    /// Name and SI unit of each measure.
    pub columns: Vec<Column>,
}

impl Plan {
    /// Finds the measures in the program, and adds the variables that they need to its recorded ones.
    pub fn new(measures: Measures, program: &mut Program, problems: &mut Problems) -> Option<Plan> {
        let variables = &program.blocks.dae.variables;
        let find = |name: &str| variables.enumerate().find(|(_, v)| v.name == name).map(|(v, _)| v);
        let mut results = Vec::new();
        for measure in &measures.list {
            let v = find(&measure.name)?;
            if variables[v].kind != VariableKind::Parameter {
                problems.push(error::moves(measure.value.span, &measure.name));
                return None;
            }
            results.push(v);
        }
        let values = (0..measures.functions.len())
            .map(|k| find(&Measures::value_name(k)))
            .collect::<Option<Vec<_>>>()?;
        let mut extrema = Vec::new();
        for function in &measures.functions {
            if let Function::ExtremumRequest { of, greatest, range } = function {
                let ever = |c: Option<usize>| c.and_then(|c| find(&happened(c)));
                let (after, before) = (ever(range.from), ever(range.until));
                let variable = find(&expression(*of))?;
                extrema.push(ExtremumRequest { variable, greatest: *greatest, after, before });
            }
        }
        let unit_of =
            |name: &str| find(name).map_or(String::new(), |v| variables[v].unit.to_string());
        let column = |m: &super::text::Measure| Column {
            description: m.text.clone(),
            ..Column::new(m.name.clone(), measures.unit(m, unit_of))
        };
        let columns = measures.list.iter().map(column).collect();
        let known = find(KNOWN);
        let mut plan = Plan { measures, shown: 0, values, known, results, extrema, columns };
        plan.record(program, |_| true);
        Some(plan)
    }

    /// Restricts the recorded variables to those that `keep` accepts and those that measures need.
    pub fn record(&mut self, program: &mut Program, keep: impl Fn(&str) -> bool) {
        let needed = self.needed();
        let own = |name: &str| self.measures.list.iter().any(|m| m.name == name);
        crate::codegen::recording::only(program, |name| {
            if is_internal(name) {
                needed.iter().any(|n| n == name)
            } else {
                !own(name) && keep(name)
            }
        });
        let variables = &program.blocks.dae.variables;
        program.constants.retain(|v| !is_internal(&variables[*v].name));
        // Those of the user first; a stable sort keeps the order of declaration.
        program.recorded.sort_by_key(|v| is_internal(&variables[*v].name));
        let is_shown = |v: &&VarId| !is_internal(&variables[**v].name);
        self.shown = program.recorded.iter().filter(is_shown).count();
    }

    /// Adds the needs of the measures to the settings of a run.
    pub fn ask(&self, settings: &mut Settings) {
        settings.extrema.clone_from(&self.extrema);
    }

    /// The variables whose rows are looked at.
    fn needed(&self) -> Vec<String> {
        let mut all = Vec::new();
        for function in &self.measures.functions {
            match function {
                Function::When(_) => {}
                Function::Initial(e)
                | Function::Final(e)
                | Function::At(e, _)
                | Function::ExtremumRequest { of: e, .. } => all.push(expression(*e)),
                Function::Integral { of, .. } => all.push(integral(*of)),
            }
        }
        all.extend((0..self.measures.conditions.len()).map(happened));
        if self.measures.has_slopes {
            all.extend((0..self.measures.conditions.len()).map(stopwatch));
            for function in &self.measures.functions {
                match function {
                    Function::At(e, c) => all.push(held(*e, *c)),
                    Function::ExtremumRequest { of, .. } => all.push(expression(*of)),
                    Function::Integral { of, range, .. } => {
                        let ends = range.from.iter().chain(&range.until);
                        all.extend(ends.map(|c| held_integral(*of, *c)));
                    }
                    _ => {}
                }
            }
        }
        all
    }

    /// The values of the measures after a run with these settings; none for a condition that never held.
    pub fn evaluate(
        &self,
        program: &Program,
        settings: &Settings,
        seen: &Observer<'_>,
        statistics: &Statistics,
    ) -> Vec<Option<f64>> {
        let mut extrema = statistics.extrema.iter().copied();
        let functions: Vec<Option<f64>> = self
            .measures
            .functions
            .iter()
            .map(|function| match function {
                Function::ExtremumRequest { .. } => extrema.next().flatten(),
                _ => seen.value(function),
            })
            .collect();
        let mut machine = Machine::new(program);
        for &(v, value) in &settings.parameters {
            machine.set_parameter(v, value);
        }
        for (v, value) in self.values.iter().zip(&functions) {
            machine.set_parameter(*v, value.unwrap_or(0.0));
        }
        if let Some(known) = self.known {
            machine.set_parameter(known, 1.0);
        }
        if machine.run(&program.tapes.parameters).is_err() {
            return vec![None; self.results.len()];
        }
        let known = |needs: &[usize]| needs.iter().all(|k| functions[*k].is_some());
        let of = |(v, m): (&VarId, &super::text::Measure)| {
            Some(machine.value(*v)).filter(|x| known(&m.needs) && x.is_finite())
        };
        self.results.iter().zip(&self.measures.list).map(of).collect()
    }
}

/// Takes the rows of a run: the user's columns go on to another sink.
pub struct Observer<'a> {
    inner: &'a mut dyn Sink,
    shown: usize,
    /// Positions in a row: of each expression, integral and Boolean that is recorded.
    expressions: Vec<Option<usize>>,
    integrals: Vec<Option<usize>>,
    booleans: Vec<Option<usize>>,
    /// The first row, the last one, and for each condition time and row when it became true.
    first: Option<(f64, Vec<f64>)>,
    last: (f64, Vec<f64>),
    happened: Vec<Option<(f64, Vec<f64>)>>,
}

impl<'a> Observer<'a> {
    /// Of a run of this program.
    pub fn new(plan: &Plan, program: &Program, inner: &'a mut dyn Sink) -> Self {
        let position = |name: String| {
            let of = |v: &VarId| program.name(*v) == name;
            program.recorded[plan.shown..].iter().position(of)
        };
        let measures = &plan.measures;
        let (e, c) = (measures.expressions.len(), measures.conditions.len());
        Observer {
            inner,
            shown: plan.shown,
            expressions: (0..e).map(|k| position(expression(k))).collect(),
            integrals: (0..e).map(|k| position(integral(k))).collect(),
            booleans: (0..c).map(|k| position(happened(k))).collect(),
            first: None,
            last: (0.0, Vec::new()),
            happened: vec![None; c],
        }
    }

    /// The value of a function other than of an extreme.
    fn value(&self, function: &Function) -> Option<f64> {
        let expression = |e: usize, row: &[f64]| Some(row[self.expressions[e]?]);
        let (first_time, first) = self.first.as_ref()?;
        let (last_time, last) = &self.last;
        match function {
            Function::When(c) => self.happened[*c].as_ref().map(|(t, _)| *t),
            Function::Initial(e) => expression(*e, first),
            Function::Final(e) => expression(*e, last),
            Function::At(e, c) => expression(*e, &self.happened[*c].as_ref()?.1),
            Function::ExtremumRequest { .. } => None,
            Function::Integral { of, range, mean } => {
                let from = match range.from {
                    Some(c) => self.happened[c].as_ref().map(|(t, row)| (*t, row))?,
                    None => (*first_time, first),
                };
                let until = match range.until.and_then(|c| self.happened[c].as_ref()) {
                    Some((t, row)) => (*t, row),
                    None => (*last_time, last),
                };
                let at = self.integrals[*of]?;
                let length = until.0 - from.0;
                if length < 0.0 || (*mean && length == 0.0) {
                    return None;
                }
                let sum = until.1[at] - from.1[at];
                Some(if *mean { sum / length } else { sum })
            }
        }
    }
}

impl Sink for Observer<'_> {
    fn begin(&mut self, mut columns: Vec<Column>) {
        columns.truncate(self.shown);
        self.inner.begin(columns);
    }
    fn expect(&mut self, rows: usize) {
        self.inner.expect(rows);
    }
    fn constants(&mut self, constants: Vec<Constant>) {
        self.inner.constants(constants);
    }
    fn row(&mut self, time: f64, values: &[f64]) {
        let (shown, own) = values.split_at(self.shown);
        for (at, happened) in self.booleans.iter().zip(&mut self.happened) {
            if happened.is_none() && at.is_some_and(|k| own[k] != 0.0) {
                // The row before is that of the same instant, before anything jumped.
                let arrival = if self.last.1.is_empty() || self.last.0 != time {
                    own.to_vec()
                } else {
                    self.last.1.clone()
                };
                *happened = Some((time, arrival));
            }
        }
        if self.first.is_none() {
            self.first = Some((time, own.to_vec()));
        }
        self.last.0 = time;
        self.last.1.clear();
        self.last.1.extend_from_slice(own);
        self.inner.row(time, shown);
    }
    fn event(&mut self, event: Event) {
        self.inner.event(event);
    }
    fn print(&mut self, line: &str, file: &str) {
        self.inner.print(line, file);
    }
    fn goes_on(&mut self, time: f64) -> bool {
        self.inner.goes_on(time)
    }
}
