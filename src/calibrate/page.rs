//! A calibration as one page of HTML that needs nothing else: estimates, quality of the fit, and each
//! recording beside what the model says.

use crate::ir::trajectory::{Column, Trajectory};
use crate::report::figure::{Panel, PlotError, PlotSpec};
use crate::report::plot;

use super::calibration::{Calibration, Comparison, Estimate, Quality, remark, shown};
use super::data::Split;

/// Height of a panel of a recording, px.
const PANEL: u32 = 165;
/// Reduced sums of squares above which a cell of a table is marked.
const NOTICEABLE: f64 = 1.1;
/// Correlations whose size is below this are shown pale.
const PALE: f64 = 0.3;

const STYLE: &str = "\
body{font:15px/1.5 system-ui,-apple-system,'Segoe UI',sans-serif;color:#1a1a1a;background:#f6f7f9;margin:0}
main{max-width:1080px;margin:0 auto;padding:24px 32px 64px}
h1{font-size:26px;margin:8px 0 2px}h2{font-size:19px;margin:36px 0 10px}
p{margin:4px 0}.sub{color:#667}
section,details{background:#fff;border:1px solid #e3e6ea;border-radius:8px;padding:14px 18px;overflow-x:auto}
details{margin:8px 0;padding:10px 18px}summary{cursor:pointer;font-weight:600}summary span{font-weight:400;color:#667}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{font-weight:600;color:#556;border-bottom:1px solid #cfd4da}
th,td{text-align:right;padding:4px 10px;white-space:nowrap}td{border-bottom:1px solid #eef0f3}
th:first-child,td:first-child,.l{text-align:left}code{font:14px ui-monospace,Menlo,Consolas,monospace}
.facts{display:flex;gap:14px;flex-wrap:wrap;margin:18px 0}
.fact{background:#fff;border:1px solid #e3e6ea;border-radius:8px;padding:10px 18px}
.fact b{display:block;font-size:22px}.fact span{color:#667;font-size:13px}
.bad{background:#fdeee3;color:#a33c00}.note{color:#a33c00}
.matrix td,.matrix th{padding:3px 6px;font-size:12.5px}
.range{width:190px}svg{max-width:100%;height:auto}";

/// The page.
pub fn html(found: &Calibration) -> Result<String, PlotError> {
    let mut out = String::from("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">");
    out.push_str("<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">");
    out.push_str(&format!("<title>{} calibrated</title>", escaped(&found.model)));
    out.push_str(&format!("<style>{STYLE}</style></head><body><main>\n"));
    out.push_str(&format!("<h1>{} calibrated</h1>", escaped(&found.model)));
    out.push_str(&format!("<p class=\"sub\">{}</p>\n", escaped(&found.plan)));
    if !found.search.complete {
        out.push_str(
            "<p class=\"note\">The search was interrupted: this is the best so far.</p>\n",
        );
    } else if !found.search.converged {
        out.push_str("<p class=\"note\">The search ended before it had converged.</p>\n");
    }
    facts(found, &mut out);
    out.push_str("<h2>Parameters</h2>\n<section>");
    parameters(found, &mut out);
    out.push_str("</section>\n<h2>Quality of the fit</h2>\n<section>");
    quality(found, &mut out);
    out.push_str("</section>\n<h2>Correlations</h2>\n<section>");
    correlations(found, &mut out);
    out.push_str("</section>\n");
    if !found.repairs.is_empty() {
        out.push_str("<h2>Repairs</h2>\n<section>");
        for repair in &found.repairs {
            out.push_str(&format!("<p>{}</p>", escaped(repair)));
        }
        out.push_str("</section>\n");
    }
    out.push_str("<h2>Recordings</h2>\n");
    for (i, c) in found.comparisons.iter().enumerate() {
        let open = if i == 0 { " open" } else { "" };
        let chi = c.whole().reduced();
        out.push_str(&format!(
            "<details{open}><summary>{} <span>{}, reduced &chi;&sup2; {chi:.3}</span></summary>\n",
            escaped(&c.name),
            c.split.name()
        ));
        out.push_str(&picture(c, found)?);
        out.push_str("</details>\n");
    }
    out.push_str("</main></body></html>\n");
    Ok(out)
}

fn facts(found: &Calibration, out: &mut String) {
    out.push_str("<div class=\"facts\">");
    let mut fact = |value: String, what: &str| {
        out.push_str(&format!("<div class=\"fact\"><b>{value}</b><span>{what}</span></div>"));
    };
    let train = found.quality(Split::Train, None);
    let validation = found.quality(Split::Validation, None);
    fact(format!("{:.4}", found.reduced_train()), "reduced &chi;&sup2;, training");
    if validation.count > 0 {
        fact(format!("{:.4}", validation.reduced()), "reduced &chi;&sup2;, validation");
    }
    let count = train.count + validation.count;
    fact(count.to_string(), "measured values");
    fact(found.search.iterations.to_string(), "steps");
    fact(format!("{:.1} s", found.search.seconds), "on the clock");
    out.push_str("</div>\n");
}

fn parameters(found: &Calibration, out: &mut String) {
    out.push_str("<table><tr><th>parameter</th><th>value</th><th>std. error</th>");
    out.push_str("<th>95 % interval</th><th class=\"l\">unit</th><th>start</th>");
    out.push_str("<th class=\"l\">interval (value = 1)</th><th class=\"l\"></th></tr>\n");
    for e in &found.estimates {
        out.push_str(&format!(
            "<tr><td><code>{}</code></td><td><b>{}</b></td><td>{}</td><td>{}</td>\
             <td class=\"l\">{}</td><td>{}</td><td class=\"range\">{}</td>\
             <td class=\"l note\">{}</td></tr>\n",
            escaped(&e.name),
            shown(e.value, e.error),
            shown(e.error, 10.0 * e.error),
            found.interval_shown(e),
            escaped(&e.unit),
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

/// The interval in parts of the value, from half of it to one and a half.
fn range(e: &Estimate) -> String {
    let part = |x: f64| (190.0 * (x / e.value - 0.5)).clamp(0.0, 190.0);
    let (a, b) = (part(e.interval.low), part(e.interval.high));
    if !(a.is_finite() && b.is_finite()) {
        return String::new();
    }
    let (left, width) = (a.min(b), (b - a).abs().max(2.0));
    format!(
        "<svg width=\"190\" height=\"14\"><path d=\"M0 7H190\" stroke=\"#dde1e6\"/>\
         <rect x=\"{left:.1}\" y=\"3\" width=\"{width:.1}\" height=\"8\" rx=\"2\" fill=\"#5b9bd0\"/>\
         <path d=\"M95 0V14\" stroke=\"#0072b2\" stroke-width=\"2\"/></svg>"
    )
}

fn quality(found: &Calibration, out: &mut String) {
    out.push_str("<table><tr><th>rmse (reduced &chi;&sup2;)</th>");
    for c in &found.channels {
        let (column, unit) = (escaped(&c.column), escaped(&c.unit));
        out.push_str(&format!("<th>{column}, {unit}</th>"));
    }
    out.push_str("<th>all</th></tr>\n");
    let cell = |q: Quality, k: usize| {
        let rmse = shown(q.rmse(found.channels[k].sigma), 0.0);
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
            let ink = if rho.abs() < PALE { "#99a" } else { "#1a1a1a" };
            let depth = 0.75 * rho.abs();
            out.push_str(&format!(
                "<td style=\"background:rgba({colour},{depth:.2});color:{ink}\">{rho:.2}</td>"
            ));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table>");
}

/// Each signal measured and modelled, and below all of their residuals.
fn picture(c: &Comparison, found: &Calibration) -> Result<String, PlotError> {
    let mut run = Trajectory { time: c.time.clone(), ..Trajectory::default() };
    let mut panels = Vec::new();
    let mut residuals = Panel { curves: Vec::new(), label: "residuals / noise".to_owned() };
    let mut add = |name: String, unit: &str, values: Vec<f64>, panel: &mut Panel| {
        run.columns.push(Column::new(&name, unit));
        run.data.push(values);
        panel.curves.push(name);
    };
    for (k, channel) in found.channels.iter().enumerate() {
        let mut panel = Panel { curves: Vec::new(), label: channel.variable.clone() };
        let si = |values: &[f64]| values.iter().map(|v| channel.si.to_si(*v)).collect();
        let (measured, predicted) = (filled(&c.measured[k], &c.predicted[k]), &c.predicted[k]);
        add(format!("{} measured", channel.column), &channel.si_unit, si(&measured), &mut panel);
        add(format!("{} model", channel.column), &channel.si_unit, si(predicted), &mut panel);
        panels.push(panel);
        let of_noise = predicted.iter().zip(&measured).map(|(p, m)| (p - m) / channel.sigma);
        add(channel.column.clone(), "", of_noise.collect(), &mut residuals);
    }
    panels.push(residuals);
    let height = 90 + PANEL * panels.len() as u32;
    plot::svg(&run, &PlotSpec { height, ..PlotSpec::new("", panels) })
}

/// The values, where there are none those of the model: their residual is drawn as zero.
fn filled(measured: &[f64], predicted: &[f64]) -> Vec<f64> {
    measured.iter().zip(predicted).map(|(m, p)| if m.is_nan() { *p } else { *m }).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
