//! The hypotheses that the recordings cannot tell from the best one, and the sensors that would.

use crate::base::diag::Problems;
use crate::calibrate::data::{Recording, Split};
use crate::calibrate::problem::Problem;

use super::hypothesis::{ChosenEffect, Hypothesis, attached, groups};
use super::result::Diagnosis;
use super::study::Study;

/// The rejected hypotheses that the recordings support as well as the best one: as many effects, others than its own,
/// and a criterion within the policy's evidence.
pub fn rivals<'d>(study: &Study, diagnosis: &'d Diagnosis) -> Vec<&'d Hypothesis> {
    let after = &diagnosis.after;
    let limit = after.total_criterion() + study.policy.evidence;
    let number = groups(&after.effects).count();
    let mut alike: Vec<&Hypothesis> = Vec::new();
    for rejected in &diagnosis.rejected {
        let same = |other: &&Hypothesis| other.has_same_effects(rejected);
        let known = after.has_same_effects(rejected) || alike.iter().any(same);
        let is_alike = rejected.total_criterion() < limit;
        let is_rival = !known
            && !contains(study, rejected, after)
            && !is_special_case(study, after, rejected)
            && !is_same_function(after, rejected);
        if is_alike && groups(&rejected.effects).count() == number && is_rival && number > 0 {
            alike.push(rejected);
        }
    }
    alike
}

/// True if a hypothesis differs from another only by free curves over the variables of its laws: a curve contains the
/// law, and is no other explanation.
fn contains(study: &Study, general: &Hypothesis, special: &Hypothesis) -> bool {
    groups(&special.effects).all(|law| {
        groups(&general.effects).any(|other| {
            let is_curve = study.is_curve(other[0].effect);
            is_same_place(law, other) && (is_curve || law[0].effect == other[0].effect)
        })
    })
}

/// The effect in which a hypothesis differs from another one; the last, if it differs in several.
pub fn difference<'h>(
    hypothesis: &'h Hypothesis,
    other: &Hypothesis,
) -> Option<&'h [ChosenEffect]> {
    let is_same = |a: &[ChosenEffect], b: &[ChosenEffect]| {
        let same = |(a, b): (&ChosenEffect, &ChosenEffect)| {
            a.effect == b.effect && a.place.at == b.place.at && a.place.binds == b.place.binds
        };
        a.len() == b.len() && a.iter().zip(b).all(same)
    };
    let is_shared = |own: &&[ChosenEffect]| groups(&other.effects).any(|o| is_same(own, o));
    let own: Vec<&[ChosenEffect]> =
        groups(&hypothesis.effects).filter(|group| !is_shared(group)).collect();
    match own.as_slice() {
        [only] => Some(only),
        _ => groups(&hypothesis.effects).last(),
    }
}

/// Multiple of its error below which an amplitude may as well be zero.
const INSIGNIFICANT: f64 = 2.0;

/// True if the law of the first hypothesis is a special case of that of the second, at the same place: what the second one
/// has more is zero or not determined, so that both say the same.
fn is_special_case(study: &Study, special: &Hypothesis, general: &Hypothesis) -> bool {
    let (Some(law), Some(other)) = (difference(special, general), difference(general, special))
    else {
        return false;
    };
    let number = |group: &[ChosenEffect]| group.iter().map(|c| c.fitted.len()).sum::<usize>();
    let is_open = |c: &ChosenEffect| {
        let amplitudes = &study.effects[c.effect].amplitudes;
        c.fitted.iter().any(|own| {
            let Some((value, error)) = general.estimate(&c.full_name(own)) else { return false };
            let is_amplitude = amplitudes.iter().any(|a| a.name == *own);
            !error.is_finite() || is_amplitude && value.abs() < INSIGNIFICANT * error
        })
    };
    is_same_place(law, other) && number(other) > number(law) && other.iter().any(is_open)
}

/// True if two hypotheses differ by laws that are one function of what the recordings cover, as x^2 and x |x| are where x has
/// one sign: at the same place, over the same variables, with as many parameters and the same sums of squares.
fn is_same_function(one: &Hypothesis, other: &Hypothesis) -> bool {
    let (Some(law), Some(rival)) = (difference(one, other), difference(other, one)) else {
        return false;
    };
    let is_near = |a: f64, b: f64| (a - b).abs() <= SAME_SUM * a.abs();
    is_same_place(law, rival)
        && one.values.len() == other.values.len()
        && is_near(one.train.total(), other.train.total())
        && is_near(one.validation.total(), other.validation.total())
}

/// Relative difference of sums of squares that comes from the integration alone.
const SAME_SUM: f64 = 1e-6;

/// True if two effects act at the same places, over the same variables.
fn is_same_place(a: &[ChosenEffect], b: &[ChosenEffect]) -> bool {
    let same = |(a, b): (&ChosenEffect, &ChosenEffect)| a.place.is_same_over(&b.place);
    a.len() == b.len() && a.iter().zip(b).all(same)
}

/// A variable that nobody measures, and by how much the rivals differ in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// The variable.
    pub variable: String,
    /// Its unit.
    pub unit: String,
    /// The greatest difference to the closest rival, in SI units.
    pub difference: f64,
    /// The same as a share of the range that the variable covers.
    pub share: f64,
}

/// Sensors that are reported.
const REPORTED: usize = 3;
/// Share of the range of a variable below which a difference is not worth a sensor.
const WORTHWHILE: f64 = 0.01;

/// Relative difference below which two variables differ between the rivals by the same.
const SAME: f64 = 1e-9;

/// Share of the greatest value with its unit below which a variable is zero but for rounding.
const ROUNDING: f64 = 1e-9;

/// The variables whose measurement would tell the best hypothesis from its rivals: those in which they differ most,
/// relative to the range of the variable. Empty without rivals.
pub fn sensors(study: &Study, diagnosis: &Diagnosis) -> Vec<Sensor> {
    let rivals = rivals(study, diagnosis);
    let longest = study.data.of(Split::Train).max_by_key(|r| r.time.len());
    let Some(recording) = longest.filter(|_| !rivals.is_empty()) else { return Vec::new() };
    let is_open = |name: &&String| !study.is_measured(name);
    let names: Vec<String> = study.variables.iter().filter(is_open).cloned().collect();
    let Some(own) = trajectories(study, &diagnosis.after, recording, &names) else {
        return Vec::new();
    };
    let mut found: Vec<Sensor> = own
        .iter()
        .map(|(variable, unit, _)| {
            let (variable, unit) = (variable.clone(), unit.clone());
            Sensor { variable, unit, difference: f64::INFINITY, share: f64::INFINITY }
        })
        .collect();
    for rival in rivals {
        let Some(other) = trajectories(study, rival, recording, &names) else { continue };
        for (sensor, (name, _, course)) in found.iter_mut().zip(&own) {
            let Some((.., of_rival)) = other.iter().find(|(n, ..)| n == name) else { continue };
            let difference =
                course.iter().zip(of_rival).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let (low, high) = course
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
            let share = if high > low { difference / (high - low) } else { 0.0 };
            if share < sensor.share {
                (sensor.difference, sensor.share) = (difference, share);
            }
        }
    }
    // A variable that is zero but for rounding has no range.
    let size = |course: &[f64]| course.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let greatest = |unit: &str| {
        let same = own.iter().filter(|(_, u, _)| u == unit);
        same.map(|(.., course)| size(course)).fold(0.0, f64::max)
    };
    let mut is_real = own.iter().map(|(_, unit, course)| size(course) > ROUNDING * greatest(unit));
    found.retain(|_| is_real.next().unwrap_or(false));
    found.retain(|s| s.share.is_finite() && s.share > WORTHWHILE);
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    // Connected variables are one quantity under several names.
    let near = |a: f64, b: f64| (a - b).abs() <= SAME * b.abs();
    found.dedup_by(|a, b| near(a.share, b.share) && near(a.difference, b.difference));
    found.truncate(REPORTED);
    found
}

/// The recorded variables of a hypothesis under the conditions of a recording: name, unit and values.
pub fn trajectories(
    study: &Study,
    hypothesis: &Hypothesis,
    recording: &Recording,
    names: &[String],
) -> Option<Vec<(String, String, Vec<f64>)>> {
    let plan = &hypothesis.plan;
    let (session, program) =
        study.compile(plan, &attached(study, &hypothesis.effects), names).ok()?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, plan, &study.data, &mut problems)?;
    let recorded: Vec<String> =
        program.recorded.iter().map(|v| program.name(*v).to_owned()).collect();
    let wanted: Vec<String> = names.iter().filter(|n| recorded.contains(n)).cloned().collect();
    let values = problem.others(recording, &problem.start(), &wanted).ok()?;
    let unit = |name: &String| {
        let v = program.recorded.iter().find(|v| program.name(**v) == name);
        v.map_or(String::new(), |v| program.blocks.dae.variables[*v].unit.to_string())
    };
    Some(wanted.iter().zip(values).map(|(n, v)| (n.clone(), unit(n), v)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::place::Place;

    fn effect(at: &str, over: &[&str]) -> ChosenEffect {
        let bind = |(k, variable): (usize, &&str)| (format!("u[{k}]"), (*variable).to_owned());
        let binds = over.iter().enumerate().map(bind).collect();
        let place = Place { binds, ..Place::at(&[at.to_owned()]) };
        let (name, prefix, fixed, fitted) = Default::default();
        ChosenEffect { effect: 0, place, name, prefix, fixed, fitted, group: 0 }
    }

    /// The order of the variables does not matter; another variable, one more, or another component does.
    #[test]
    fn places_are_the_same_with_the_same_variables() {
        let law = [effect("spring", &["s", "v"])];
        assert!(is_same_place(&law, &[effect("spring", &["v", "s"])]));
        for (at, over) in [("spring", &["s"][..]), ("spring", &["s", "p"]), ("mass", &["s", "v"])] {
            assert!(!is_same_place(&law, &[effect(at, over)]), "{at} over {over:?}");
        }
        assert!(!is_same_place(&law, &[effect("spring", &["s", "v"]), effect("mass", &["s"])]));
    }
}
