//! A diagnosis for people: the summary for the terminal and one page of HTML that needs nothing else.

use crate::calibrate::calibration::shown;
use crate::calibrate::data::Split;
use crate::calibrate::plan::Signal;
use crate::report::markup::escaped;
use crate::report::page::diff::unified;
use crate::report::page::figure::{Curve, Panel, Stroke, figure, figure_over};
use crate::report::page::frame::Page;
use crate::report::scale::pretty;

use super::balance::{Balance, Course};
use super::case::Case;
use super::level::{Chosen, Level, groups};
use super::rank::Scored;
use super::residual::residuals;
use super::result::{estimates, rmse_of, sentences, verdict};
use super::search::Found;

/// Rows of the ranking that are shown.
const SHOWN: usize = 15;

/// What the terminal says.
pub fn summary(case: &Case<'_>, found: &Found, seconds: f64) -> String {
    let mut out = format!("{}: {}\n", case.base, verdict(found).name());
    for sentence in sentences(case.effects, &found.after.chosen) {
        out.push_str(&format!("  {sentence}\n"));
    }
    for (name, value, error, unit) in estimates(case.effects, &found.after) {
        let line = format!("    {name} = {} ± {error:.1e} {unit}", shown(value, error));
        out.push_str(&format!("{}\n", line.trim_end()));
    }
    out.push_str("  reduced chi-square       before      after\n");
    let pairs = [
        ("train", found.before.chi2_train(), found.after.chi2_train()),
        ("validation", found.before.chi2_validation(), found.after.chi2_validation()),
    ];
    for (name, before, after) in pairs {
        out.push_str(&format!("    {name:<12} {before:16.4} {after:10.4}\n"));
    }
    for repair in &case.data.repairs {
        out.push_str(&format!("  {repair}\n"));
    }
    out.push_str(&format!("  {seconds:.1} s\n"));
    out
}

/// The page.
pub fn html(
    case: &Case<'_>,
    found: &Found,
    (balances, law): (&[Balance], &[Course]),
    original: &str,
    amended: Option<&(String, String)>,
) -> String {
    let mut page = Page::new(&format!("{}: diagnosis", case.base));
    page.add(&format!(
        "<h1>{}</h1>\n<p class=\"verdict\">{}</p>\n",
        escaped(&case.base),
        verdict(found).name()
    ));
    for sentence in sentences(case.effects, &found.after.chosen) {
        page.add(&format!("<p>{}</p>\n", escaped(&sentence)));
    }
    if !case.data.repairs.is_empty() {
        let repair = |text: &String| format!("<p>{}</p>\n", escaped(text));
        page.section(
            "repairs",
            "Repairs",
            &case.data.repairs.iter().map(repair).collect::<String>(),
        );
    }
    let part = |write: &dyn Fn(&mut String)| {
        let mut out = String::new();
        write(&mut out);
        out
    };
    page.section("errors", "Misfit before and after", &part(&|out| errors(case, found, out)));
    if found.after.values.len() > case.plan.free.len() {
        let text = part(&|out| parameters(case, &found.after, out));
        page.section("parameters", "Parameters of the effects found", &text);
    }
    if !balances.is_empty() {
        page.section("balances", "Balances that do not close", &unbalanced(balances, law));
    }
    for (depth, ranking) in found.rankings.iter().enumerate() {
        let cost = if depth == 0 { found.before.train.total() } else { found.after.train.total() };
        let mut text = "<p>Fraction of the sum of squares that each effect could explain, by the score test, before any is fitted.</p>\n".to_owned();
        let each: Vec<Vec<Scored>> = ranking.iter().take(SHOWN).map(|s| vec![s.clone()]).collect();
        rank(case, &each, cost, &mut text);
        let number = depth + 1;
        page.section(&format!("ranking-{number}"), &format!("Ranking {number}"), &text);
    }
    if !found.pairs.is_empty() {
        let mut text = "<p>One effect leaves structure in the residuals. Fraction of the sum of squares that two effects could explain together.</p>\n".to_owned();
        rank(case, &found.pairs, found.before.train.total(), &mut text);
        page.section("pairs", "Pairs of effects", &text);
    }
    if !found.rejected.is_empty() {
        let text = part(&|out| rejected(case, found, out));
        page.section("rejected", "Fitted and rejected", &text);
    }
    page.section("residuals", "Residuals of each recording", &multiples(case, found));
    if let Some((_, text)) = amended {
        page.section("amended", "Changes to the model", &unified(original, text));
    }
    page.finish()
}

/// Balances that are listed, and those of them whose inflow is drawn.
const LISTED: usize = 8;
const DRAWN: usize = 2;

/// The inflows that the calibrated model would need, over time and over what they could depend on.
fn unbalanced(balances: &[Balance], law: &[Course]) -> String {
    let mut out = String::from(
        "<p>For each balance of the calibrated model, before any effect is added: the fraction of the sum of squares that an unknown inflow, free over time, would explain, to first order. Dots show the inflow of each recording and the contribution of the effect found.</p>\n<table><tr><th>balance</th><th>explains</th><th>ordered best by</th></tr>",
    );
    let ordered = |b: &Balance| {
        let name = b.ordered_by.and_then(|k| b.courses.first()?.over.get(k));
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
        let over_time = b.courses.iter().enumerate().map(|(colour, c)| Curve {
            name: c.recording.clone(),
            x: c.time.to_vec(),
            y: c.inflow.clone(),
            stroke: Stroke::Line,
            colour,
        });
        out.push_str(&figure(&format!("balance-{k}"), &panel(over_time.collect())));
        for (j, (name, unit, _)) in b.courses.first().iter().flat_map(|c| c.over.iter().enumerate())
        {
            let over = b.courses.iter().enumerate().map(|(colour, c)| {
                let mut pairs: Vec<(f64, f64)> =
                    c.over[j].2.iter().copied().zip(c.inflow.iter().copied()).collect();
                pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
                let (x, y) = pairs.into_iter().unzip();
                Curve { name: c.recording.clone(), x, y, stroke: Stroke::Points, colour }
            });
            let mut curves: Vec<Curve> = over.collect();
            curves.extend(found_over(name, law, b.courses.len()).filter(|_| k == 0));
            let id = format!("balance-{k}-{name}");
            out.push_str(&figure_over(&id, (name, unit), &panel(curves)));
        }
    }
    out
}

/// What the effect that was found contributes, over a variable of its place.
fn found_over(name: &str, law: &[Course], colour: usize) -> Option<Curve> {
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for course in law {
        let (.., values) = course.over.iter().find(|(own, ..)| own == name)?;
        pairs.extend(values.iter().copied().zip(course.inflow.iter().copied()));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    let curve = Curve { name: "found".to_owned(), x, y, stroke: Stroke::Points, colour };
    (!curve.x.is_empty()).then_some(curve)
}

/// Residuals in units of the noise: a small figure for each recording, a panel for each signal.
fn multiples(case: &Case<'_>, found: &Found) -> String {
    let mut out = String::from(
        "<p>Model minus measurement, in units of the sensor noise, before and after.</p>\n<div class=\"multiples\">\n",
    );
    let kept = !found.after.chosen.is_empty();
    for (i, r) in residuals(case, found).iter().enumerate() {
        let curve = |name: &str, all: &[Vec<f64>], k: usize, colour| {
            let (x, y) = (r.time.to_vec(), all.get(k)?.clone());
            Some(Curve { name: name.to_owned(), x, y, stroke: Stroke::Line, colour })
        };
        let panel = |(k, signal): (usize, &Signal)| {
            let after = if kept { curve("after", &r.after, k, 0) } else { None };
            let curves = curve("before", &r.before, k, 1).into_iter().chain(after).collect();
            let (label, unit) = (signal.column.clone(), String::new());
            Panel { label, display_unit: unit.clone(), unit, curves, height: Some(90) }
        };
        let panels: Vec<Panel> = case.plan.signals.iter().enumerate().map(panel).collect();
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

fn errors(case: &Case<'_>, found: &Found, out: &mut String) {
    out.push_str("<table><tr><th></th><th>train, before</th><th>train, after</th><th>validation, before</th><th>validation, after</th></tr>");
    let row = |name: &str, values: [String; 4]| {
        let cells: String = values.iter().map(|v| format!("<td>{v}</td>")).collect();
        format!("<tr><td>{}</td>{cells}</tr>", escaped(name))
    };
    let (b, a) = (&found.before, &found.after);
    let whole = [b.chi2_train(), a.chi2_train(), b.chi2_validation(), a.chi2_validation()];
    out.push_str(&row("reduced chi-square", whole.map(|x| format!("{x:.4}"))));
    for (k, signal) in case.plan.signals.iter().enumerate() {
        let of = |level: &Level, split: Split| {
            let sums = if split == Split::Train { &level.train } else { &level.validation };
            let multiple = sums.of_signal(k);
            let rmse = multiple * case.data.sigmas[k];
            format!("{rmse:.4} {} ({multiple:.2} x noise)", escaped(&signal.unit_name))
        };
        let values = [
            of(b, Split::Train),
            of(a, Split::Train),
            of(b, Split::Validation),
            of(a, Split::Validation),
        ];
        out.push_str(&row(&signal.column, values));
    }
    out.push_str("</table>");
    let wholes = [Split::Train, Split::Validation].map(|s| (s, case.data.wholes(s)));
    let most = wholes.iter().map(|(_, w)| w.len()).max().unwrap_or(0);
    if !(2..=LISTED).contains(&most) {
        return;
    }
    out.push_str("<table><tr><th>recording</th><th></th><th>signal</th><th>RMSE, before</th><th>RMSE, after</th></tr>");
    for (split, names) in wholes {
        for (name, (k, signal)) in
            names.iter().flat_map(|n| case.plan.signals.iter().enumerate().map(move |s| (n, s)))
        {
            let [before, after] = [b, a].map(|level| rmse_of(case.data, level, split, k, name));
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

fn parameters(case: &Case<'_>, level: &Level, out: &mut String) {
    out.push_str(
        "<table><tr><th>parameter</th><th>value</th><th>standard error</th><th>unit</th></tr>",
    );
    for (name, value, error, unit) in estimates(case.effects, level) {
        let (name, value, unit) = (escaped(&name), shown(value, error), escaped(&pretty(&unit)));
        out.push_str(&format!(
            "<tr><td>{name}</td><td>{value}</td><td>{error:.1e}</td><td>{unit}</td></tr>"
        ));
    }
    out.push_str("</table>");
}

fn rank(case: &Case<'_>, ranking: &[Vec<Scored>], cost: f64, out: &mut String) {
    out.push_str("<table><tr><th>effect</th><th>at</th><th>score</th><th></th></tr>");
    for proposal in ranking {
        let share = 100.0 * proposal.first().map_or(0.0, |s| s.gain) / cost;
        let (effects, places) =
            listed(case, proposal.iter().map(|s| (s.effect, s.place.at.join(", "))));
        out.push_str(&format!(
            "<tr><td>{effects}</td><td>{places}</td><td>{share:.1} %</td><td style=\"width:220px\"><div class=\"bar\" style=\"width:{share:.1}%\"></div></td></tr>"
        ));
    }
    out.push_str("</table>");
}

/// Effects and their places, a line each.
fn listed(case: &Case<'_>, all: impl Iterator<Item = (usize, String)>) -> (String, String) {
    let (effects, places): (Vec<String>, Vec<String>) =
        all.map(|(effect, at)| (escaped(&case.effects[effect].class), escaped(&at))).unzip();
    (effects.join("<br>"), places.join("<br>"))
}

fn rejected(case: &Case<'_>, found: &Found, out: &mut String) {
    out.push_str("<table><tr><th>effect</th><th>at</th><th>BIC above the best</th><th>train</th><th>validation</th></tr>");
    for level in &found.rejected {
        let places = |group: &[Chosen]| -> String {
            let at: Vec<String> = group.iter().map(|c| c.place.at.join(", ")).collect();
            at.join(", ")
        };
        let (effects, at) = listed(case, groups(&level.chosen).map(|g| (g[0].effect, places(g))));
        out.push_str(&format!(
            "<tr><td>{effects}</td><td>{at}</td><td>{:.1}</td><td>{:.4}</td><td>{:.4}</td></tr>",
            level.bic() - found.after.bic(),
            level.chi2_train(),
            level.chi2_validation()
        ));
    }
    out.push_str("</table>");
}
