//! `diagnosis.json`.

use crate::base::index::FastSet;
use crate::calibrate::data::{Data, Split};
use crate::calibrate::plan::Signal;
use crate::io::json::Json;

use super::balance::Balance;
use super::catalogue::{Effect, PARAMETER};
use super::difference::as_difference;
use super::grade::grade;
use super::hypothesis::{ChosenEffect, Hypothesis, bound_variables, groups};
use super::next_experiment::{ConditionValue, Gain, NextExperiment};
use super::result::{Diagnosis, Verdict, law, rmse_of, sentences, unit};
use super::rivals::{Sensor, difference, rivals};
use super::run::Outcome;
use super::separate_starts::SeparateStarts;
use super::study::Study;

/// The text of the file. `amended_model`: name of the file of the amended model.
pub fn json(outcome: &Outcome, amended_model: Option<&str>, seconds: f64) -> String {
    let Outcome { study, diagnosis, .. } = outcome;
    let catalogue = &study.effects;
    let best = diagnosis.after.bic();
    let alternative = |hypothesis: &Hypothesis, k: usize| {
        let mut all: Vec<_> = groups(&hypothesis.effects).collect();
        let own = all.remove(k);
        let delta = Json::number(hypothesis.bic() - best);
        let beside = Json::list(all.into_iter().map(|g| named(catalogue, g)));
        let more = vec![("delta_bic", delta), ("beside", beside)];
        effect_json(catalogue, hypothesis, own, more)
    };
    let rejected = best_of_each(&diagnosis.rejected).into_iter().filter_map(|hypothesis| {
        let last = groups(&hypothesis.effects).count().checked_sub(1)?;
        Some(alternative(hypothesis, last))
    });
    let after = &diagnosis.after;
    let verdict = diagnosis.verdict(&study.policy);
    // What explains only a part is one alternative of several.
    let (found, partial) = match verdict {
        Verdict::Unexplained => (0, groups(&after.effects).count()),
        Verdict::Complete | Verdict::EffectFound => (groups(&after.effects).count(), 0),
    };
    let effects = groups(&after.effects).take(found);
    let graded = |g| {
        let grade = grade(outcome, g).map_or(Json::null(), |g| Json::text(g.name()));
        effect_json(catalogue, after, g, vec![("grade", grade)])
    };
    let effects = effects.map(graded);
    let alternatives = (0..partial).map(|k| alternative(after, k)).chain(rejected);
    let noise = diagnosis.noise.factors(study).into_iter();
    let members = [
        ("verdict", Json::text(verdict.name())),
        ("noise", Json::object(noise.map(|(column, factor)| (column, Json::number(factor))))),
        ("effects", Json::list(effects)),
        ("alternatives", Json::list(alternatives)),
        ("indistinguishable", indistinguishable(outcome)),
        ("sensors", Json::list(outcome.sensors.iter().map(sensor))),
        ("separate_starts", outcome.starts.as_ref().map_or(Json::null(), separate_starts)),
        (
            "next",
            outcome.next.iter().flatten().next().map_or(Json::null(), |n| next(study, after, n)),
        ),
        ("before", quality(&study.data, &diagnosis.before)),
        ("after", quality(&study.data, &diagnosis.after)),
        ("parameters", parameters(study, diagnosis)),
        ("balances", Json::list(outcome.balances.iter().map(balance_json))),
        (
            "fmu",
            study
                .plan
                .fmu
                .as_ref()
                .map_or(Json::null(), |f| Json::text(f.file.display().to_string())),
        ),
        ("repairs", Json::list(study.data.repairs.iter().map(|r| Json::text(r.as_str())))),
        ("amended_model", amended_model.map_or(Json::null(), Json::text)),
        ("seconds", Json::number(seconds)),
        ("complete", Json::flag(outcome.complete)),
    ];
    Json::object(members).pretty()
}

/// Of hypotheses with the same effects the best one, in the place of the first.
fn best_of_each(all: &[Hypothesis]) -> Vec<&Hypothesis> {
    let mut out: Vec<&Hypothesis> = Vec::new();
    for hypothesis in all {
        match out.iter_mut().find(|known| known.has_same_effects(hypothesis)) {
            Some(known) if hypothesis.bic() < known.bic() => *known = hypothesis,
            Some(_) => {}
            None => out.push(hypothesis),
        }
    }
    out
}

/// The free parameters of the plan, in SI units, without effects and with those that were found.
fn parameters(study: &Study, diagnosis: &Diagnosis) -> Json {
    let estimate = |hypothesis: &Hypothesis, name: &str| {
        let Some((value, error)) = hypothesis.estimate(name) else { return Json::null() };
        Json::object([
            ("value", Json::number(value)),
            ("stderr", Json::number(error)),
            ("at_bound", Json::flag(hypothesis.is_at_bound(name))),
        ])
    };
    let one = |name: &String| {
        let members = [
            ("unit", Json::text(study.unit(name))),
            ("before", estimate(&diagnosis.before, name)),
            ("after", estimate(&diagnosis.after, name)),
        ];
        (name.clone(), Json::object(members))
    };
    let names = study.plan.free.iter().filter_map(|free| free.targets.first());
    Json::object(names.map(one).collect::<Vec<_>>())
}

/// An effect, its place and its law.
fn named(effects: &[Effect], group: &[ChosenEffect]) -> Json {
    let effect = &effects[group[0].effect];
    let at = group.iter().flat_map(|c| c.place.at.iter());
    Json::object([
        ("component", Json::text(component(effect))),
        ("at", Json::list(at.map(|a| Json::text(a.clone())))),
        ("over", Json::list(over(effect, group).into_iter().map(Json::text))),
        ("law", Json::text(law(effect, &group[0]))),
    ])
}

fn balance_json(balance: &Balance) -> Json {
    let over = balance.ordered_by.and_then(|k| balance.profiles.first()?.over.get(k));
    Json::object([
        ("at", Json::text(balance.at.as_str())),
        ("inflow", Json::text(balance.class.as_str())),
        ("explained", Json::number(balance.explained)),
        ("ordered_by", over.map_or(Json::null(), |(name, ..)| Json::text(name.as_str()))),
    ])
}

fn effect_json(
    effects: &[Effect],
    hypothesis: &Hypothesis,
    group: &[ChosenEffect],
    more: Vec<(&str, Json)>,
) -> Json {
    let effect = &effects[group[0].effect];
    let mut parameters: Vec<(String, Json)> = Vec::new();
    for chosen in group {
        for name in &chosen.fitted {
            let full = chosen.full_name(name);
            let Some((value, error)) = hypothesis.estimate(&full) else { continue };
            let members = [
                ("value", Json::number(value)),
                ("stderr", Json::number(error)),
                ("unit", Json::text(unit(effect, name))),
                ("at_bound", Json::flag(hypothesis.is_at_bound(&full))),
            ];
            let several = group.len() > 1;
            let shown =
                if several { format!("{name} at {}", chosen.place.at[0]) } else { name.clone() };
            parameters.push((shown, Json::object(members)));
        }
    }
    let at = group.iter().flat_map(|c| c.place.at.iter());
    let mut members = vec![
        ("component", Json::text(component(effect))),
        ("at", Json::list(at.map(|a| Json::text(a.clone())))),
        ("over", Json::list(over(effect, group).into_iter().map(Json::text))),
        ("law", Json::text(law(effect, &group[0]))),
        ("parameters", Json::object(parameters)),
        ("explains", Json::text(sentences(effects, group).join(" "))),
    ];
    members.extend(more);
    Json::object(members)
}

/// The groups of effects of which the data support each as well as the others: for each effect that was found and has rivals,
/// itself and these.
fn indistinguishable(outcome: &Outcome) -> Json {
    let Outcome { study, diagnosis, .. } = outcome;
    let after = &diagnosis.after;
    let alike = rivals(study, diagnosis);
    let rivals_of = |own: &[ChosenEffect]| {
        let compete =
            |r: &&&Hypothesis| difference(after, r).is_some_and(|mine| mine[0].name == own[0].name);
        alike.iter().filter(compete).filter_map(|r| difference(r, after)).collect::<Vec<_>>()
    };
    let all = groups(&after.effects).map(|own| (own, rivals_of(own)));
    let contested = all.filter(|(_, rivals)| !rivals.is_empty());
    Json::list(contested.map(|(own, rivals)| {
        Json::list(std::iter::once(own).chain(rivals).map(|g| named(&study.effects, g)))
    }))
}

fn sensor(sensor: &Sensor) -> Json {
    Json::object([
        ("variable", Json::text(sensor.variable.as_str())),
        ("unit", Json::text(sensor.unit.as_str())),
        ("difference", Json::number(sensor.difference)),
        ("share_of_range", Json::number(sensor.share)),
    ])
}

fn separate_starts(starts: &SeparateStarts) -> Json {
    Json::object([
        ("states", Json::list(starts.states.iter().map(|s| Json::text(s.as_str())))),
        ("train", Json::number(starts.train)),
        ("validation", Json::number(starts.validation)),
    ])
}

/// The recording that would tell most.
fn next(study: &Study, after: &Hypothesis, next: &NextExperiment) -> Json {
    let condition = |c: &ConditionValue| {
        let members = [("value", Json::number(c.value)), ("unit", Json::text(c.unit.as_str()))];
        (c.column.clone(), Json::object(members))
    };
    let gain =
        |g: Gain| [("expected", Json::number(g.best)), ("of_random", Json::number(g.random))];
    let separates = next.separation.map_or(Json::null(), |separation| {
        let of_rival = |r: &Hypothesis| difference(r, after).map(|g| named(&study.effects, g));
        let from = Json::list(next.rivals.iter().filter_map(of_rival));
        let members = [("from", from)].into_iter().chain(gain(separation));
        Json::object(members.collect::<Vec<_>>())
    });
    let narrows = next.narrowed.as_ref().map_or(Json::null(), |n| {
        let own =
            [("parameter", Json::text(n.parameter.as_str())), ("stderr", Json::number(n.error))];
        Json::object(own.into_iter().chain(gain(n.expected)).collect::<Vec<_>>())
    });
    Json::object([
        ("conditions", Json::object(next.conditions.iter().map(condition).collect::<Vec<_>>())),
        ("separates", separates),
        ("narrows", narrows),
    ])
}

/// What an effect is, by name: its class, or a parameter that varies.
fn component(effect: &Effect) -> String {
    match effect.varies {
        Some(_) => PARAMETER.to_owned(),
        None => effect.name().to_owned(),
    }
}

/// The variables that the law of an effect depends on.
fn over(effect: &Effect, group: &[ChosenEffect]) -> Vec<String> {
    let is_of_instrument = effect.of_signal || effect.acts.is_some();
    match effect.has_free_inputs() || is_of_instrument {
        true => {
            let bound = bound_variables(group, |_| true).into_iter();
            let mut seen = FastSet::default();
            let names = bound.flat_map(|variable| match as_difference(variable) {
                Some((a, b)) => vec![a, b],
                None => vec![variable],
            });
            names.filter(|name| seen.insert(*name)).map(str::to_owned).collect()
        }
        false => effect.over.clone(),
    }
}

fn quality(data: &Data, hypothesis: &Hypothesis) -> Json {
    let signals = |split: Split| {
        let sums = hypothesis.sums(split);
        let one = |(k, s): (usize, &Signal)| {
            let multiple = sums.of_signal(k);
            let members = [
                ("rmse", Json::number(multiple * data.sigmas[k])),
                ("unit", Json::text(s.unit_name.clone())),
                ("noise_multiple", Json::number(multiple)),
            ];
            (s.column.clone(), Json::object(members))
        };
        Json::object(hypothesis.plan.signals.iter().enumerate().map(one).collect::<Vec<_>>())
    };
    let recordings = |split: Split| {
        let all = data.wholes(split).into_iter().map(|name| {
            let by_signal = hypothesis.plan.signals.iter().enumerate().map(|(k, s)| {
                (s.column.clone(), Json::number(rmse_of(data, hypothesis, split, k, name)))
            });
            let rmse = Json::object(by_signal.collect::<Vec<_>>());
            Json::object([("name", Json::text(name)), ("rmse", rmse)])
        });
        Json::list(all.collect::<Vec<_>>())
    };
    let part = |split: Split, chi2: f64| {
        Json::object([
            ("chi2", Json::number(chi2)),
            ("signals", signals(split)),
            ("recordings", recordings(split)),
        ])
    };
    Json::object(data.splits().map(|split| (split.name(), part(split, hypothesis.chi2(split)))))
}
