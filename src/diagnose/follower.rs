//! Parts that pull a model to what was measured: a conductance between a connector and the recorded potential.
//!
//! A large effect drags a free-running model away from the recordings: it breaks away earlier, or reaches a stop that the
//! specimen never reaches, and derivatives along its trajectories say little of what is missing. A model that is pulled to
//! the recordings passes through their events, and what it lacks shows as a small deviation at the instant at which it acts
//! (prediction-error form: L. Ljung, *System Identification*, 2nd ed. 1999, section 7.2; N. R. Kristensen, H. Madsen and
//! S. B. Jørgensen, *Parameter estimation in stochastic grey-box models*, Automatica 40, 2004). At a connector, the
//! correction is a flow: a spring to the recorded position, a restriction to the recorded pressure.

use std::sync::Arc;

use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::calibrate::data::Recording;
use crate::calibrate::plan::{DrivenInput, Plan, Signal};
use crate::flatten::inventory::{Inventory, PotentialFlow};
use crate::ir::expr::VarId;
use crate::ir::flat::FlatModel;
use crate::numeric::time_series::{Interpolation, TimeSeries};

use super::equal_variables::EqualVariables;
use super::variation::states_with_named_rates;

/// A measured potential at connectors.
#[derive(Clone, PartialEq, Debug)]
pub struct MeasuredPotential {
    /// The signal, by its position in the plan.
    pub signal: usize,
    /// The connectors that have it, as `COMPONENT.CONNECTOR`.
    pub ends: Vec<String>,
    /// Full name of the class of the first of them.
    class: String,
    /// Its variables.
    pair: PotentialFlow,
    /// It is a state whose rate is a state as well, as a position is: the correction needs damping.
    has_named_rate: bool,
}

impl MeasuredPotential {
    /// The flow at one of its connectors.
    pub fn flow_at(&self, end: &str) -> String {
        format!("{end}.{}", self.pair.flow.name)
    }
}

/// The measured potentials of a model.
pub fn measured_potentials(
    flat: &FlatModel,
    plan: &Plan,
    inventory: &Inventory,
) -> Vec<MeasuredPotential> {
    let equal_variables = EqualVariables::new(flat);
    let moving: FastSet<VarId> = states_with_named_rates(flat).into_iter().collect();
    let of_signal = |(signal, s): (usize, &Signal)| {
        let (v, _) = flat.variables.enumerate().find(|(_, x)| x.name == s.variable)?;
        let equal = equal_variables.of([v]);
        let names: FastSet<&str> = equal.iter().map(|v| flat.variables[*v].name.as_str()).collect();
        let mut ends = Vec::new();
        let mut first = None;
        for part in inventory.parts.iter().filter(|p| !p.name.is_empty()) {
            for connector in &part.connectors {
                let Some(pair) = &connector.pair else { continue };
                let end = format!("{}.{}", part.name, connector.name);
                if !names.contains(format!("{end}.{}", pair.potential.name).as_str()) {
                    continue;
                }
                // A component may say that the potentials of connectors of different kinds are equal.
                let (_, known) =
                    first.get_or_insert_with(|| (connector.class.clone(), pair.clone()));
                if known == pair {
                    ends.push(end);
                }
            }
        }
        let (class, pair) = first?;
        let has_named_rate = equal.iter().any(|v| moving.contains(v));
        Some(MeasuredPotential { signal, ends, class, pair, has_named_rate })
    };
    plan.signals.iter().enumerate().filter_map(of_signal).collect()
}

/// A part of a trial model that pulls it to a recorded signal.
#[derive(Clone, PartialEq, Debug)]
pub struct Follower {
    /// The signal, by its position in the plan.
    signal: usize,
    class: String,
    end: String,
    pair: PotentialFlow,
    /// Flow for a unit of deviation.
    conductance: f64,
    /// Time for which the rate of the deviation counts as well, s; 0 without damping.
    damping: f64,
}

/// Share of the range of a signal, by which the model deviates where a flow is missing that is as large as the largest one.
const DEVIATION: f64 = 0.2;
/// Intervals between the knots of a recorded signal for which the rate of the deviation counts.
const DAMPED_INTERVALS: f64 = 1.5;
/// Knots of a recorded signal that is followed.
const KNOTS: usize = 300;

impl Follower {
    /// The part for a measured potential, at a connector with this range of flows; `range` is that of the signal, and
    /// `spacing` the time between two knots of its recordings.
    pub fn new(
        measured: &MeasuredPotential,
        end: &str,
        flow: f64,
        range: f64,
        spacing: f64,
    ) -> Self {
        Follower {
            signal: measured.signal,
            class: measured.class.clone(),
            end: end.to_owned(),
            pair: measured.pair.clone(),
            conductance: flow / (DEVIATION * range),
            damping: if measured.has_named_rate { DAMPED_INTERVALS * spacing } else { 0.0 },
        }
    }

    /// The input of the trial model.
    pub fn input(&self) -> String {
        format!("trial_recorded_{}", self.signal + 1)
    }

    /// The input as an entry of a plan.
    pub fn driven(&self, plan: &Plan) -> DrivenInput {
        let signal = &plan.signals[self.signal];
        DrivenInput {
            column: signal.column.clone(),
            input: self.input(),
            unit: signal.unit,
            interpolation: Interpolation::Spline,
            smooth: 0.0,
            every: 1,
            absent: None,
            span: Span::NONE,
        }
    }

    /// What drives it: the recorded signal in SI units.
    pub fn course(&self, plan: &Plan, recording: &Recording) -> Option<TimeSeries> {
        thinned(recording, self.signal, |x| plan.signals[self.signal].unit.to_si(x))
    }

    /// Its declaration in the trial model.
    pub fn declare(&self, out: &mut String) {
        let (k, class, input) = (self.signal + 1, &self.class, self.input());
        let (potential, flow) = (&self.pair.potential.name, &self.pair.flow.name);
        let deviation = format!("to.{potential} - recorded");
        let rate = format!("der(to.{potential}) - der(recorded)");
        let (g, t) = (self.conductance, self.damping);
        let damped = if t > 0.0 { format!(" + {t:e}*({rate})") } else { String::new() };
        out.push_str(&format!(
            "  input Real {input};\n  model TrialFollower_{k}\n    {class} to;\n    input Real recorded;\n  \
             equation\n    to.{flow} = {g:e}*({deviation}{damped});\n  end TrialFollower_{k};\n  \
             TrialFollower_{k} trial_follower_{k}(recorded = {input});\n"
        ));
    }

    /// Its connection.
    pub fn connection(&self) -> String {
        format!("  connect(trial_follower_{}.to, {});\n", self.signal + 1, self.end)
    }
}

/// A signal of a recording with fewer knots, each the mean of the rows around it. `None` without values.
pub fn thinned(
    recording: &Recording,
    signal: usize,
    to_si: impl Fn(f64) -> f64,
) -> Option<TimeSeries> {
    let rows = recording.time.iter().zip(&recording.signals[signal]);
    let rows: Vec<(f64, f64)> =
        rows.filter(|(_, x)| !x.is_nan()).map(|(t, x)| (*t, to_si(*x))).collect();
    let mean = |part: &[(f64, f64)], of: fn(&(f64, f64)) -> f64| {
        part.iter().map(of).sum::<f64>() / part.len() as f64
    };
    let parts = || rows.chunks(rows.len().div_ceil(KNOTS).max(1));
    let times: Vec<f64> = parts().map(|part| mean(part, |(t, _)| *t)).collect();
    let values: Vec<f64> = parts().map(|part| mean(part, |(_, x)| *x)).collect();
    (!times.is_empty()).then(|| TimeSeries::new(times.into(), values, Interpolation::Spline))
}

/// What drives the followers in a recording; `None` if a signal has no values there.
pub fn courses(
    followers: &[Follower],
    plan: &Plan,
    recording: &Recording,
) -> Option<Vec<Arc<TimeSeries>>> {
    followers.iter().map(|f| f.course(plan, recording).map(Arc::new)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::data::Split;
    use crate::flatten::inventory::ConnectorVariable;

    /// The means of the parts of a straight line are on that line, gaps are left out, and there are no more knots than wanted.
    #[test]
    fn a_thinned_line_is_the_line() {
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
        let row = |t: &f64| if (0.5..0.6).contains(t) { f64::NAN } else { 1e3 * (2.0 + 3.0 * t) };
        let recording = Recording {
            of: String::new(),
            name: String::new(),
            path: std::path::PathBuf::new(),
            split: Split::Train,
            conditions: Vec::new(),
            starts: Vec::new(),
            courses: Vec::new(),
            start: None,
            signals: vec![time.iter().map(row).collect()],
            time: time.into(),
        };
        let line = thinned(&recording, 0, |x| 1e-3 * x).expect("values");
        for t in [0.1, 0.55, 1.234, 1.9] {
            assert!((line.value(t, 0) - (2.0 + 3.0 * t)).abs() < 1e-9, "{}", line.value(t, 0));
            assert!((line.value(t, 1) - 3.0).abs() < 1e-6);
        }
        assert!(line.spacing() >= 2.0 / KNOTS as f64 - 1e-9);
    }

    /// A flow as large as the largest one deviates by the share of the range; a position is damped as well.
    #[test]
    fn a_follower_is_a_conductance() {
        let variable =
            |name: &str, unit: &str| ConnectorVariable { name: name.into(), unit: unit.into() };
        let measured = |has_named_rate| MeasuredPotential {
            signal: 2,
            ends: vec!["mass.flange".to_owned()],
            class: "Translational.Flange".to_owned(),
            pair: PotentialFlow { potential: variable("s", "m"), flow: variable("f", "N") },
            has_named_rate,
        };
        let source = |has_named_rate| {
            let mut out = String::new();
            let follower =
                Follower::new(&measured(has_named_rate), "mass.flange", 100.0, 0.01, 1.0);
            follower.declare(&mut out);
            out + &follower.connection()
        };
        let plain = source(false);
        assert!(plain.contains("to.f = 5e4*(to.s - recorded);"), "{plain}");
        assert!(plain.contains("connect(trial_follower_3.to, mass.flange);"), "{plain}");
        let damped = source(true);
        let rate = "+ 1.5e0*(der(to.s) - der(recorded))";
        assert!(damped.contains(rate), "{damped}");
    }
}
