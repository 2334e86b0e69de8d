//! A calibration as one self-contained HTML page: estimates, quality of the fit, and each recording
//! compared with the model.

use crate::report::markup::escaped;
use crate::report::page::figure::{Curve, Panel, Stroke, figure};
use crate::report::page::frame::{Page, facts};

use super::data::Split;
use super::result::{Calibration, Comparison, Estimate, Quality};
use super::table::{remark, rmse_shown, shown};

/// Reduced sum of squares above which a cell of a table is marked.
const NOTICEABLE: f64 = 1.1;
/// Correlations of smaller magnitude are shown pale.
const PALE: f64 = 0.3;
/// Opacity of the ground of a correlation of 1, on which text of either colour scheme can be read.
const DEPTH: f64 = 0.6;

/// Width of the picture of an interval, px.
const WIDTH: f64 = 190.0;

/// The page.
pub fn html(found: &Calibration, seconds: f64) -> String {
    let mut page = Page::new(&format!("{} calibrated", found.model));
    page.add(&format!("<h1>{} calibrated</h1>\n", escaped(&found.model)));
    page.add(&format!("<p class=\"sub\">{}</p>\n", escaped(&found.plan)));
    if !found.fit.complete {
        page.add(
            "<p class=\"note\">The fit was interrupted: these are the best values so far.</p>\n",
        );
    } else if !found.fit.converged {
        page.add("<p class=\"note\">The fit ended before it converged.</p>\n");
    }
    let part = |write: &dyn Fn(&Calibration, &mut String)| {
        let mut out = String::new();
        write(found, &mut out);
        out
    };
    page.add(&facts(&key_figures(found, seconds)));
    page.section("parameters", "Parameters", &part(&parameters));
    if !found.own.is_empty() {
        page.section("each", "Values of each recording", &part(&own));
    }
    page.section("quality", "Quality of the fit", &part(&quality));
    page.section("correlations", "Correlations", &part(&correlations));
    if !found.repairs.is_empty() {
        let repair = |r: &String| format!("<p>{}</p>\n", escaped(r));
        page.section("repairs", "Repairs", &found.repairs.iter().map(repair).collect::<String>());
    }
    page.add("<h2>Recordings</h2>\n");
    for (i, c) in found.comparisons.iter().enumerate() {
        let open = if i == 0 { " open" } else { "" };
        let chi = c.whole().reduced();
        page.add(&format!(
            "<details{open}><summary>{} <span>{}, reduced \u{3c7}\u{b2} {chi:.3}</span></summary>\n",
            escaped(&c.name),
            c.split.name()
        ));
        page.add(&figure(&format!("recording-{i}"), &panels(c, found)));
        page.add("</details>\n");
    }
    page.finish()
}

/// The figures at the top of the page.
fn key_figures(found: &Calibration, seconds: f64) -> Vec<(String, String)> {
    let train = found.quality(Split::Train, None);
    let validation = found.quality(Split::Validation, None);
    let chi = "reduced \u{3c7}\u{b2}";
    let mut out = vec![(format!("{chi}, training"), format!("{:.4}", found.reduced_train()))];
    if validation.count > 0 {
        out.push((format!("{chi}, validation"), format!("{:.4}", validation.reduced())));
    }
    let test = found.quality(Split::Test, None);
    if test.count > 0 {
        out.push((format!("{chi}, test"), format!("{:.4}", test.reduced())));
    }
    let count = train.count + validation.count + test.count;
    out.push(("measured values".to_owned(), count.to_string()));
    out.push(("steps".to_owned(), found.fit.iterations.to_string()));
    out.push(("elapsed time".to_owned(), format!("{:.1} s", seconds)));
    out
}

fn parameters(found: &Calibration, out: &mut String) {
    out.push_str("<table><tr><th>parameter</th><th>value</th><th class=\"l\">unit</th>");
    out.push_str("<th>std. error</th><th>95 % interval</th><th>start</th>");
    out.push_str(
        "<th class=\"l\">start / 2 &hellip; start &middot; 2</th><th class=\"l\"></th></tr>\n",
    );
    for e in &found.estimates {
        out.push_str(&format!(
            "<tr><td><code>{}</code></td><td><b>{}</b></td><td class=\"l\">{}</td><td>{}</td>\
             <td>{}</td><td>{}</td><td class=\"range\">{}</td>\
             <td class=\"l note\">{}</td></tr>\n",
            escaped(&e.name),
            shown(e.value, e.error),
            escaped(&e.unit),
            shown(e.error, 10.0 * e.error),
            found.interval_shown(e),
            shown(e.start, 0.0),
            range(e),
            remark(e),
        ));
    }
    out.push_str("</table>");
    for line in &found.directions {
        out.push_str(&format!("<p class=\"note\">{}</p>", escaped(line)));
    }
}

fn own(found: &Calibration, out: &mut String) {
    out.push_str("<table><tr><th>recording</th><th class=\"l\"></th>");
    for v in found.own.iter().take(1).flat_map(|o| &o.values) {
        out.push_str(&format!("<th><code>{}</code>, {}</th>", escaped(&v.name), escaped(&v.unit)));
    }
    out.push_str("</tr>\n");
    for o in &found.own {
        let (name, split) = (escaped(&o.recording), o.split.name());
        out.push_str(&format!("<tr><td>{name}</td><td class=\"l\">{split}</td>"));
        for v in &o.values {
            let (value, error) = (shown(v.value, v.error), shown(v.error, 10.0 * v.error));
            out.push_str(&format!("<td>{value} ± {error}</td>"));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table>");
}

/// The interval beside the start, from half of the start to twice as much.
fn range(e: &Estimate) -> String {
    let part = |x: f64| 0.5 * WIDTH * ((x / e.start).log2() + 1.0);
    let (a, b) = (part(e.interval.low), part(e.interval.high));
    let (left, right) = (a.min(b).clamp(0.0, WIDTH), a.max(b).clamp(0.0, WIDTH));
    if !(left.is_finite() && right.is_finite()) {
        return String::new();
    }
    let (middle, wide) = (0.5 * WIDTH, (right - left).max(3.0));
    format!(
        "<svg width=\"{WIDTH}\" height=\"14\"><path d=\"M0 7H{WIDTH}\" stroke=\"#dde1e6\"/>\
         <path d=\"M{middle} 1V13\" stroke=\"#99a\"/>\
         <rect x=\"{:.1}\" y=\"2\" width=\"{wide:.1}\" height=\"10\" rx=\"1\" fill=\"#0072b2\"/></svg>",
        0.5 * (left + right - wide)
    )
}

fn quality(found: &Calibration, out: &mut String) {
    out.push_str("<table class=\"wraps\"><tr><th>rmse (reduced \u{3c7}\u{b2})</th>");
    for c in &found.channels {
        let (column, unit) = (escaped(&c.column), escaped(&c.unit));
        out.push_str(&format!("<th>{column}, {unit}</th>"));
    }
    out.push_str("<th>all</th></tr>\n");
    let cell = |q: Quality, k: usize| {
        let rmse = rmse_shown(q.rmse(found.channels[k].sigma));
        format!("<td{}>{rmse} ({:.3})</td>", mark(q), q.reduced())
    };
    for split in Split::ALL {
        let all = found.quality(split, None);
        if all.count == 0 {
            continue;
        }
        let row = |name: &str, of: &dyn Fn(usize) -> Quality, all: Quality| {
            let cells: String = (0..found.channels.len()).map(|k| cell(of(k), k)).collect();
            format!("<tr><td>{name}</td>{cells}<td{}>{:.3}</td></tr>\n", mark(all), all.reduced())
        };
        let name = format!("<b>{}</b>", split.name());
        out.push_str(&row(&name, &|k| found.quality(split, Some(k)), all));
        for c in found.comparisons.iter().filter(|c| c.split == split) {
            out.push_str(&row(&escaped(&c.name), &|k| c.quality[k], c.whole()));
        }
    }
    out.push_str("</table>");
}

fn mark(q: Quality) -> &'static str {
    if q.reduced() > NOTICEABLE { " class=\"bad\"" } else { "" }
}

fn correlations(found: &Calibration, out: &mut String) {
    out.push_str("<table class=\"matrix\"><tr><th></th>");
    for e in &found.estimates {
        out.push_str(&format!("<th>{}</th>", escaped(&e.name)));
    }
    out.push_str("</tr>\n");
    for (e, row) in found.estimates.iter().zip(&found.correlations) {
        out.push_str(&format!("<tr><td><code>{}</code></td>", escaped(&e.name)));
        for rho in row {
            let colour = if *rho < 0.0 { "213,94,0" } else { "0,114,178" };
            let class = if rho.abs() < PALE { " class=\"sub\"" } else { "" };
            let depth = DEPTH * rho.abs();
            // Two digits of a small one are zero, without a sign.
            let rho = if rho.abs() < 0.005 { 0.0 } else { *rho };
            out.push_str(&format!(
                "<td{class} style=\"background:rgba({colour},{depth:.2})\">{rho:.2}</td>"
            ));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table>");
}

/// Measurement and model for each signal, and below them all residuals.
fn panels(c: &Comparison, found: &Calibration) -> Vec<Panel> {
    let mut panels = Vec::new();
    let mut residuals = Vec::new();
    let curve = |name: String, y: Vec<f64>, stroke, colour| Curve {
        name,
        x: c.time.clone(),
        y,
        stroke,
        colour,
    };
    for (k, channel) in found.channels.iter().enumerate() {
        let si = |values: &[f64]| values.iter().map(|v| channel.si.to_si(*v)).collect();
        let (measured, predicted) = (&c.measured[k], &c.predicted[k]);
        panels.push(Panel {
            label: channel.variable.clone(),
            unit: channel.si_unit.clone(),
            display_unit: String::new(),
            curves: vec![
                curve(format!("{} measured", channel.column), si(measured), Stroke::Points, 0),
                curve(format!("{} model", channel.column), si(predicted), Stroke::Line, 1),
            ],
            height: None,
        });
        let of_noise = predicted.iter().zip(measured).map(|(p, m)| (p - m) / channel.sigma);
        residuals.push(curve(channel.column.clone(), of_noise.collect(), Stroke::Line, k));
    }
    let label = "residuals / noise".to_owned();
    let (unit, display_unit) = (String::new(), String::new());
    panels.push(Panel { label, unit, display_unit, curves: residuals, height: None });
    panels
}
