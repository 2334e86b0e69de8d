//! The self-contained HTML page of a diagnosis: the verdict, the recordings before and after, the missing flow, the
//! additions to the model, and the evidence below.

use crate::calibrate::data::Split;
use crate::calibrate::plan::Signal;
use crate::calibrate::table::{rmse_shown, shown};
use crate::report::markup::escaped;
use crate::report::page::diff::unified;
use crate::report::page::figure::{Curve, Panel, Stroke, figure, figure_over};
use crate::report::page::frame::Page;
use crate::report::scale::pretty;

use super::balance::{Balance, Profile};
use super::grade::{Grade, grade};
use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::next_experiment::Prediction;
use super::next_text::{label, lines};
use super::rank::Scored;
use super::residual::{Residual, residuals};
use super::result::{Diagnosis, Verdict, estimates, rmse_of, sentences};
use super::run::Outcome;
use super::study::Study;
use super::summary::{ENDED_EARLY, noise_lines, partial, sentence_case};

/// Rows of a ranking to show.
const RANKED: usize = 15;

/// The page.
pub fn html(outcome: &Outcome) -> String {
    let Outcome { study, diagnosis, .. } = outcome;
    let after = &diagnosis.after;
    let mut page = Page::new(&format!("{}: diagnosis", study.base));
    let is_in_doubt =
        outcome.verdict() == Verdict::EffectFound && !diagnosis.leaves_noise(&study.policy);
    page.add(&format!(
        "<h1>{}</h1>\n<p class=\"verdict {verdict}{doubt}\">{verdict}</p>\n",
        escaped(&study.base),
        verdict = outcome.verdict().name(),
        doubt = if is_in_doubt { " partial" } else { "" },
    ));
    if !outcome.complete {
        page.add(&format!("<p class=\"note\">{}</p>\n", sentence_case(ENDED_EARLY)));
    }
    page.add(&format!("<p>{}</p>\n", escaped(&conclusion(outcome))));
    let named = sentences(&study.effects, &after.effects);
    for (sentence, group) in named.into_iter().zip(groups(&after.effects)) {
        let text = format!("{}{sentence}", sentence_case(partial(outcome)));
        page.add(&format!("<p>{}</p>\n", escaped(&text)));
        if let Some(grade) = grade(outcome, group).filter(|g| *g != Grade::Established) {
            let meaning = escaped(&sentence_case(grade.meaning()));
            page.add(&format!("<p class=\"note\">{meaning}.</p>\n"));
        }
    }
    for limit in study.limits() {
        page.add(&format!("<p class=\"note\">{}.</p>\n", escaped(&sentence_case(&limit))));
    }
    for line in noise_lines(outcome) {
        page.add(&format!("<p>{}.</p>\n", escaped(&sentence_case(&line))));
    }
    let part = |write: &dyn Fn(&mut String)| {
        let mut out = String::new();
        write(&mut out);
        out
    };
    let residuals = residuals(study, diagnosis);
    if let Some((heading, text)) = comparison(study, diagnosis, &residuals) {
        page.section("comparison", &heading, &text);
    }
    if !outcome.balances.is_empty() {
        let text = unbalanced(&outcome.balances, &outcome.contributions);
        page.section("balances", "Balances that do not close", &text);
    }
    if let Some(amended) = &outcome.amended {
        let text = unified(&outcome.original, &amended.source);
        page.section("amended", "Additions to the model", &text);
    }
    let text = part(&|out| parameters(study, diagnosis, out));
    page.section("parameters", "Parameters before and after", &text);
    page.section("errors", "Error before and after", &part(&|out| errors(study, diagnosis, out)));
    if outcome.verdict() == Verdict::Unexplained {
        let text = part(&|out| left(study, &residuals, out));
        page.section("left", "Where the unexplained part is", &text);
    }
    let next = lines(outcome);
    if !next.is_empty() {
        page.section("next", "Next experiment", &next_section(study, outcome, &next));
    }
    page.section(
        "residuals",
        "Residuals of each recording",
        &multiples(study, diagnosis, &residuals),
    );
    if !study.data.repairs.is_empty() {
        let repair = |text: &String| format!("<p>{}</p>\n", escaped(text));
        let all: String = study.data.repairs.iter().map(repair).collect();
        page.folded("repairs", "Repairs of the recordings", &all);
    }
    for (depth, ranking) in diagnosis.rankings.iter().enumerate() {
        let cost = if depth == 0 { diagnosis.before.train.total() } else { after.train.total() };
        let mut text = "<p>Share of the sum of squares that each effect promises to explain, before any is fitted.</p>\n".to_owned();
        let each: Vec<Vec<Scored>> = ranking.iter().take(RANKED).map(|s| vec![s.clone()]).collect();
        rank(study, &each, cost, &mut text);
        let number = depth + 1;
        page.folded(&format!("ranking-{number}"), &format!("Ranking {number}"), &text);
    }
    if !diagnosis.pairs.is_empty() {
        let mut text = "<p>One effect does not explain everything. Share of the sum of squares that two effects promise to explain together.</p>\n".to_owned();
        rank(study, &diagnosis.pairs, diagnosis.before.train.total(), &mut text);
        page.folded("pairs", "Pairs of effects", &text);
    }
    if !diagnosis.rejected.is_empty() {
        let text = part(&|out| rejected(study, diagnosis, out));
        page.folded("rejected", "Fitted and rejected", &text);
    }
    page.finish()
}

/// The verdict in a sentence, with its evidence.
fn conclusion(outcome: &Outcome) -> String {
    let Outcome { study, diagnosis, .. } = outcome;
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let has_validation = study.data.of(Split::Validation).next().is_some();
    let of =
        if has_validation { "the recordings that were never fitted" } else { "the recordings" };
    let falls = format!(
        "the reduced chi-square of {of} falls from {:.4} to {:.4}",
        before.chi2_validation(),
        after.chi2_validation()
    );
    let count = groups(&after.effects).count();
    let leaves_noise = diagnosis.leaves_noise(&study.policy);
    match (outcome.verdict(), count) {
        (Verdict::Complete, _) => {
            "The model explains the recordings: nothing is missing.".to_owned()
        }
        (Verdict::EffectFound, 1) if leaves_noise => {
            format!("The model lacks one effect. With it, {falls}.")
        }
        (Verdict::EffectFound, n) if leaves_noise => {
            format!("The model lacks {n} effects. With them, {falls}.")
        }
        (Verdict::EffectFound, n) => {
            let them = if n == 1 { "one effect" } else { "effects" };
            format!(
                "The model lacks something. With {them} {falls}, but the residuals still show structure."
            )
        }
        (Verdict::Unexplained, 0) => {
            "The model does not explain the recordings, and no effect that was tried does."
                .to_owned()
        }
        (Verdict::Unexplained, _) => format!(
            "The model does not explain the recordings. Effects explain a part: {falls}, and a structure is left."
        ),
    }
}

/// The recording in which the effects change most, of those that were never fitted if there are any: measurement and
/// model, before and after.
fn comparison(
    study: &Study,
    diagnosis: &Diagnosis,
    residuals: &[Residual],
) -> Option<(String, String)> {
    let has_validation = study.data.of(Split::Validation).next().is_some();
    let wanted = if has_validation { Split::Validation } else { Split::Train };
    let squares = |all: &[Vec<f64>]| -> f64 {
        all.iter().flatten().filter(|r| r.is_finite()).map(|r| r * r).sum()
    };
    let change = |r: &Residual| squares(&r.before) - squares(&r.after);
    let recordings = Split::ALL.into_iter().flat_map(|split| study.data.of(split));
    let (recording, shown) = recordings
        .zip(residuals)
        .filter(|(r, residual)| r.split == wanted && !residual.after.is_empty())
        .max_by(|(_, a), (_, b)| change(a).total_cmp(&change(b)))?;
    let has_effects = !diagnosis.after.effects.is_empty();
    let panel = |(k, signal): (usize, &Signal)| {
        let measured = &recording.signals[k];
        let sigma = study.data.sigmas[k];
        let curve = |name: &str, y: Vec<f64>, stroke, colour| Curve {
            name: name.to_owned(),
            x: shown.time.to_vec(),
            y,
            stroke,
            colour,
        };
        let model = |name: &str, all: &[Vec<f64>], colour| {
            let y = measured.iter().zip(all.get(k)?).map(|(m, r)| m + r * sigma).collect();
            Some(curve(name, y, Stroke::Line, colour))
        };
        let before = model(if has_effects { "before" } else { "model" }, &shown.before, 1);
        let after = model("after", &shown.after, 0).filter(|_| has_effects);
        let points = curve("measured", measured.clone(), Stroke::Points, 2);
        let curves = [points].into_iter().chain(before).chain(after).collect();
        let label = format!("{} in {}", signal.column, signal.unit_name);
        Panel { label, display_unit: String::new(), unit: String::new(), curves, height: Some(170) }
    };
    let panels: Vec<Panel> = study.plan.signals.iter().enumerate().map(panel).collect();
    Some((format!("Recording {}, {}", shown.name, wanted.name()), figure("comparison", &panels)))
}

/// Rows of the table of what is left.
const LEFT: usize = 8;

/// The recordings and signals that hold most of what is left, and when it is greatest.
fn left(study: &Study, residuals: &[Residual], out: &mut String) {
    let mut rows: Vec<(f64, String)> = Vec::new();
    for r in residuals {
        for (signal, values) in study.plan.signals.iter().zip(&r.after) {
            let known = || values.iter().zip(r.time.iter()).filter(|(v, _)| v.is_finite());
            let square: f64 = known().map(|(v, _)| v * v).sum();
            let count = known().count();
            let Some((worst, at)) = known().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())) else {
                continue;
            };
            let rms = (square / count as f64).sqrt();
            let cells = format!(
                "<td>{}</td><td>{}</td><td>{}</td><td>{rms:.2} x noise</td><td>{worst:.1} x noise at {at:.4} s</td>",
                escaped(&r.name),
                r.split.name(),
                escaped(&signal.column)
            );
            rows.push((square - count as f64, cells));
        }
    }
    let excess: f64 = rows.iter().map(|(e, _)| e.max(0.0)).sum();
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    out.push_str("<table><tr><th>recording</th><th></th><th>signal</th><th>RMS residual</th><th>greatest</th><th>share of the excess</th></tr>");
    for (own, cells) in rows.iter().take(LEFT).filter(|(own, _)| *own > 0.0) {
        out.push_str(&format!("<tr>{cells}<td>{:.0} %</td></tr>", 100.0 * own / excess));
    }
    out.push_str("</table>");
}

/// The next experiment in words, and the readings that each hypothesis predicts for it.
fn next_section(study: &Study, outcome: &Outcome, lines: &[String]) -> String {
    let line = |text: &String| format!("<p>{}</p>\n", escaped(&sentence_case(text.trim())));
    let mut out: String = lines.iter().map(line).collect();
    let Some(next) = outcome.next.as_ref().and_then(Option::as_ref) else { return out };
    let hypotheses = std::iter::once(&outcome.diagnosis.after).chain(&next.rivals);
    let names: Vec<String> = hypotheses.map(|h| label(study, h)).collect();
    let panel = |(k, signal): (usize, &Signal)| {
        let curve = |(colour, p): (usize, &Prediction)| Curve {
            name: names[colour].clone(),
            x: p.time.clone(),
            y: p.signals[k].clone(),
            stroke: Stroke::Line,
            colour,
        };
        let curves = next.predictions.iter().enumerate().map(curve).collect();
        let (label, unit) = (signal.column.clone(), signal.unit_name.clone());
        Panel { label, display_unit: unit.clone(), unit, curves, height: Some(160) }
    };
    let panels: Vec<Panel> = study.plan.signals.iter().enumerate().map(panel).collect();
    out.push_str(&figure("next", &panels));
    out
}

/// Balances to list.
const LISTED: usize = 8;
/// Of these, balances whose inflow is drawn.
const DRAWN: usize = 2;

/// The inflows that the calibrated model would need, over time and over variables on which they may depend.
fn unbalanced(balances: &[Balance], contributions: &[Profile]) -> String {
    let mut out = String::from(
        "<p>For each balance of the calibrated model without effects: the share of the residuals that an unknown inflow, free over time, would explain to first order. Dots show this inflow in each recording, and the contribution of the effect that was found.</p>\n<table><tr><th>balance</th><th>explains</th><th>depends most clearly on</th></tr>",
    );
    let ordered = |b: &Balance| {
        let name = b.ordered_by.and_then(|k| b.profiles.first()?.over.get(k));
        name.map_or(String::new(), |(n, ..)| n.clone())
    };
    for b in balances.iter().take(LISTED) {
        let (at, order) = (escaped(&b.at), ordered(b));
        let share = 100.0 * b.explained;
        out.push_str(&format!("<tr><td>{at}</td><td>{share:.1} %</td><td>{order}</td></tr>"));
    }
    out.push_str("</table>\n");
    for (k, b) in balances.iter().take(DRAWN).enumerate() {
        let label = format!("at {}", b.at);
        let panel = |curves| {
            let (label, unit, display_unit) = (label.clone(), b.unit.clone(), String::new());
            [Panel { label, display_unit, unit, curves, height: Some(220) }]
        };
        let over_time = b.profiles.iter().enumerate().map(|(colour, c)| Curve {
            name: c.recording.clone(),
            x: c.time.to_vec(),
            y: c.inflow.clone(),
            stroke: Stroke::Line,
            colour,
        });
        out.push_str(&figure(&format!("balance-{k}"), &panel(over_time.collect())));
        for (j, (name, unit, _)) in
            b.profiles.first().iter().flat_map(|c| c.over.iter().enumerate())
        {
            let over = b.profiles.iter().enumerate().map(|(colour, c)| {
                let mut pairs: Vec<(f64, f64)> =
                    c.over[j].2.iter().copied().zip(c.inflow.iter().copied()).collect();
                pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
                let (x, y) = pairs.into_iter().unzip();
                Curve { name: c.recording.clone(), x, y, stroke: Stroke::Points, colour }
            });
            let mut curves: Vec<Curve> = over.collect();
            curves.extend(
                contribution_over(name, contributions, b.profiles.len()).filter(|_| k == 0),
            );
            let id = format!("balance-{k}-{name}");
            out.push_str(&figure_over(&id, (name, unit), &panel(curves)));
        }
    }
    out
}

/// The contribution of the effect that was found, over a variable of its place.
fn contribution_over(name: &str, contributions: &[Profile], colour: usize) -> Option<Curve> {
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for profile in contributions {
        let (.., values) = profile.over.iter().find(|(own, ..)| own == name)?;
        pairs.extend(values.iter().copied().zip(profile.inflow.iter().copied()));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    let curve = Curve { name: "effect found".to_owned(), x, y, stroke: Stroke::Points, colour };
    (!curve.x.is_empty()).then_some(curve)
}

/// Residuals in units of the noise: a small figure for each recording, a panel for each signal.
fn multiples(study: &Study, diagnosis: &Diagnosis, residuals: &[Residual]) -> String {
    let mut out = String::from(
        "<p>Model minus measurement, in units of the sensor's noise, without the effects and with them.</p>\n<div class=\"multiples\">\n",
    );
    let has_effects = !diagnosis.after.effects.is_empty();
    for (i, r) in residuals.iter().enumerate() {
        let curve = |name: &str, all: &[Vec<f64>], k: usize, colour| {
            let (x, y) = (r.time.to_vec(), all.get(k)?.clone());
            Some(Curve { name: name.to_owned(), x, y, stroke: Stroke::Line, colour })
        };
        let panel = |(k, signal): (usize, &Signal)| {
            let after = if has_effects { curve("after", &r.after, k, 0) } else { None };
            let curves = curve("before", &r.before, k, 1).into_iter().chain(after).collect();
            let (label, unit) = (signal.column.clone(), String::new());
            Panel { label, display_unit: unit.clone(), unit, curves, height: Some(90) }
        };
        let panels: Vec<Panel> = study.plan.signals.iter().enumerate().map(panel).collect();
        out.push_str(&format!(
            "<div><b>{}</b> <span class=\"sub\">{}</span>\n{}</div>\n",
            escaped(&r.name),
            r.split.name(),
            figure(&format!("residual-{i}"), &panels)
        ));
    }
    out.push_str("</div>\n");
    out
}

fn errors(study: &Study, diagnosis: &Diagnosis, out: &mut String) {
    let splits: Vec<Split> = study.data.splits().collect();
    out.push_str("<table class=\"wraps\"><tr><th></th>");
    for split in &splits {
        let name = split.name();
        out.push_str(&format!("<th>{name}, before</th><th>{name}, after</th>"));
    }
    out.push_str("</tr>");
    let row = |name: &str, values: Vec<String>| {
        let cells: String = values.iter().map(|v| format!("<td>{v}</td>")).collect();
        format!("<tr><td>{}</td>{cells}</tr>", escaped(name))
    };
    let (b, a) = (&diagnosis.before, &diagnosis.after);
    let whole = splits.iter().flat_map(|s| [b.chi2(*s), a.chi2(*s)]);
    out.push_str(&row("reduced chi-square", whole.map(|x| format!("{x:.4}")).collect()));
    for (k, signal) in study.plan.signals.iter().enumerate() {
        let of = |hypothesis: &Hypothesis, split: Split| {
            let multiple = hypothesis.sums(split).of_signal(k);
            let rmse = multiple * study.data.sigmas[k];
            let (rmse, unit) = (rmse_shown(rmse), escaped(&signal.unit_name));
            format!("{rmse} {unit} ({multiple:.2} x noise)")
        };
        let values = splits.iter().flat_map(|s| [of(b, *s), of(a, *s)]);
        out.push_str(&row(&signal.column, values.collect()));
    }
    out.push_str("</table>");
    let wholes: Vec<_> = splits.into_iter().map(|s| (s, study.data.wholes(s))).collect();
    let most = wholes.iter().map(|(_, w)| w.len()).max().unwrap_or(0);
    if !(2..=LISTED).contains(&most) {
        return;
    }
    out.push_str("<table><tr><th>recording</th><th></th><th>signal</th><th>RMSE, before</th><th>RMSE, after</th></tr>");
    for (split, names) in wholes {
        for (name, (k, signal)) in
            names.iter().flat_map(|n| study.plan.signals.iter().enumerate().map(move |s| (n, s)))
        {
            let [before, after] = [b, a].map(|h| rmse_of(&study.data, h, split, k, name));
            let (name, column, unit) =
                (escaped(name), escaped(&signal.column), escaped(&signal.unit_name));
            out.push_str(&format!(
                "<tr><td>{name}</td><td>{}</td><td>{column}</td><td>{before:.4e} {unit}</td><td>{after:.4e} {unit}</td></tr>",
                split.name()
            ));
        }
    }
    out.push_str("</table>");
}

/// The parameters of the model before and after, and those of the effects.
fn parameters(study: &Study, diagnosis: &Diagnosis, out: &mut String) {
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    out.push_str("<table><tr><th>parameter</th><th>before</th><th>after</th><th>unit</th></tr>");
    let cell = |hypothesis: &Hypothesis, name: &str| match hypothesis.estimate(name) {
        Some((value, _)) if hypothesis.is_at_bound(name) => {
            format!("<td>{value:.4e}, at its bound</td>")
        }
        Some((value, error)) if error.is_finite() => {
            format!("<td>{} ± {error:.1e}</td>", shown(value, error))
        }
        Some((value, _)) => format!("<td>{value:.4e}, not determined</td>"),
        None => "<td></td>".to_owned(),
    };
    for target in study.plan.free.iter().filter_map(|f| f.targets.first()) {
        let (name, unit) = (escaped(target), escaped(&pretty(study.unit(target))));
        let (before, after) = (cell(before, target), cell(after, target));
        out.push_str(&format!("<tr><td>{name}</td>{before}{after}<td>{unit}</td></tr>"));
    }
    for (full, _, _, unit) in estimates(&study.effects, after) {
        let (name, unit) = (escaped(&full), escaped(&pretty(&unit)));
        let (before, after) = (cell(before, &full), cell(after, &full));
        out.push_str(&format!("<tr><td>{name}</td>{before}{after}<td>{unit}</td></tr>"));
    }
    out.push_str("</table>");
}

fn rank(study: &Study, ranking: &[Vec<Scored>], cost: f64, out: &mut String) {
    out.push_str("<table><tr><th>effect</th><th>at</th><th>promises</th><th></th></tr>");
    for proposal in ranking {
        let share = 100.0 * proposal.first().map_or(0.0, |s| s.gain) / cost;
        let (effects, places) =
            listed(study, proposal.iter().map(|s| (s.effect, s.place.at.join(", "))));
        out.push_str(&format!(
            "<tr><td>{effects}</td><td>{places}</td><td>{share:.1} %</td><td style=\"width:220px\"><div class=\"bar\" style=\"width:{share:.1}%\"></div></td></tr>"
        ));
    }
    out.push_str("</table>");
}

/// Effects and their places, one line each.
fn listed(study: &Study, all: impl Iterator<Item = (usize, String)>) -> (String, String) {
    let (effects, places): (Vec<String>, Vec<String>) =
        all.map(|(effect, at)| (escaped(&study.effects[effect].class), escaped(&at))).unzip();
    (effects.join("<br>"), places.join("<br>"))
}

fn rejected(study: &Study, diagnosis: &Diagnosis, out: &mut String) {
    out.push_str("<table><tr><th>effect</th><th>at</th><th>BIC above the best</th><th>train</th><th>validation</th></tr>");
    for hypothesis in &diagnosis.rejected {
        let places = |group: &[ChosenEffect]| -> String {
            let at: Vec<String> = group.iter().map(|c| c.place.at.join(", ")).collect();
            at.join(", ")
        };
        let (effects, at) =
            listed(study, groups(&hypothesis.effects).map(|g| (g[0].effect, places(g))));
        out.push_str(&format!(
            "<tr><td>{effects}</td><td>{at}</td><td>{:.1}</td><td>{:.4}</td><td>{:.4}</td></tr>",
            hypothesis.bic() - diagnosis.after.bic(),
            hypothesis.chi2_train(),
            hypothesis.chi2_validation()
        ));
    }
    out.push_str("</table>");
}
