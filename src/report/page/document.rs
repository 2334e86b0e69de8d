//! The report on a model and its runs.

use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::io::json::Json;
use crate::ir::assembly::Assembly;
use crate::ir::trajectory::{ColumnStorage, Kind, Trajectory};
use crate::report::markup::escaped;
use crate::report::scale;
use crate::report::schematic::{MAX_PARTS, draw, picture};

use super::columns::{Arrays, columns};
use super::figure::scale_of;
use super::frame::{Page, facts};
use super::parameters::{Parameter, Value, holder, shown, tables};
use super::spool::{Known, Spool, spool};
use super::view::View;

/// Parameters in the tooltip of a component.
const IN_TOOLTIP: usize = 12;
/// Largest number of diagrams in a page.
const MOST_LEVELS: usize = 120;

/// The content of a report.
pub struct Document<'a> {
    /// Full name of the model.
    pub model: String,
    /// Its description.
    pub description: String,
    /// Version of this program.
    pub version: &'a str,
    /// The command that made the page.
    pub command: String,
    /// The component tree of the model.
    pub assembly: &'a Assembly,
    /// Roles for the animation of moving parts.
    pub view: View,
    /// `file:line:column` of a place, empty where there is none.
    pub place: &'a dyn Fn(Span) -> String,
    /// Path and content of each source file, the model's own first.
    pub texts: Vec<(String, String)>,
    /// All parameters, in order of declaration.
    pub parameters: Vec<Parameter>,
    /// The runs, all with the same columns.
    pub runs: Vec<RunPart>,
    /// The recorded signals.
    pub measured: Vec<Measured>,
    /// Variables that are shown initially.
    pub show: Vec<String>,
    /// Remarks, such as that a run was interrupted.
    pub remarks: Vec<String>,
}

/// A run.
pub struct RunPart {
    /// Its label.
    pub label: String,
    /// Its results.
    pub trajectory: Trajectory,
    /// Aliases and constants among its columns.
    pub column_storage: Vec<ColumnStorage>,
    /// Statistics, as names and values.
    pub facts: Vec<(String, String)>,
}

/// A recorded signal.
pub struct Measured {
    /// Its label.
    pub label: String,
    /// The variable that it measures.
    pub variable: String,
    /// Instants, s.
    pub time: Vec<f64>,
    /// Values in the SI unit of the variable.
    pub values: Vec<f64>,
}

/// The page.
pub fn html(doc: &Document<'_>) -> String {
    let mut page = Page::new(&format!("{}: report", doc.model));
    page.add(&format!("<h1>{}</h1>\n", escaped(&doc.model)));
    if !doc.description.is_empty() {
        page.add(&format!("<p class=\"sub\">{}</p>\n", escaped(&doc.description)));
    }
    for remark in &doc.remarks {
        page.add(&format!("<p class=\"note\">{}</p>\n", escaped(remark)));
    }
    let variables: FastMap<&str, usize> = match doc.runs.first() {
        Some(run) => {
            let names = run.trajectory.columns.iter().enumerate();
            names.map(|(k, c)| (c.name.as_str(), k)).collect()
        }
        None => FastMap::default(),
    };
    let found = found_spool(doc, &variables);
    page.add("<nav>");
    let mut parts = vec![("diagram", "Diagram"), ("traces", "Traces")];
    if found.is_some() {
        parts.insert(1, ("spool", "Moving parts"));
    }
    parts.extend([
        ("parameters-of", "Parameters"),
        ("events", "Events"),
        ("statistics", "Statistics"),
        ("model", "Model"),
    ]);
    for (id, name) in parts {
        page.add(&format!("<a href=\"#{id}\">{name}</a> "));
    }
    page.add("</nav>\n");
    page.section("diagram", "Diagram", &diagrams(doc));
    if let Some(spool) = &found {
        let text = "<div id=\"spool-figure\" class=\"spool\"></div>\n";
        page.section("spool", "Moving parts", text);
        page.data("mocc-spool", &spool.json());
    }
    page.section("traces", "Traces", "<div id=\"explorer\" class=\"explorer\"></div>\n");
    let labels: Vec<String> = doc.runs.iter().map(|r| r.label.clone()).collect();
    let link = |place: &str| linked(place, &doc.texts);
    page.section("parameters-of", "Parameters", &tables(&doc.parameters, &labels, &link));
    page.section("events", "Events", &events(doc, &link));
    page.section("statistics", "Statistics", &statistics(doc));
    page.section("model", "Model", &texts(doc));
    page.data("mocc-data", &data(doc));
    for script in [include_str!("plane.js"), include_str!("save.js"), include_str!("explorer.js")] {
        page.script(script);
    }
    page.script(include_str!("spool.js"));
    page.script("mocc.report();\n");
    page.finish()
}

fn found_spool(doc: &Document<'_>, variables: &FastMap<&str, usize>) -> Option<Spool> {
    let first = |p: &Parameter| p.values.first().cloned();
    let mut numbers: FastMap<&str, f64> = FastMap::default();
    let mut literals: FastMap<&str, String> = FastMap::default();
    for p in &doc.parameters {
        match first(p) {
            Some(Value::Number(x)) => _ = numbers.insert(p.name.as_str(), x),
            Some(Value::Text(text)) => {
                let last = text.rsplit('.').next().unwrap_or(&text).to_owned();
                literals.insert(p.name.as_str(), last);
            }
            None => {}
        }
    }
    let range = |k: usize| {
        let all = doc.runs.iter().flat_map(|r| r.trajectory.data[k].iter());
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)))
    };
    let known =
        Known { view: &doc.view, variables, numbers: &numbers, literals: &literals, range: &range };
    spool(doc.assembly, &known)
}

/// The diagram of the model and of everything in it that holds connected components.
fn diagrams(doc: &Document<'_>) -> String {
    let assembly = doc.assembly;
    let mut by_part: FastMap<&str, Vec<&Parameter>> = FastMap::default();
    for p in &doc.parameters {
        by_part.entry(holder(&p.name)).or_default().push(p);
    }
    let note = |part: usize| {
        let name = assembly.parts[part].name.as_str();
        let own = by_part.get(name).map_or(&[][..], Vec::as_slice);
        let told = |p: &&Parameter| {
            let short = p.name.rsplit('.').next().unwrap_or(&p.name);
            let (value, unit) =
                p.values.first().map(|v| shown(v, &p.unit, &p.display_unit)).unwrap_or_default();
            format!("{short} = {value} {unit}").trim_end().to_owned()
        };
        let mut lines: Vec<String> = own.iter().take(IN_TOOLTIP).map(told).collect();
        if own.len() > IN_TOOLTIP {
            lines.push(format!("and {} more", own.len() - IN_TOOLTIP));
        }
        lines
    };
    let place = |link: usize| (doc.place)(assembly.links[link].place);
    let mut out = String::new();
    let mut drawn = 0;
    let holders = assembly.holders();
    for level in (0..assembly.parts.len()).filter(|l| holders[*l]) {
        if drawn >= MOST_LEVELS {
            break;
        }
        let Some(picture) = picture(assembly, level) else { continue };
        let part = &assembly.parts[level];
        let hidden = if level == 0 { "" } else { " hidden" };
        let title =
            if level == 0 { doc.model.clone() } else { format!("{}: {}", part.name, part.class) };
        out.push_str(&format!(
            "<figure class=\"level\" data-level=\"{}\"{hidden}>\n<figcaption>{}</figcaption>\n<div class=\"wide\">{}</div></figure>\n",
            escaped(&part.name),
            escaped(&title),
            draw::svg(&picture, assembly, &note, &place)
        ));
        drawn += 1;
    }
    if drawn == 0 || picture(assembly, 0).is_none() {
        let count = assembly.children(0).len();
        out.push_str(&match count {
            0 => "<p>The model has no components: it consists of equations only.</p>\n".to_owned(),
            n => format!("<p>The model has {n} components; up to {MAX_PARTS} are drawn.</p>\n"),
        });
    } else {
        out.insert_str(0, "<p class=\"hint\">Point at a box or a line to identify it. A box with a double frame can be opened.</p>\n<p id=\"crumbs\" class=\"crumbs\" hidden></p>\n");
    }
    out
}

fn events(doc: &Document<'_>, link: &dyn Fn(&str) -> String) -> String {
    let mut out = String::new();
    for (k, run) in doc.runs.iter().enumerate() {
        let list = &run.trajectory.events;
        let open = if k == 0 { " open" } else { "" };
        out.push_str(&format!(
            "<details class=\"group\"{open}><summary>{} <span>{} events</span></summary>\n",
            escaped(&run.label),
            list.len()
        ));
        if !list.is_empty() {
            out.push_str("<table class=\"events\"><thead><tr><th>time, s</th><th class=\"l\">event</th><th class=\"l\">written at</th></tr></thead>\n<tbody>");
            for e in list {
                out.push_str(&format!(
                    "<tr data-time=\"{:?}\" tabindex=\"0\"><td>{:.9}</td><td class=\"l\"><code>{}</code></td><td class=\"l place\">{}</td></tr>\n",
                    e.time,
                    e.time,
                    escaped(&e.what),
                    link(&e.place)
                ));
            }
            out.push_str("</tbody></table>\n");
        }
        out.push_str("</details>\n");
    }
    out
}

fn statistics(doc: &Document<'_>) -> String {
    let mut out = String::new();
    if let [only] = doc.runs.as_slice() {
        out.push_str(&facts(&only.facts));
    } else if let Some(first) = doc.runs.first() {
        out.push_str("<table><thead><tr><th>run</th>");
        first.facts.iter().for_each(|(n, _)| out.push_str(&format!("<th>{}</th>", escaped(n))));
        out.push_str("</tr></thead>\n<tbody>");
        for run in &doc.runs {
            out.push_str(&format!("<tr><td>{}</td>", escaped(&run.label)));
            run.facts.iter().for_each(|(_, v)| out.push_str(&format!("<td>{}</td>", escaped(v))));
            out.push_str("</tr>\n");
        }
        out.push_str("</tbody></table>\n");
    }
    out.push_str(&format!(
        "<p>Made by mocc {} with</p>\n<pre class=\"command\">{}</pre>\n",
        escaped(doc.version),
        escaped(&doc.command)
    ));
    out
}

fn texts(doc: &Document<'_>) -> String {
    let mut out = String::new();
    for (k, (path, text)) in doc.texts.iter().enumerate() {
        let open = if k == 0 { " open" } else { "" };
        out.push_str(&format!(
            "<details class=\"group\"{open}><summary><code>{}</code></summary>\n<pre class=\"source\">",
            escaped(path)
        ));
        for (line, words) in text.lines().enumerate() {
            let line = line + 1;
            out.push_str(&format!("<span id=\"t{k}-{line}\">{}</span>\n", escaped(words)));
        }
        out.push_str("</pre></details>\n");
    }
    out
}

/// A place as a link to the source in the page.
fn linked(place: &str, texts: &[(String, String)]) -> String {
    let mut parts = place.rsplitn(3, ':');
    let (_, line, path) = (parts.next(), parts.next(), parts.next());
    let known = path.and_then(|p| texts.iter().position(|(t, _)| t == p));
    match (known, path, line) {
        (Some(k), Some(path), Some(line)) => {
            let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
            format!(
                "<a href=\"#t{k}-{line}\" title=\"{}\">{}:{line}</a>",
                escaped(place),
                escaped(file)
            )
        }
        _ => escaped(place),
    }
}

/// Variables, runs and recordings, for the scripts.
fn data(doc: &Document<'_>) -> Json {
    let mut arrays = Arrays::default();
    let runs: Vec<Json> = doc
        .runs
        .iter()
        .map(|r| {
            let events = r.trajectory.events.iter().map(|e| e.time).collect::<Vec<f64>>();
            let time = &r.trajectory.time;
            let ends = [time.first().copied().unwrap_or(0.0), time.last().copied().unwrap_or(0.0)];
            Json::object([
                ("label", Json::text(r.label.as_str())),
                ("ends", Json::numbers(&ends)),
                ("columns", columns(&r.trajectory, &r.column_storage, &mut arrays)),
                ("events", Json::numbers(&events)),
            ])
        })
        .collect();
    let measured: Vec<Json> = doc
        .measured
        .iter()
        .map(|m| {
            Json::object([
                ("label", Json::text(m.label.as_str())),
                ("variable", Json::text(m.variable.as_str())),
                ("time", Json::count(arrays.doubles(&m.time))),
                ("values", Json::count(arrays.singles(&m.values))),
            ])
        })
        .collect();
    let names = doc.runs.first().map_or(&[][..], |r| r.trajectory.columns.as_slice());
    let variables: Vec<Json> = names
        .iter()
        .enumerate()
        .map(|(k, c)| {
            let all = doc.runs.iter().flat_map(|r| r.trajectory.data[k].iter());
            let largest = all.fold(0.0_f64, |a, x| a.max(x.abs()));
            let scale = scale::choose(&c.unit, &c.display_unit, largest);
            Json::object([
                ("name", Json::text(c.name.as_str())),
                ("unit", Json::text(c.unit.as_str())),
                ("quantity", Json::text(scale::quantity(&c.unit))),
                ("text", Json::text(c.description.trim())),
                ("low", Json::flag(c.kind == Kind::Boolean)),
                ("whole", Json::flag(matches!(c.kind, Kind::Boolean | Kind::Integer))),
                ("largest", Json::number(largest)),
                ("scale", scale_of(&scale)),
            ])
        })
        .collect();
    let longest = doc.runs.iter().filter_map(|r| r.trajectory.time.last());
    let longest = longest.fold(0.0_f64, |a, t| a.max(t.abs()));
    Json::object([
        ("time", scale_of(&scale::choose("s", "", longest))),
        ("variables", Json::list(variables)),
        ("runs", Json::list(runs)),
        ("measured", Json::list(measured)),
        ("show", Json::list(doc.show.iter().map(Json::text))),
        ("arrays", arrays.json()),
    ])
}
