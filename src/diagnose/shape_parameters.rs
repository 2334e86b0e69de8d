//! The shape parameters with which effects are scored, derived from the ranges that their variables cover.

use crate::base::diag::Problems;
use crate::base::index::FastMap;
use crate::calibrate::data::Split;
use crate::calibrate::problem::Problem;

use super::catalogue::{Effect, Start, UNIT_ZERO};
use super::hypothesis::{Hypothesis, attached};
use super::model_source::Attached;
use super::place::Place;
use super::result::unit;
use super::study::Study;

/// The range of a variable of an effect at a place.
pub type Ranges = Vec<((usize, Place), String, (f64, f64))>;

/// Effects call the time so.
const TIME: &str = "t";

/// The range of a variable, if it is known.
fn range_of(ranges: &Ranges, effect: usize, place: &Place, variable: &str) -> Option<(f64, f64)> {
    let found = ranges.iter().find(|((k, p), v, _)| *k == effect && p == place && v == variable);
    found.map(|(.., range)| *range)
}

/// Effects call the magnitude of a quantity so, with its name.
const MAGNITUDE: &str = "size_of_";

/// Share of the greatest magnitude of a quantity which the least one must not exceed, so that the quantity matters to a law
/// that follows its course in time.
const HARDLY_CHANGES: f64 = 0.8;

/// The shapes with which an effect is scored at a place. `None` if the range of a variable that they depend on is not known,
/// for the model cannot be simulated with it there, or if a law that follows the course of a quantity would say no more than
/// that time passes, since the quantity hardly changes.
pub fn shapes_at(
    study: &Study,
    ranges: &Ranges,
    effect: usize,
    place: &Place,
) -> Option<Vec<Vec<(String, f64)>>> {
    let known = |v: &str| range_of(ranges, effect, place, v);
    let parameters = &study.effects[effect].shape_parameters;
    let mut variables = parameters.iter().flat_map(|(_, starts)| starts).flat_map(Start::variables);
    let is_known = variables.all(|v| known(v).is_some());
    let hardly_changes = |start: &Start| match start {
        Start::Greatest(v) if v.starts_with(MAGNITUDE) => {
            known(v).is_some_and(|(low, high)| low > 0.0 && low > HARDLY_CHANGES * high)
        }
        _ => false,
    };
    let mut starts = parameters.iter().flat_map(|(_, starts)| starts);
    let says_time = study.effects[effect].follows_line && starts.any(hardly_changes);
    (is_known && !says_time)
        .then(|| shapes(&study.effects[effect], |v| known(v).unwrap_or_default()))
}

/// The zero of the unit of the column that a sensor fills, in the unit of its variable, as a range.
fn unit_zero(study: &Study, place: &Place) -> (f64, f64) {
    let zero = place.signal.map_or(0.0, |k| study.plan.signals[k].unit.offset);
    (zero, zero)
}

/// The ranges that the variables of effects cover at their places.
pub fn ranges(study: &Study, hypothesis: &Hypothesis, all: &[(usize, Place)]) -> Ranges {
    let mut out = Ranges::new();
    let (known, time) = (ranges_of_model(study, hypothesis, all), time_range(study));
    let mut wanted: Vec<(usize, &Place, Vec<String>)> = Vec::new();
    for (k, place) in all {
        let effect = &study.effects[*k];
        let starts = effect.shape_parameters.iter().flat_map(|(_, starts)| starts);
        let mut variables: Vec<&str> = starts.flat_map(Start::variables).collect();
        variables.sort_unstable();
        variables.dedup();
        let mut probed = Vec::new();
        for v in variables {
            let range = match v {
                UNIT_ZERO => Some(unit_zero(study, place)),
                _ if is_time(effect, v) => Some(time),
                _ => Bound::of(place, v).and_then(|bound| bound.range(&known)),
            };
            match range {
                Some(range) => out.push(((*k, place.clone()), v.to_owned(), range)),
                None => probed.push(v.to_owned()),
            }
        }
        if !probed.is_empty() {
            wanted.push((*k, place, probed));
        }
    }
    for batch in wanted.chunks(study.policy.batch) {
        probe(study, hypothesis, batch, &mut out);
    }
    out
}

/// A variable of an effect that follows from a variable of the model without the effect: an input, or its magnitude.
struct Bound<'a> {
    variable: &'a str,
    is_magnitude: bool,
}

impl<'a> Bound<'a> {
    fn of(place: &'a Place, own: &str) -> Option<Bound<'a>> {
        let input = own.strip_prefix(MAGNITUDE);
        let is_bound = |(name, _): &&(String, String)| name == input.unwrap_or(own);
        let (_, variable) = place.binds.iter().find(is_bound)?;
        Some(Bound { variable, is_magnitude: input.is_some() })
    }

    fn range(&self, known: &FastMap<String, (f64, f64)>) -> Option<(f64, f64)> {
        let (low, high) = *known.get(self.variable)?;
        Some(match self.is_magnitude {
            true if low <= 0.0 && high >= 0.0 => (0.0, high.max(-low)),
            true => (low.abs().min(high.abs()), low.abs().max(high.abs())),
            false => (low, high),
        })
    }
}

/// The ranges of the variables of the model that inputs of effects are bound to, from one run without them: each effect that
/// is attached costs steps. Empty if the model cannot be simulated.
fn ranges_of_model(
    study: &Study,
    hypothesis: &Hypothesis,
    all: &[(usize, Place)],
) -> FastMap<String, (f64, f64)> {
    let mut names: Vec<String> = Vec::new();
    for (_, variable) in all.iter().flat_map(|(_, place)| &place.binds) {
        if !names.contains(variable) {
            names.push(variable.clone());
        }
    }
    let plan = &hypothesis.plan;
    let effects = attached(study, &hypothesis.effects);
    let found = study.compile(plan, &effects, &names).ok().and_then(|(session, program)| {
        names.retain(|name| program.recorded.iter().any(|v| program.name(*v) == name));
        let mut problems = Problems::new();
        let problem = Problem::new(&program, &session.sources, plan, &study.data, &mut problems)?;
        problem.ranges(&problem.start(), &names).ok()
    });
    names.into_iter().zip(found.unwrap_or_default()).collect()
}

/// Adds the ranges at some places. If they cannot be simulated together, each half is tried by itself; a
/// place that cannot be simulated even alone has no range.
fn probe(
    study: &Study,
    hypothesis: &Hypothesis,
    wanted: &[(usize, &Place, Vec<String>)],
    out: &mut Ranges,
) {
    let mut probes = attached(study, &hypothesis.effects);
    let mut names = Vec::new();
    let time = time_range(study);
    for (i, (k, place, variables)) in wanted.iter().enumerate() {
        let name = format!("probe_{i}");
        names.extend(variables.iter().map(|v| format!("{name}.{v}")));
        let effect = &study.effects[*k];
        probes.push(Attached::new(effect, place, name, shape_in_time(effect, time)));
    }
    let plan = &hypothesis.plan;
    let found = study.compile(plan, &probes, &names).ok().and_then(|(session, program)| {
        let mut problems = Problems::new();
        let problem = Problem::new(&program, &session.sources, plan, &study.data, &mut problems)?;
        problem.ranges(&problem.start(), &names).ok()
    });
    let Some(found) = found else {
        let half = wanted.len() / 2;
        if half > 0 {
            probe(study, hypothesis, &wanted[..half], out);
            probe(study, hypothesis, &wanted[half..], out);
        }
        return;
    };
    let mut found = found.into_iter();
    for (k, place, variables) in wanted {
        for v in variables {
            out.extend(found.next().map(|range| ((*k, (*place).clone()), v.clone(), range)));
        }
    }
}

/// True for the variable of an effect that is the time.
fn is_time(effect: &Effect, variable: &str) -> bool {
    variable == TIME && unit(effect, variable) == "s"
}

/// The times that the training recordings cover, s.
fn time_range(study: &Study) -> (f64, f64) {
    let times = study.data.of(Split::Train).flat_map(|r| r.start.iter().chain(r.time.iter()));
    times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(*t), b.max(*t)))
}

/// The shape parameters that depend on the range of time alone. Their defaults suit recordings of seconds: over hours they
/// would be so short that nothing could be simulated.
fn shape_in_time(effect: &Effect, time: (f64, f64)) -> Vec<(String, f64)> {
    let of = |(name, starts): &(String, Vec<Start>)| {
        let first = starts.first()?;
        let mut variables = first.variables().peekable();
        let depends = variables.peek().is_some() && variables.all(|v| is_time(effect, v));
        let value = *first.values(|_| time).first().filter(|_| depends)?;
        Some((name.clone(), value))
    };
    effect.shape_parameters.iter().filter_map(of).collect()
}

/// All combinations of the starts of an effect's shape parameters.
pub fn shapes(effect: &Effect, range: impl Fn(&str) -> (f64, f64)) -> Vec<Vec<(String, f64)>> {
    let mut out = vec![Vec::new()];
    for (name, starts) in &effect.shape_parameters {
        let values: Vec<f64> = starts.iter().flat_map(|s| s.values(&range)).collect();
        out = out
            .iter()
            .flat_map(|shape: &Vec<(String, f64)>| {
                values.iter().map(|v| {
                    let mut longer = shape.clone();
                    longer.push((name.clone(), *v));
                    longer
                })
            })
            .collect();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_scales_follow_from_the_time_alone() {
        let shapes = |pairs: &[(&str, Start)]| {
            pairs.iter().map(|(name, start)| ((*name).to_owned(), vec![start.clone()])).collect()
        };
        let effect = Effect {
            shape_parameters: shapes(&[
                ("T_min", Start::Multiple(1e-5, "t".into())),
                ("r_max", Start::MultipleOfRate(2.0, "u".into(), "t".into())),
                ("w", Start::Multiple(0.1, "u".into())),
                ("n", Start::Value(3.0)),
            ]),
            units: vec![("t".into(), "s".into())],
            ..Effect::default()
        };
        // A recording from 600 s to 7800 s.
        let known = shape_in_time(&effect, (600.0, 7800.0));
        assert_eq!(known.len(), 1, "{known:?}");
        assert_eq!(known[0].0, "T_min");
        assert!((known[0].1 - 0.072).abs() < 1e-12, "{known:?}");
        // Another quantity of this name is not the time.
        let of_other = Effect { units: vec![("t".into(), "K".into())], ..effect };
        assert_eq!(shape_in_time(&of_other, (600.0, 7800.0)), []);
    }
}
