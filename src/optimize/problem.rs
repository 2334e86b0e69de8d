//! A design in the search: coordinates in, measures and their derivatives out.

use std::cell::Cell;

use super::plan::Plan as DesignPlan;
use crate::base::source::SourceMap;
use crate::calibrate::parameter::Parameter;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Event};
use crate::measure::observe::{Observer, Plan};
use crate::measure::slopes::SlopeRows;
use crate::numeric::sqp::{Constrained, Gradients, Values};
use crate::simulate::failure::Failure;
use crate::simulate::record::Sink;
use crate::simulate::run::{simulate_to, simulate_with_sensitivities};
use crate::simulate::sensitivity::Input;
use crate::simulate::settings::Settings;

/// Distance of differences, in coordinates of the search.
const DISPLACEMENT: f64 = 1e-3;
/// Ratio of the ends of a range from which its logarithm is the coordinate.
const WIDE: f64 = 5.0;

/// A range as `0..=1`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Coordinate {
    low: f64,
    high: f64,
    is_logarithmic: bool,
}

impl Coordinate {
    /// Logarithmic for positive values of different sizes.
    pub fn of(low: f64, high: f64) -> Coordinate {
        Coordinate { low, high, is_logarithmic: low > 0.0 && high / low >= WIDE }
    }

    /// The value at `u`.
    pub fn value(self, u: f64) -> f64 {
        match u {
            0.0 => self.low,
            1.0 => self.high,
            _ if self.is_logarithmic => self.low * (self.high / self.low).powf(u),
            _ => self.low + u * (self.high - self.low),
        }
    }

    /// The coordinate of a value.
    pub fn place(self, value: f64) -> f64 {
        match self.is_logarithmic {
            true => (value / self.low).ln() / (self.high / self.low).ln(),
            false => (value - self.low) / (self.high - self.low),
        }
    }

    /// Derivative of the value at `u`.
    fn slope(self, u: f64) -> f64 {
        match self.is_logarithmic {
            true => self.value(u) * (self.high / self.low).ln(),
            false => self.high - self.low,
        }
    }
}

/// A bound of a measure as `sign * (measure - bound) / scale <= 0`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bound {
    /// Position of the measure.
    pub measure: usize,
    /// 1 for a greatest value, -1 for a least.
    pub sign: f64,
    /// The bound, SI.
    pub bound: f64,
    /// Size of the measure.
    pub scale: f64,
}

/// What all searches share.
pub struct Shared<'a> {
    /// The compiled model.
    pub program: &'a Program,
    /// Its sources.
    pub sources: &'a SourceMap,
    /// Its measures: those of the limits, then the goal.
    pub measures: &'a Plan,
    /// Settings of all runs.
    pub settings: Settings,
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    /// Their coordinates.
    pub coordinates: Vec<Coordinate>,
    /// The bounds of the measures.
    pub bounds: Vec<Bound>,
    /// Position of the goal among the measures.
    pub goal: usize,
    /// 1 if it is to be least, -1 if greatest, divided by its size.
    pub weight: f64,
    /// True once the search is to end.
    pub is_cancelled: &'a (dyn Fn() -> bool + Sync),
}

/// The measures of a run, and the times of their extreme values, s.
#[derive(Clone, PartialEq, Debug)]
pub struct Measured {
    /// None for a condition that never held.
    pub values: Vec<Option<f64>>,
    times: Vec<f64>,
}

impl Shared<'_> {
    /// The values of the parameters at a point of the search.
    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.coordinates).map(|(x, c)| c.value(*x)).collect()
    }

    /// The settings of a run with these values of the parameters.
    pub fn settings(&self, values: &[f64]) -> Settings {
        let mut settings = self.settings.clone();
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter.targets.iter().for_each(|target| settings.set(*target, *value));
        }
        settings
    }

    /// Runs the model with these values of the parameters; the rows go to `sink`.
    pub fn run(&self, values: &[f64], sink: &mut dyn Sink) -> Result<Measured, Failure> {
        let mut settings = self.settings(values);
        self.measures.ask(&mut settings);
        let mut observer = Observer::new(self.measures, self.program, sink);
        let ended = simulate_to(self.program, &settings, self.sources, &mut observer)?;
        let values = self.measures.evaluate(self.program, &settings, &observer, &ended);
        Ok(Measured { values, times: ended.extremum_times })
    }

    /// The goal and the bounds as the search sees them.
    fn seen(&self, measured: &Measured) -> Option<Values> {
        let f = self.weight * measured.values[self.goal]?;
        let of = |b: &Bound| Some(b.sign * (measured.values[b.measure]? - b.bound) / b.scale);
        Some(Values { f, c: self.bounds.iter().map(of).collect::<Option<_>>()? })
    }
}

/// One search.
pub struct Search<'a> {
    shared: &'a Shared<'a>,
    last: Option<(Vec<f64>, Measured)>,
    /// Runs, and gradients from sensitivities and from differences.
    pub runs: u32,
    /// Gradients from sensitivities.
    pub exact: u32,
    /// Gradients from differences.
    pub differences: u32,
    /// Why the last run failed.
    pub failure: Option<Failure>,
}

impl<'a> Search<'a> {
    /// A search that has not begun.
    pub fn new(shared: &'a Shared<'a>) -> Search<'a> {
        Search { shared, last: None, runs: 0, exact: 0, differences: 0, failure: None }
    }

    fn measured(&mut self, x: &[f64]) -> Option<Measured> {
        if let Some((at, measured)) = &self.last
            && at == x
        {
            return Some(measured.clone());
        }
        self.runs += 1;
        let mut nothing =
            Nothing { is_cancelled: self.shared.is_cancelled, ended: Cell::new(false) };
        match self.shared.run(&self.shared.values(x), &mut nothing) {
            Ok(measured) if !nothing.ended.get() => {
                self.last = Some((x.to_vec(), measured.clone()));
                Some(measured)
            }
            Ok(_) => None,
            Err(failure) => {
                self.failure = Some(failure);
                None
            }
        }
    }

    /// The derivatives of all measures by the coordinates, from the sensitivities of a run.
    fn exact_slopes(&mut self, x: &[f64], measured: &Measured) -> Option<Vec<Vec<f64>>> {
        let shared = self.shared;
        let inputs: Vec<Input> =
            shared.parameters.iter().flat_map(|p| p.targets.iter().copied()).collect();
        let mut settings = shared.settings(&shared.values(x)).without_grid();
        let mut rows = SlopeRows::new(&measured.times, &mut settings);
        let (program, sources) = (shared.program, shared.sources);
        self.runs += 1;
        simulate_with_sensitivities(program, &settings, &inputs, sources, &mut rows).ok()?;
        let (values, times) = (&measured.values, &measured.times);
        let all = shared.measures.slopes(program, &settings, &inputs, &rows, values, times)?;
        let by_coordinates = |slopes: Vec<f64>| {
            let mut first = 0;
            let of = |((p, c), u): ((&Parameter, &Coordinate), &f64)| {
                let sum: f64 = slopes[first..first + p.targets.len()].iter().sum();
                first += p.targets.len();
                sum * c.slope(*u)
            };
            shared.parameters.iter().zip(&shared.coordinates).zip(x).map(of).collect()
        };
        Some(all.into_iter().map(by_coordinates).collect())
    }

    /// The same by differences, one-sided at the ends of a range.
    fn difference_slopes(&mut self, x: &[f64], here: &Measured) -> Option<Vec<Vec<f64>>> {
        let kept = self.last.clone();
        let mut slopes = vec![vec![0.0; x.len()]; here.values.len()];
        for j in 0..x.len() {
            let mut side = |distance: f64| {
                let mut moved = x.to_vec();
                moved[j] = (x[j] + distance).clamp(0.0, 1.0);
                let values = self.measured(&moved).map(|m| m.values);
                (moved[j], values.unwrap_or_else(|| vec![None; here.values.len()]))
            };
            let (above, below) = (side(DISPLACEMENT), side(-DISPLACEMENT));
            for (k, slopes) in slopes.iter_mut().enumerate() {
                // Where one side does not exist, the other serves.
                let end = |side: &(f64, Vec<Option<f64>>)| {
                    side.1[k].map_or((x[j], here.values[k]), |v| (side.0, Some(v)))
                };
                let ((a, f), (b, g)) = (end(&above), end(&below));
                slopes[j] = (f? - g?) / (a - b);
                if !slopes[j].is_finite() {
                    return None;
                }
            }
        }
        self.last = kept;
        Some(slopes)
    }
}

impl Constrained for Search<'_> {
    fn values(&mut self, x: &[f64]) -> Option<Values> {
        let measured = self.measured(x)?;
        self.shared.seen(&measured)
    }

    fn gradients(&mut self, x: &[f64]) -> Option<Gradients> {
        let measured = self.measured(x)?;
        self.shared.seen(&measured)?;
        let slopes = match self.exact_slopes(x, &measured) {
            Some(slopes) => {
                self.exact += 1;
                slopes
            }
            None => {
                self.differences += 1;
                self.difference_slopes(x, &measured)?
            }
        };
        let shared = self.shared;
        let scaled = |k: usize, by: f64| slopes[k].iter().map(|s| by * s).collect();
        Some(Gradients {
            f: scaled(shared.goal, shared.weight),
            c: shared.bounds.iter().map(|b| scaled(b.measure, b.sign / b.scale)).collect(),
        })
    }

    fn accepts_step(&mut self, _iteration: u32, _x: &[f64], _values: &Values) -> bool {
        !(self.shared.is_cancelled)()
    }
}

/// Takes rows that nobody needs.
struct Nothing<'a> {
    is_cancelled: &'a (dyn Fn() -> bool + Sync),
    ended: Cell<bool>,
}

impl Sink for Nothing<'_> {
    fn begin(&mut self, _columns: Vec<Column>) {}
    fn wants_constants(&self) -> bool {
        false
    }
    fn row(&mut self, _time: f64, _values: &[f64]) {}
    fn event(&mut self, _event: Event) {}
    fn goes_on(&mut self, _time: f64) -> bool {
        self.ended.set((self.is_cancelled)());
        !self.ended.get()
    }
}

/// The bounds of a plan; `measured` are the measures at the start, by which they are scaled.
pub fn bounds(plan: &DesignPlan, measured: &[Option<f64>]) -> Vec<Bound> {
    let mut out = Vec::new();
    for (measure, limit) in plan.limits.iter().enumerate() {
        for (sign, bound) in [(-1.0, &limit.min), (1.0, &limit.max)] {
            let Some(bound) = bound.as_ref().map(|v| v.quantity.value) else { continue };
            let here = measured[measure].unwrap_or(0.0).abs();
            let scale = if bound != 0.0 { bound.abs() } else { size(here) };
            out.push(Bound { measure, sign, bound, scale });
        }
    }
    out
}

/// A number by which others are divided.
pub fn size(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() { 1.0 } else { value.abs() }
}
