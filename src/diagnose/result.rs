//! What a diagnosis says: verdict, effects, error before and after, and the amended model.

use crate::calibrate::data::{Data, Split};
use crate::io::json::Json;

use super::balance::Balance;
use super::case::Case;
use super::effect::Effect;
use super::level::{Chosen, Level, groups};
use super::preference::{COMPLETE, RESOLVED};
use super::search::Found;
use super::text::{Attached, Setting, model};

/// Share of the excess of the reduced sum of squares over one that effects must explain to be a
/// finding.
const EXPLAINED: f64 = 0.9;

/// The outcome in one word.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// Nothing is missing.
    Complete,
    /// What is missing was found.
    EffectFound,
    /// Structure is left that no candidate explains.
    Unexplained,
}

impl Verdict {
    /// Its name in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Complete => "complete",
            Verdict::EffectFound => "effect_found",
            Verdict::Unexplained => "unexplained",
        }
    }
}

/// The verdict on what was found.
pub fn verdict(found: &Found) -> Verdict {
    let (before, after) = (found.before.chi2_validation(), found.after.chi2_validation());
    let left = after.max(found.after.chi2_train());
    if found.after.chosen.is_empty() {
        let whole = found.before.chi2_train() < 1.0 + 2.0 * (COMPLETE - 1.0);
        return if whole { Verdict::Complete } else { Verdict::Unexplained };
    }
    let explained = (before - after) / (before - 1.0).max(f64::MIN_POSITIVE);
    if left < RESOLVED || explained >= EXPLAINED && left < 3.0 {
        Verdict::EffectFound
    } else {
        Verdict::Unexplained
    }
}

/// `NAME_with_EFFECT`, the text that declares it, and all that it needs: the original before it.
pub fn amended(case: &Case<'_>, found: &Found, original: &str) -> Option<(String, String)> {
    let level = &found.after;
    let last = level.chosen.first()?;
    let short = |class: &str| class.rsplit('.').next().unwrap_or(class).to_owned();
    let mut name = short(&case.base);
    for group in groups(&level.chosen) {
        name.push_str(if group[0].name == last.name { "_with_" } else { "_and_" });
        name.push_str(&short(&case.effects[group[0].effect].class));
    }
    let mut settings = Vec::new();
    for free in &case.plan.free {
        for target in &free.targets {
            let Some((value, error)) = level.estimate(target) else { continue };
            let comment = format!("+- {error:.2e}");
            settings.push(Setting { name: target.clone(), value, comment });
        }
    }
    let mut attached = Vec::new();
    let mut comments = Vec::new();
    for c in &level.chosen {
        let mut values = Vec::new();
        let mut said = Vec::new();
        let effect = &case.effects[c.effect];
        for parameter in &c.fitted {
            let full = format!("{}.{parameter}", c.name);
            let Some((value, error)) = level.estimate(&full) else { continue };
            values.push((parameter.clone(), value));
            let base = parameter.split('[').next().unwrap_or(parameter).to_owned();
            said.push((base, format!("+- {error:.2e} {}", unit(effect, parameter))));
        }
        let fixed = c.fixed.iter().filter(|(p, _)| !c.fitted.contains(p));
        values.extend(fixed.cloned());
        attached.push(Attached { effect, place: &c.place, name: c.name.clone(), values });
        comments.push(said);
    }
    let e = case.experiment;
    let items = [
        ("StartTime", e.start),
        ("StopTime", e.stop),
        ("Interval", e.interval),
        ("Tolerance", e.tolerance),
    ];
    let items: Vec<String> =
        items.iter().filter_map(|(n, v)| v.map(|v| format!("{n} = {v}"))).collect();
    let experiment = format!("experiment({})", items.join(", "));
    let description = sentences(case.effects, &level.chosen).join(" ");
    let text = model(
        &name,
        &case.base,
        &description.replace('"', "'"),
        (!items.is_empty()).then_some(experiment.as_str()),
        &settings,
        &attached,
        &comments,
    );
    Some((name, format!("{}\n\n// Found by mocc diagnose:\n{text}", original.trim_end())))
}

/// One sentence for each effect.
pub fn sentences(effects: &[Effect], chosen: &[Chosen]) -> Vec<String> {
    let one = |group: &[Chosen]| {
        let at: Vec<&str> =
            group.iter().flat_map(|c| c.place.at.iter().map(String::as_str)).collect();
        effects[group[0].effect].explains.replace("%at", &at.join(", "))
    };
    groups(chosen).map(one).collect()
}

/// The fitted parameters of the effects: full name, value, standard error and unit.
pub fn estimates(effects: &[Effect], level: &Level) -> Vec<(String, f64, f64, String)> {
    let names = level.chosen.iter().flat_map(|c| {
        let effect = &effects[c.effect];
        c.fitted.iter().map(move |p| (format!("{}.{p}", c.name), unit(effect, p)))
    });
    let one = |(name, unit): (String, String)| {
        let (value, error) = level.estimate(&name)?;
        Some((name, value, error, unit))
    };
    names.filter_map(one).collect()
}

/// The unit of an effect's parameter.
fn unit(effect: &Effect, parameter: &str) -> String {
    effect.units.iter().find(|(n, _)| n == parameter).map_or(String::new(), |(_, u)| u.clone())
}

/// The text of `diagnosis.json`.
pub fn json(
    case: &Case<'_>,
    found: &Found,
    balances: &[Balance],
    amended_model: Option<&str>,
    seconds: f64,
    complete: bool,
) -> String {
    let best = found.after.bic();
    let alternatives = found.rejected.iter().filter_map(|level| {
        let mut all: Vec<_> = groups(&level.chosen).collect();
        let new = all.pop()?;
        let delta = Json::number(level.bic() - best);
        let beside = Json::list(all.into_iter().map(|g| named(case.effects, g)));
        Some(effect_json(case.effects, level, new, vec![("delta_bic", delta), ("beside", beside)]))
    });
    let effects =
        groups(&found.after.chosen).map(|g| effect_json(case.effects, &found.after, g, Vec::new()));
    let members = [
        ("verdict", Json::text(verdict(found).name())),
        ("effects", Json::list(effects)),
        ("alternatives", Json::list(alternatives)),
        ("before", quality(case.data, &found.before)),
        ("after", quality(case.data, &found.after)),
        ("balances", Json::list(balances.iter().map(balance_json))),
        ("repairs", Json::list(case.data.repairs.iter().map(|r| Json::text(r.as_str())))),
        ("amended_model", amended_model.map_or(Json::null(), Json::text)),
        ("seconds", Json::number(seconds)),
        ("complete", Json::flag(complete)),
    ];
    Json::object(members).pretty()
}

/// An effect and where it is.
fn named(effects: &[Effect], group: &[Chosen]) -> Json {
    let at = group.iter().flat_map(|c| c.place.at.iter());
    Json::object([
        ("component", Json::text(effects[group[0].effect].class.clone())),
        ("at", Json::list(at.map(|a| Json::text(a.clone())))),
    ])
}

fn balance_json(balance: &Balance) -> Json {
    let over = balance.ordered_by.and_then(|k| balance.courses.first()?.over.get(k));
    Json::object([
        ("at", Json::text(balance.at.as_str())),
        ("inflow", Json::text(balance.class.as_str())),
        ("explained", Json::number(balance.explained)),
        ("ordered_by", over.map_or(Json::null(), |(name, ..)| Json::text(name.as_str()))),
    ])
}

fn effect_json(
    effects: &[Effect],
    level: &Level,
    group: &[Chosen],
    more: Vec<(&str, Json)>,
) -> Json {
    let effect = &effects[group[0].effect];
    let mut parameters: Vec<(String, Json)> = Vec::new();
    for chosen in group {
        for name in &chosen.fitted {
            let full = format!("{}.{name}", chosen.name);
            let Some((value, error)) = level.estimate(&full) else { continue };
            let members = [
                ("value", Json::number(value)),
                ("stderr", Json::number(error)),
                ("unit", Json::text(unit(effect, name))),
            ];
            let several = group.len() > 1;
            let shown =
                if several { format!("{name} at {}", chosen.place.at[0]) } else { name.clone() };
            parameters.push((shown, Json::object(members)));
        }
    }
    let at = group.iter().flat_map(|c| c.place.at.iter());
    let mut members = vec![
        ("component", Json::text(effect.class.clone())),
        ("at", Json::list(at.map(|a| Json::text(a.clone())))),
        ("parameters", Json::object(parameters)),
        ("explains", Json::text(sentences(effects, group).join(" "))),
    ];
    members.extend(more);
    Json::object(members)
}

/// Root of the mean square of a signal over all windows of one recording, in the unit of its column.
pub fn rmse_of(data: &Data, level: &Level, split: Split, signal: usize, recording: &str) -> f64 {
    let sums = if split == Split::Train { &level.train } else { &level.validation };
    let belongs: Vec<bool> = data.of(split).map(|r| r.of == recording).collect();
    sums.of_part(signal, |i| belongs.get(i).copied().unwrap_or(true)) * data.sigmas[signal]
}

fn quality(data: &Data, level: &Level) -> Json {
    let signals = |split: Split| {
        let sums = if split == Split::Train { &level.train } else { &level.validation };
        let one = |(k, s): (usize, &crate::calibrate::plan::Signal)| {
            let multiple = sums.of_signal(k);
            let members = [
                ("rmse", Json::number(multiple * data.sigmas[k])),
                ("unit", Json::text(s.unit_name.clone())),
                ("noise_multiple", Json::number(multiple)),
            ];
            (s.column.clone(), Json::object(members))
        };
        Json::object(level.plan.signals.iter().enumerate().map(one).collect::<Vec<_>>())
    };
    let recordings = |split: Split| {
        let all = data.wholes(split).into_iter().map(|name| {
            let by_signal = level.plan.signals.iter().enumerate().map(|(k, s)| {
                (s.column.clone(), Json::number(rmse_of(data, level, split, k, name)))
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
    Json::object([
        ("train", part(Split::Train, level.chi2_train())),
        ("validation", part(Split::Validation, level.chi2_validation())),
    ])
}
