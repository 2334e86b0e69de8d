//! An optimized design as one self-contained HTML page: goal, limits and parameters before and after, and the traces.

use super::result::{Optimum, State, unit, value};
use crate::calibrate::table::shown;
use crate::ir::trajectory::{Column, Trajectory};
use crate::report::markup::escaped;
use crate::report::page::figure::{Curve, Panel, Stroke, figure};
use crate::report::page::frame::{Page, facts};
use crate::report::plot::choice::interesting;

/// The page.
pub fn html(found: &Optimum, seconds: f64) -> String {
    let mut page = Page::new(&format!("{} optimized", found.model));
    page.add(&format!("<h1>{} optimized</h1>\n", escaped(&found.model)));
    page.add(&format!("<p class=\"sub\">{}</p>\n", escaped(&found.plan)));
    for note in notes(found) {
        page.add(&format!("<p class=\"note\">{note}</p>\n"));
    }
    let own = unit(&found.goal_unit);
    let with_unit = |x: Option<f64>| format!("{} {own}", value(x)).trim_end().to_owned();
    page.add(&facts(&[
        (format!("{} before", found.goal), with_unit(found.before)),
        (format!("{} after", found.goal), with_unit(found.after)),
        ("runs".to_owned(), found.runs.to_string()),
        ("elapsed time".to_owned(), format!("{seconds:.1} s")),
    ]));
    page.section("goal", "Goal and limits", &measures(found));
    page.section("parameters", "Parameters", &parameters(found));
    let panels = panels(found);
    if !panels.is_empty() {
        page.section("traces", "Before and after", &figure("before-after", &panels));
    }
    page.section("searches", "Searches", &searches(found));
    page.finish()
}

/// Sentences about a result that is not what was asked for.
pub fn notes(found: &Optimum) -> Vec<&'static str> {
    let mut out = Vec::new();
    if !found.complete {
        out.push("The search was interrupted: this is the best design so far.");
    } else if !found.is_feasible {
        out.push("No design keeps all limits: this one violates them least.");
    } else if !found.converged {
        out.push("The search ended before it converged: this is the best design so far.");
    }
    out
}

fn measures(found: &Optimum) -> String {
    let mut out = String::from(
        "<table><tr><th>measure</th><th class=\"l\">is</th><th>before</th><th>after</th>\
         <th class=\"l\">unit</th><th class=\"l\">range</th><th class=\"l\"></th><th>goal per unit</th></tr>\n",
    );
    let mut row = |cells: [String; 8]| {
        let [name, is, before, after, unit, range, effect, price] = cells;
        out.push_str(&format!(
            "<tr><td>{name}</td><td class=\"l\"><code>{is}</code></td><td>{before}</td><td><b>{after}</b></td>\
             <td class=\"l\">{unit}</td><td class=\"l\">{range}</td><td class=\"l note\">{effect}</td><td>{price}</td></tr>\n"
        ));
    };
    row([
        escaped(&found.goal),
        escaped(&found.goal_text),
        value(found.before),
        value(found.after),
        escaped(unit(&found.goal_unit)),
        (if found.maximize { "greatest" } else { "least" }).to_owned(),
        String::new(),
        String::new(),
    ]);
    for l in &found.limits {
        row([
            escaped(&l.name),
            escaped(&l.text),
            value(l.before),
            value(l.after),
            escaped(unit(&l.unit)),
            escaped(&l.range()),
            l.effect().to_owned(),
            l.price.map_or(String::new(), |p| shown(p, 0.0)),
        ]);
    }
    out.push_str("</table>");
    out
}

fn parameters(found: &Optimum) -> String {
    let mut out = String::from(
        "<table><tr><th>parameter</th><th>before</th><th>after</th><th class=\"l\">unit</th>\
         <th>least</th><th>greatest</th><th class=\"l\"></th></tr>\n",
    );
    for p in &found.parameters {
        out.push_str(&format!(
            "<tr><td><code>{}</code></td><td>{}</td><td><b>{}</b></td><td class=\"l\">{}</td><td>{}</td>\
             <td>{}</td><td class=\"l note\">{}</td></tr>\n",
            escaped(&p.name),
            shown(p.start, 0.0),
            shown(p.value, 0.0),
            escaped(unit(&p.unit)),
            shown(p.low, 0.0),
            shown(p.high, 0.0),
            p.end()
        ));
    }
    out.push_str("</table>");
    out
}

fn searches(found: &Optimum) -> String {
    let mut out = String::from("<table><tr><th>search</th>");
    for p in &found.parameters {
        out.push_str(&format!("<th><code>{}</code></th>", escaped(&p.name)));
    }
    out.push_str(&format!(
        "<th>{}</th><th>steps</th><th class=\"l\"></th></tr>\n",
        escaped(&found.goal)
    ));
    for (k, s) in found.searches.iter().enumerate() {
        let values = if matches!(s.state, State::Failed(_)) { &s.start } else { &s.values };
        let cells: String = values.iter().map(|v| format!("<td>{}</td>", shown(*v, 0.0))).collect();
        out.push_str(&format!(
            "<tr><td>{}</td>{cells}<td>{}</td><td>{}</td><td class=\"l note\">{}</td></tr>\n",
            k + 1,
            value(s.goal),
            s.steps,
            escaped(s.state.text())
        ));
    }
    out.push_str("</table>");
    out
}

/// A panel for each variable, with its trace before and after.
fn panels(found: &Optimum) -> Vec<Panel> {
    let names = match found.show.as_slice() {
        [] => interesting(&found.trace_after),
        show => show.to_vec(),
    };
    let curve = |trace: &Trajectory, name: &str, label: &str, colour: usize| {
        let y = trace.values(name)?;
        let (x, y) = (trace.time.clone(), y.to_vec());
        Some(Curve { name: label.to_owned(), x, y, stroke: Stroke::Line, colour })
    };
    let panel = |name: &String| {
        let column: &Column = found.trace_after.columns.iter().find(|c| c.name == *name)?;
        let before = found.trace_before.as_ref().and_then(|t| curve(t, name, "before", 1));
        let after = curve(&found.trace_after, name, "after", 0);
        Some(Panel {
            label: name.clone(),
            unit: column.unit.clone(),
            display_unit: column.display_unit.clone(),
            curves: before.into_iter().chain(after).collect(),
            height: None,
        })
    };
    names.iter().filter_map(panel).collect()
}
