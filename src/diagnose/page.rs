//! The summary of a diagnosis for the terminal, and its self-contained HTML page.

use crate::calibrate::data::Split;
use crate::calibrate::plan::Signal;
use crate::calibrate::table::{rmse_shown, shown};
use crate::report::markup::escaped;
use crate::report::page::diff::unified;
use crate::report::page::figure::{Curve, Panel, Stroke, figure, figure_over};
use crate::report::page::frame::Page;
use crate::report::scale::pretty;

use super::balance::{Balance, Profile};
use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::next_experiment::Prediction;
use super::next_text::{label, lines};
use super::rank::Scored;
use super::residual::residuals;
use super::result::{Diagnosis, Verdict, estimates, rmse_of, sentences};
use super::run::Outcome;
use super::study::Study;

/// Rows of a ranking to show.
const RANKED: usize = 15;

/// The summary for the terminal.
pub fn summary(outcome: &Outcome, seconds: f64) -> String {
    let Outcome { study, diagnosis, .. } = outcome;
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let mut out = format!("{}: {}\n", study.base, outcome.verdict().name());
    if !outcome.complete {
        out.push_str(&format!("  {ENDED_EARLY}\n"));
    }
    for sentence in sentences(&study.effects, &after.effects) {
        out.push_str(&format!("  {}{sentence}\n", partial(outcome)));
    }
    for (name, value, error, unit) in estimates(&study.effects, after) {
        let line = format!("    {name} = {} ± {error:.1e} {unit}", shown(value, error));
        out.push_str(&format!("{}\n", line.trim_end()));
    }
    out.push_str("  reduced chi-square       before      after\n");
    let pairs = study.data.splits().map(|s| (s.name(), before.chi2(s), after.chi2(s)));
    for (name, before, after) in pairs {
        out.push_str(&format!("    {name:<12} {before:16.4} {after:10.4}\n"));
    }
    out.push_str("  rmse                     before      after\n");
    for split in study.data.splits() {
        for (k, signal) in study.plan.signals.iter().enumerate() {
            let label = format!("{}, {}", signal.column, split.name());
            let [before, after] = [before, after].map(|hypothesis| {
                rmse_shown(hypothesis.sums(split).of_signal(k) * study.data.sigmas[k])
            });
            let unit = &signal.unit_name;
            out.push_str(&format!("    {label:<19} {before:>9} {after:>10} {unit}\n"));
        }
    }
    for line in noise_lines(outcome) {
        out.push_str(&format!("  {line}\n"));
    }
    for line in lines(outcome) {
        out.push_str(&format!("  {line}\n"));
    }
    for repair in &study.data.repairs {
        out.push_str(&format!("  {repair}\n"));
    }
    out.push_str(&format!("  {seconds:.1} s\n"));
    out
}

/// Remark on a result of a search that was ended early.
const ENDED_EARLY: &str = "the search was ended early: this is the best verdict so far";

/// What precedes the sentence about an effect that leaves structure unexplained.
fn partial(outcome: &Outcome) -> &'static str {
    if outcome.verdict() == Verdict::Unexplained { "partial explanation: " } else { "" }
}

/// A line for each signal with noticeably more or less noise than the plan declares.
fn noise_lines(outcome: &Outcome) -> Vec<String> {
    let factors = outcome.diagnosis.noise.factors(&outcome.study);
    let line = |(column, factor): (&str, f64)| {
        format!("the noise of {column} is {factor:.2} times what the plan says")
    };
    factors.into_iter().map(line).collect()
}

/// A text with a capital letter at its start.
fn sentence_case(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    first + characters.as_str()
}

/// The page.
pub fn html(outcome: &Outcome) -> String {
    let Outcome { study, diagnosis, .. } = outcome;
    let after = &diagnosis.after;
    let mut page = Page::new(&format!("{}: diagnosis", study.base));
    page.add(&format!(
        "<h1>{}</h1>\n<p class=\"verdict {verdict}\">{verdict}</p>\n",
        escaped(&study.base),
        verdict = outcome.verdict().name()
    ));
    if !outcome.complete {
        page.add(&format!("<p class=\"note\">{}</p>\n", sentence_case(ENDED_EARLY)));
    }
    for sentence in sentences(&study.effects, &after.effects) {
        let text = sentence_case(&format!("{}{sentence}", partial(outcome)));
        page.add(&format!("<p>{}</p>\n", escaped(&text)));
    }
    for line in noise_lines(outcome) {
        page.add(&format!("<p>{}.</p>\n", escaped(&sentence_case(&line))));
    }
    if !study.data.repairs.is_empty() {
        let repair = |text: &String| format!("<p>{}</p>\n", escaped(text));
        page.section(
            "repairs",
            "Repairs",
            &study.data.repairs.iter().map(repair).collect::<String>(),
        );
    }
    let part = |write: &dyn Fn(&mut String)| {
        let mut out = String::new();
        write(&mut out);
        out
    };
    page.section("errors", "Error before and after", &part(&|out| errors(study, diagnosis, out)));
    if after.values.len() > study.plan.free.len() {
        let text = part(&|out| parameters(study, after, out));
        page.section("parameters", "Parameters of the effects", &text);
    }
    if !outcome.balances.is_empty() {
        let text = unbalanced(&outcome.balances, &outcome.contributions);
        page.section("balances", "Balances that do not close", &text);
    }
    let next = lines(outcome);
    if !next.is_empty() {
        page.section("next", "Next experiment", &next_section(study, outcome, &next));
    }
    for (depth, ranking) in diagnosis.rankings.iter().enumerate() {
        let cost = if depth == 0 { diagnosis.before.train.total() } else { after.train.total() };
        let mut text = "<p>Share of the sum of squares that each effect promises to explain, before any is fitted.</p>\n".to_owned();
        let each: Vec<Vec<Scored>> = ranking.iter().take(RANKED).map(|s| vec![s.clone()]).collect();
        rank(study, &each, cost, &mut text);
        let number = depth + 1;
        page.section(&format!("ranking-{number}"), &format!("Ranking {number}"), &text);
    }
    if !diagnosis.pairs.is_empty() {
        let mut text = "<p>One effect does not explain everything. Share of the sum of squares that two effects promise to explain together.</p>\n".to_owned();
        rank(study, &diagnosis.pairs, diagnosis.before.train.total(), &mut text);
        page.section("pairs", "Pairs of effects", &text);
    }
    if !diagnosis.rejected.is_empty() {
        let text = part(&|out| rejected(study, diagnosis, out));
        page.section("rejected", "Fitted and rejected", &text);
    }
    page.section("residuals", "Residuals of each recording", &multiples(study, diagnosis));
    if let Some(amended) = &outcome.amended {
        let text = unified(&outcome.original, &amended.source);
        page.section("amended", "Additions to the model", &text);
    }
    page.finish()
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
fn multiples(study: &Study, diagnosis: &Diagnosis) -> String {
    let mut out = String::from(
        "<p>Model minus measurement, in units of the sensor's noise, without the effects and with them.</p>\n<div class=\"multiples\">\n",
    );
    let has_effects = !diagnosis.after.effects.is_empty();
    for (i, r) in residuals(study, diagnosis).iter().enumerate() {
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
    out.push_str("<table><tr><th></th>");
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
            format!("{rmse:.4} {} ({multiple:.2} x noise)", escaped(&signal.unit_name))
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

fn parameters(study: &Study, hypothesis: &Hypothesis, out: &mut String) {
    out.push_str(
        "<table><tr><th>parameter</th><th>value</th><th>standard error</th><th>unit</th></tr>",
    );
    for (name, value, error, unit) in estimates(&study.effects, hypothesis) {
        let (name, value, unit) = (escaped(&name), shown(value, error), escaped(&pretty(&unit)));
        out.push_str(&format!(
            "<tr><td>{name}</td><td>{value}</td><td>{error:.1e}</td><td>{unit}</td></tr>"
        ));
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
