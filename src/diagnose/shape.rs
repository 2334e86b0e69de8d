//! The shapes that effects are scored with: from the ranges that their variables cover.

use crate::base::diag::Problems;
use crate::calibrate::problem::Problem;

use super::case::{Case, compile};
use super::effect::Effect;
use super::level::{Level, attached};
use super::place::Place;
use super::text::Attached;

/// Places that are looked at in one run.
const BATCH: usize = 48;

/// The range of a variable of an effect at a place.
pub type Ranges = Vec<((usize, Place), String, (f64, f64))>;

/// The range of a variable; from zero to one where none is known.
pub fn ranges_of(ranges: &Ranges, effect: usize, place: &Place, variable: &str) -> (f64, f64) {
    let found = ranges.iter().find(|((k, p), v, _)| *k == effect && p == place && v == variable);
    found.map_or((0.0, 1.0), |(.., range)| *range)
}

/// The ranges that the variables of effects cover at their places.
pub fn ranges(case: &Case<'_>, level: &Level, all: &[(usize, Place)]) -> Ranges {
    let mut out = Ranges::new();
    let mut wanted: Vec<(usize, &Place, Vec<String>)> = Vec::new();
    for (k, place) in all {
        let mut variables: Vec<String> = Vec::new();
        for start in case.effects[*k].shapes.iter().flat_map(|(_, starts)| starts) {
            if let Some(v) = start.variable()
                && !variables.iter().any(|known| known == v)
            {
                variables.push(v.to_owned());
            }
        }
        if !variables.is_empty() {
            wanted.push((*k, place, variables));
        }
    }
    for batch in wanted.chunks(BATCH) {
        probe(case, level, batch, &mut out);
    }
    out
}

/// Adds the ranges at some places. Where a run with all of them fails, each half is tried by itself; a
/// place that can not be probed even alone has no range.
fn probe(
    case: &Case<'_>,
    level: &Level,
    wanted: &[(usize, &Place, Vec<String>)],
    out: &mut Ranges,
) {
    let mut probes = attached(case, &level.chosen);
    let mut names = Vec::new();
    for (i, (k, place, variables)) in wanted.iter().enumerate() {
        let name = format!("probe_{i}");
        names.extend(variables.iter().map(|v| format!("{name}.{v}")));
        let effect = &case.effects[*k];
        probes.push(Attached { effect, place, name, values: Vec::new() });
    }
    let found = compile(case, &level.plan, &probes, &names).ok().and_then(|(session, program)| {
        let mut problems = Problems::new();
        let problem =
            Problem::new(&program, &session.sources, &level.plan, case.data, &mut problems)?;
        problem.ranges(&problem.start(), &names).ok()
    });
    let Some(found) = found else {
        let half = wanted.len() / 2;
        if half > 0 {
            probe(case, level, &wanted[..half], out);
            probe(case, level, &wanted[half..], out);
        }
        return;
    };
    let mut found = found.into_iter();
    for (k, place, variables) in wanted {
        for v in variables {
            let range = found.next().unwrap_or((0.0, 1.0));
            out.push(((*k, (*place).clone()), v.clone(), range));
        }
    }
}

/// All combinations of what the parameters of a shape start from.
pub fn shapes(effect: &Effect, range: impl Fn(&str) -> (f64, f64)) -> Vec<Vec<(String, f64)>> {
    let mut out = vec![Vec::new()];
    for (name, starts) in &effect.shapes {
        let values: Vec<f64> =
            starts.iter().flat_map(|s| s.values(s.variable().map_or((0.0, 1.0), &range))).collect();
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
