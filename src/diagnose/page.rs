//! A diagnosis for people: the summary for the terminal and one page of HTML that needs nothing else.

use crate::calibrate::data::Split;

use super::result::{sentences, verdict};
use super::search::{Case, Found, Level, Scored};

/// Rows of the ranking that are shown.
const SHOWN: usize = 15;

/// What the terminal says.
pub fn summary(case: &Case<'_>, found: &Found, seconds: f64) -> String {
    let mut out = format!("{}: {}\n", case.base, verdict(found).name());
    for sentence in sentences(case.effects, &found.after.chosen) {
        out.push_str(&format!("  {sentence}\n"));
    }
    let first = case.plan.free.len();
    for (free, (value, error)) in found
        .after
        .plan
        .free
        .iter()
        .zip(found.after.values.iter().zip(&found.after.errors))
        .skip(first)
    {
        out.push_str(&format!("    {} = {value:.5e} +- {error:.1e}\n", free.name));
    }
    out.push_str("  reduced chi-square       before      after\n");
    let pairs = [
        ("train", found.before.chi2_train(), found.after.chi2_train()),
        ("validation", found.before.chi2_validation(), found.after.chi2_validation()),
    ];
    for (name, before, after) in pairs {
        out.push_str(&format!("    {name:<12} {before:16.4} {after:10.4}\n"));
    }
    out.push_str(&format!("  {seconds:.1} s\n"));
    out
}

const STYLE: &str = "\
body{font:15px/1.5 system-ui,-apple-system,'Segoe UI',sans-serif;color:#1a1a1a;background:#f6f7f9;margin:0}
main{max-width:1080px;margin:0 auto;padding:24px 32px 64px}
h1{font-size:26px;margin:8px 0 2px}h2{font-size:19px;margin:36px 0 10px}
section{background:#fff;border:1px solid #e3e6ea;border-radius:8px;padding:14px 18px;overflow-x:auto}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{font-weight:600;color:#556;border-bottom:1px solid #cfd4da}
th,td{text-align:right;padding:4px 10px}td{border-bottom:1px solid #eef0f3}
th:first-child,td:first-child{text-align:left}pre{font:13px ui-monospace,Menlo,Consolas,monospace}
.verdict{display:inline-block;padding:2px 14px;border-radius:14px;background:#e2f0e6;font-weight:600}
.bar{background:#4477aa;height:10px;border-radius:3px}";

/// The page.
pub fn html(case: &Case<'_>, found: &Found, amended: Option<&(String, String)>) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}: diagnosis</title><style>{STYLE}</style></head><body><main>\n<h1>{0}</h1><p class=\"verdict\">{1}</p>\n",
        escaped(&case.base),
        verdict(found).name()
    );
    for sentence in sentences(case.effects, &found.after.chosen) {
        out.push_str(&format!("<p>{}</p>\n", escaped(&sentence)));
    }
    out.push_str("<h2>Error before and after</h2><section>");
    errors(case, found, &mut out);
    out.push_str("</section>\n");
    if found.after.values.len() > case.plan.free.len() {
        out.push_str("<h2>Parameters of what was found</h2><section>");
        parameters(case, &found.after, &mut out);
        out.push_str("</section>\n");
    }
    for (depth, ranking) in found.rankings.iter().enumerate() {
        out.push_str(&format!("<h2>Ranking {}</h2><section>", depth + 1));
        out.push_str("<p>How much of the sum of squares each effect promises to explain, before any is fitted.</p>");
        let cost = if depth == 0 { found.before.train.total() } else { found.after.train.total() };
        rank(case, ranking, cost, &mut out);
        out.push_str("</section>\n");
    }
    if !found.rejected.is_empty() {
        out.push_str("<h2>Fitted and not kept</h2><section>");
        rejected(case, found, &mut out);
        out.push_str("</section>\n");
    }
    if let Some((name, text)) = amended {
        let at = text.find(&format!("model {name} ")).unwrap_or(0);
        out.push_str(&format!(
            "<h2>The amended model</h2><section><pre>{}</pre></section>\n",
            escaped(&text[at..])
        ));
    }
    out.push_str("</main></body></html>\n");
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
}

fn parameters(case: &Case<'_>, level: &Level, out: &mut String) {
    out.push_str("<table><tr><th>parameter</th><th>value</th><th>standard error</th></tr>");
    let all = level.plan.free.iter().zip(level.values.iter().zip(&level.errors));
    for (free, (value, error)) in all.skip(case.plan.free.len()) {
        out.push_str(&format!(
            "<tr><td>{}</td><td>{value:.5e}</td><td>{error:.1e}</td></tr>",
            escaped(&free.name)
        ));
    }
    out.push_str("</table>");
}

fn rank(case: &Case<'_>, ranking: &[Scored], cost: f64, out: &mut String) {
    out.push_str("<table><tr><th>effect</th><th>at</th><th>promises</th><th></th></tr>");
    for s in ranking.iter().take(SHOWN) {
        let share = 100.0 * s.gain / cost;
        out.push_str(&format!(
            "<tr><td>{}</td><td>{}</td><td>{share:.1} %</td><td style=\"width:220px\"><div class=\"bar\" style=\"width:{share:.1}%\"></div></td></tr>",
            escaped(&case.effects[s.effect].class),
            escaped(&s.place.at.join(", "))
        ));
    }
    out.push_str("</table>");
}

fn rejected(case: &Case<'_>, found: &Found, out: &mut String) {
    out.push_str("<table><tr><th>effect</th><th>at</th><th>BIC above the best</th><th>train</th><th>validation</th></tr>");
    for level in &found.rejected {
        let Some(c) = level.chosen.last() else { continue };
        out.push_str(&format!(
            "<tr><td>{}</td><td>{}</td><td>{:.1}</td><td>{:.4}</td><td>{:.4}</td></tr>",
            escaped(&case.effects[c.effect].class),
            escaped(&c.place.at.join(", ")),
            level.bic() - found.after.bic(),
            level.chi2_train(),
            level.chi2_validation()
        ));
    }
    out.push_str("</table>");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
