//! Pages that open from disk: an index of packages, and a page for each class.

use super::classes::Classes;
use super::content::{Content, Named, Row, content};
use super::mathml::Typesetter;
use super::pictures::Pictures;
use crate::driver::catalogue::kind;
use crate::ir::ast::{ClassBody, Composition, EquationKind};
use crate::report::markup::escaped;
use crate::report::page::frame::Page;

/// Names and texts of all pages.
pub fn pages(classes: &Classes, pictures: &Pictures<'_>) -> Vec<(String, String)> {
    let mut out = vec![("index.html".to_owned(), index(classes))];
    out.extend(
        (0..classes.count).map(|k| (file(&classes.all[k].name), page(classes, k, pictures))),
    );
    out
}

/// The file of a class.
fn file(name: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || matches!(c, '.' | '_' | '-') { c } else { '_' };
    format!("{}.html", name.chars().map(safe).collect::<String>())
}

fn link(classes: &Classes, k: usize, text: &str) -> String {
    let class = &classes.all[k];
    let title = escaped(class.class.description.as_deref().unwrap_or_default());
    if k < classes.count {
        format!(
            "<a href=\"{}\" title=\"{title}\"><code>{}</code></a>",
            file(&class.name),
            escaped(text)
        )
    } else {
        format!("<code title=\"{title}\">{}</code>", escaped(text))
    }
}

fn index(classes: &Classes) -> String {
    let roots: Vec<&str> = classes.all[..classes.count]
        .iter()
        .map(|p| p.name.as_str())
        .filter(|name| classes.outer(name).is_none())
        .collect();
    let title =
        if let [only] = roots.as_slice() { (*only).to_owned() } else { "Libraries".to_owned() };
    let mut page = Page::new(&title);
    page.add(&format!("<h1>{}</h1>\n<section>\n", escaped(&title)));
    page.add(&rows(classes, 0..classes.count));
    page.add("</section>\n");
    page.finish()
}

/// A table of classes, indented by their packages.
fn rows(classes: &Classes, which: impl Iterator<Item = usize>) -> String {
    let mut out = String::from("<table class=\"stacked\">\n");
    for k in which {
        let parsed = &classes.all[k];
        let depth = parsed.name.matches('.').count();
        let short = parsed.name.rsplit('.').next().unwrap_or(&parsed.name);
        out.push_str(&format!(
            "<tr><td style=\"padding-left:{}em\">{}</td><td class=\"l\">{}</td><td class=\"l text\">{}</td></tr>\n",
            0.6 + 1.2 * depth as f64,
            link(classes, k, short),
            kind(&parsed.class),
            escaped(parsed.class.description.as_deref().unwrap_or_default())
        ));
    }
    out.push_str("</table>\n");
    out
}

fn page(classes: &Classes, k: usize, pictures: &Pictures<'_>) -> String {
    let parsed = &classes.all[k];
    let content = content(classes, k);
    let mut page = Page::new(&parsed.name);
    head(&mut page, classes, k, &content);
    if let Some(path) = pictures.own(&parsed.name) {
        let alternative = escaped(&content.description);
        page.add(&format!("<p><img src=\"{}\" alt=\"{alternative}\"></p>\n", escaped(&path)));
    }
    let diagram = pictures.diagram(&parsed.name);
    if !diagram.is_empty() {
        page.section("diagram", "Diagram", &format!("<div class=\"wide\">{diagram}</div>\n"));
    }
    let is_short = matches!(parsed.class.body, ClassBody::Short(_));
    let (id, heading) = if is_short { ("is", "Is") } else { ("extends", "Extends") };
    let bases: String =
        content.bases.iter().map(|b| format!("<p>{}</p>\n", named(classes, b))).collect();
    add(&mut page, id, heading, bases);
    add(&mut page, "parameters", "Parameters", table(classes, &content.parameters));
    add(&mut page, "components", "Variables and components", table(classes, &content.components));
    if let ClassBody::Long(composition) = &parsed.class.body {
        add(&mut page, "equations", "Equations", equations(composition, &parsed.file));
    }
    add(&mut page, "literals", "Literals", literals(&content));
    if let Some((explains, attached)) = &content.effect {
        let explains = escaped(&explains.replace("%at", "…"));
        let attached = escaped(attached);
        let text = format!("<p>{explains}</p>\n<p class=\"hint\"><code>{attached}</code></p>\n");
        page.section("diagnosis", "Diagnosis", &text);
    }
    foot(&mut page, classes, k);
    page.finish()
}

/// A section, if there is anything in it.
fn add(page: &mut Page, id: &str, heading: &str, text: String) {
    if !text.is_empty() {
        page.section(id, heading, &text);
    }
}

/// The way to the page, its heading and description.
fn head(page: &mut Page, classes: &Classes, k: usize, content: &Content) {
    let name = &classes.all[k].name;
    page.add("<nav><a href=\"index.html\">index</a>");
    let parts: Vec<&str> = name.split('.').collect();
    for n in 1..parts.len() {
        let outer = parts[..n].join(".");
        if classes.outer(&format!("{outer}.x")).is_none() {
            continue;
        }
        page.add(&format!(" <a href=\"{}\">{}</a>", file(&outer), escaped(parts[n - 1])));
    }
    page.add(&format!("</nav>\n<h1>{}</h1>\n", escaped(name)));
    page.add(&format!("<p class=\"sub\">{}</p>\n", content.kind));
    if !content.description.is_empty() {
        page.add(&format!("<p>{}</p>\n", escaped(&content.description)));
    }
    if !content.comment.is_empty() {
        page.add(&format!(
            "<pre class=\"comment\">{}\n</pre>\n",
            escaped(&content.comment.join("\n"))
        ));
    }
}

/// The classes in it, those that use it, and its source.
fn foot(page: &mut Page, classes: &Classes, k: usize) {
    let parsed = &classes.all[k];
    let prefix = format!("{}.", parsed.name);
    let inner: Vec<usize> =
        (0..classes.count).filter(|i| classes.all[*i].name.starts_with(&prefix)).collect();
    if !inner.is_empty() {
        page.section("classes", "Classes", &rows(classes, inner.into_iter()));
    }
    let users = classes.used_by(k);
    if !users.is_empty() {
        let all: Vec<String> =
            users.iter().map(|u| link(classes, *u, &classes.all[*u].name)).collect();
        page.section("used", "Used by", &format!("<p>{}</p>\n", all.join(", ")));
    }
    let (start, end) = (parsed.class.span.start as usize, parsed.class.span.end as usize);
    let source = parsed.file.get(start..end).unwrap_or_default();
    let place = escaped(&parsed.path.display().to_string());
    let source = format!("<p class=\"hint\">{place}</p>\n<pre>{};</pre>\n", escaped(source));
    page.folded("source", "Source", &source);
}

fn equations(composition: &Composition, file: &str) -> String {
    let typesetter = Typesetter { text: file };
    let (mut out, mut initial) = (String::new(), String::new());
    for section in &composition.equations {
        let out = if section.initial { &mut initial } else { &mut out };
        section.equations.iter().for_each(|e| typesetter.equation(e, out, 0));
    }
    if !initial.is_empty() {
        out.push_str(&format!("<p class=\"hint\">initially</p>\n{initial}"));
    }
    let connections = composition.equations.iter().flat_map(|s| s.equations.iter());
    let count = connections.filter(|e| matches!(e.kind, EquationKind::Connect(..))).count();
    if count > 0 {
        out.push_str(&format!("<p class=\"hint\">and {count} connections</p>\n"));
    }
    out
}

fn literals(content: &Content) -> String {
    if content.literals.is_empty() {
        return String::new();
    }
    let row = |(name, description): &(String, String)| {
        format!(
            "<tr><td><code>{}</code></td><td class=\"l text\">{}</td></tr>\n",
            escaped(name),
            escaped(description)
        )
    };
    format!(
        "<table class=\"stacked\">{}</table>\n",
        content.literals.iter().map(row).collect::<String>()
    )
}

/// A name that is written in a class, as a link.
fn named(classes: &Classes, named: &Named) -> String {
    match named.class {
        Some(found) => link(classes, found, &named.text),
        None => format!("<code>{}</code>", escaped(&named.text)),
    }
}

/// A table of components; empty if there are none.
fn table(classes: &Classes, rows: &[Row]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let row = |row: &Row| {
        let base = row.from.map(|from| {
            let name = &classes.all[from].name;
            let short = name.rsplit('.').next().unwrap_or(name);
            format!(" <span class=\"hint\">of {}</span>", link(classes, from, short))
        });
        let prefix = if row.prefix.is_empty() { "" } else { " " };
        format!(
            "<tr><td><code>{}</code></td><td class=\"l\">{}{prefix}{}</td><td class=\"l\"><code>{}</code></td><td class=\"l\">{}</td>\
             <td class=\"l text\">{}{}</td></tr>\n",
            escaped(&row.name),
            row.prefix,
            named(classes, &row.of),
            escaped(&row.value),
            escaped(&row.unit),
            escaped(&row.description),
            base.unwrap_or_default()
        )
    };
    format!(
        "<table class=\"stacked\"><tr><th>name</th><th class=\"l\">type</th><th class=\"l\">value</th><th class=\"l\">unit</th>\
         <th class=\"l\">description</th></tr>\n{}</table>\n",
        rows.iter().map(row).collect::<String>()
    )
}
