//! The pages: an index of packages, and a page for each class.

use super::classes::Classes;
use super::mathml::Typesetter;
use crate::driver::catalogue::kind;
use crate::ir::ast::{
    Class, ClassBody, Component, ComponentClause, ElementKind, EquationKind, Variability,
};
use crate::report::markup::escaped;
use crate::report::page::frame::Page;

/// Diagrams of models, by their full names; empty where there is none.
pub type Diagrams<'d> = dyn Fn(&str) -> String + 'd;

/// Names and texts of all pages.
pub fn pages(classes: &Classes, diagrams: &Diagrams<'_>) -> Vec<(String, String)> {
    let mut out = vec![("index.html".to_owned(), index(classes))];
    out.extend(
        (0..classes.count).map(|k| (file(&classes.all[k].name), page(classes, k, diagrams))),
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

fn description(class: &Class) -> &str {
    class.description.as_deref().unwrap_or_default()
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
    let mut out = String::from("<table>\n");
    for k in which {
        let parsed = &classes.all[k];
        let depth = parsed.name.matches('.').count();
        let short = parsed.name.rsplit('.').next().unwrap_or(&parsed.name);
        out.push_str(&format!(
            "<tr><td style=\"padding-left:{}em\">{}</td><td class=\"l\">{}</td><td class=\"l text\">{}</td></tr>\n",
            0.6 + 1.2 * depth as f64,
            link(classes, k, short),
            kind(&parsed.class),
            escaped(description(&parsed.class))
        ));
    }
    out.push_str("</table>\n");
    out
}

fn page(classes: &Classes, k: usize, diagrams: &Diagrams<'_>) -> String {
    let parsed = &classes.all[k];
    let class = &parsed.class;
    let mut page = Page::new(&parsed.name);
    page.add("<nav><a href=\"index.html\">index</a>");
    let parts: Vec<&str> = parsed.name.split('.').collect();
    for n in 1..parts.len() {
        let outer = parts[..n].join(".");
        if classes.outer(&format!("{outer}.x")).is_none() {
            continue;
        }
        page.add(&format!(" <a href=\"{}\">{}</a>", file(&outer), escaped(parts[n - 1])));
    }
    let partial = if class.partial { "partial " } else { "" };
    page.add(&format!("</nav>\n<h1>{}</h1>\n", escaped(&parsed.name)));
    page.add(&format!("<p class=\"sub\">{partial}{}</p>\n", kind(class)));
    if !description(class).is_empty() {
        page.add(&format!("<p>{}</p>\n", escaped(description(class))));
    }
    let comment = comment(&parsed.file, class);
    if !comment.is_empty() {
        page.add(&format!("<pre>{}</pre>\n", escaped(&comment)));
    }
    let diagram = diagrams(&parsed.name);
    if !diagram.is_empty() {
        page.section("diagram", "Diagram", &format!("<div class=\"wide\">{diagram}</div>\n"));
    }
    match &class.body {
        ClassBody::Long(composition) => {
            let bases: String = composition
                .elements
                .iter()
                .filter_map(|e| match &e.kind {
                    ElementKind::Extends(extends) => Some(named(classes, k, &extends.base)),
                    _ => None,
                })
                .map(|base| format!("<p>{base}</p>\n"))
                .collect();
            if !bases.is_empty() {
                page.section("extends", "Extends", &bases);
            }
            let parts = Parts { classes, k };
            for (id, heading, wanted) in [
                ("parameters", "Parameters", true),
                ("components", "Variables and components", false),
            ] {
                let table = parts.table(wanted);
                if !table.is_empty() {
                    page.section(id, heading, &table);
                }
            }
            let mut equations = String::new();
            let typesetter = Typesetter { text: &parsed.file };
            let (mut regular, mut initial) = (String::new(), String::new());
            for section in &composition.equations {
                let out = if section.initial { &mut initial } else { &mut regular };
                section.equations.iter().for_each(|e| typesetter.equation(e, out, 0));
            }
            equations.push_str(&regular);
            if !initial.is_empty() {
                equations.push_str(&format!("<p class=\"hint\">initially</p>\n{initial}"));
            }
            if !equations.is_empty() {
                page.section("equations", "Equations", &equations);
            }
            let connections = composition.equations.iter().flat_map(|s| s.equations.iter());
            let count = connections.filter(|e| matches!(e.kind, EquationKind::Connect(..))).count();
            if count > 0 {
                page.add(&format!("<p class=\"hint\">and {count} connections</p>\n"));
            }
        }
        ClassBody::Short(short) => {
            page.section("is", "Is", &format!("<p>{}</p>\n", named(classes, k, &short.base)));
        }
        ClassBody::Enumeration(Some(literals)) => {
            let row = |literal: &crate::ir::ast::EnumLiteral| {
                format!("<tr><td><code>{}</code></td></tr>\n", escaped(&literal.name.name))
            };
            let rows: String = literals.iter().map(row).collect();
            page.section("literals", "Literals", &format!("<table>{rows}</table>\n"));
        }
        _ => {}
    }
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
    let (start, end) = (class.span.start as usize, class.span.end as usize);
    let source = parsed.file.get(start..end).unwrap_or_default();
    let place = escaped(&parsed.path.display().to_string());
    let source = format!("<p class=\"hint\">{place}</p>\n<pre>{};</pre>\n", escaped(source));
    page.folded("source", "Source", &source);
    page.finish()
}

/// The comment lines at the head of a class.
fn comment(file: &str, class: &Class) -> String {
    let own = file.get(class.name.span.end as usize..class.span.end as usize).unwrap_or_default();
    let lines = own.lines().skip(1).map(str::trim);
    let taken = lines.take_while(|line| line.starts_with("//"));
    let text: Vec<&str> = taken.map(|line| line.trim_start_matches('/')).collect();
    let rules = |line: &&str| !line.contains("----");
    text.into_iter()
        .filter(rules)
        .map(|line| format!("{}\n", line.strip_prefix(' ').unwrap_or(line)))
        .collect()
}

/// A name that is written in a class, as a link.
fn named(classes: &Classes, k: usize, path: &crate::ir::ast::Path) -> String {
    let text = path.to_string();
    match classes.find(k, path) {
        Some(found) => link(classes, found, &text),
        None => format!("<code>{}</code>", escaped(&text)),
    }
}

/// The components of a class.
struct Parts<'c> {
    classes: &'c Classes,
    k: usize,
}

impl Parts<'_> {
    /// Parameters and constants, or all others; empty if there are none.
    fn table(&self, parameters: bool) -> String {
        let parsed = &self.classes.all[self.k];
        let ClassBody::Long(composition) = &parsed.class.body else { return String::new() };
        let mut rows = String::new();
        for element in composition.elements.iter().filter(|e| !e.protected) {
            let ElementKind::Components(clause) = &element.kind else { continue };
            let is_fixed = matches!(
                clause.prefix.variability,
                Some(Variability::Parameter | Variability::Constant)
            );
            if is_fixed == parameters {
                clause.components.iter().for_each(|c| rows.push_str(&self.row(clause, c)));
            }
        }
        if rows.is_empty() {
            return rows;
        }
        format!(
            "<table><tr><th>name</th><th class=\"l\">type</th><th class=\"l\">value</th><th class=\"l\">unit</th>\
             <th class=\"l\">description</th></tr>\n{rows}</table>\n"
        )
    }

    fn row(&self, clause: &ComponentClause, component: &Component) -> String {
        let parsed = &self.classes.all[self.k];
        let own = component.modification.as_deref();
        let value = own
            .and_then(|m| m.binding.as_deref())
            .and_then(|e| parsed.file.get(e.span.start as usize..e.span.end as usize));
        format!(
            "<tr><td><code>{}</code></td><td class=\"l\">{}</td><td class=\"l\"><code>{}</code></td><td class=\"l\">{}</td>\
             <td class=\"l text\">{}</td></tr>\n",
            escaped(&component.name.name),
            named(self.classes, self.k, &clause.type_name),
            escaped(value.unwrap_or_default()),
            escaped(&self.classes.unit(self.k, &clause.type_name, own)),
            escaped(component.description.as_deref().unwrap_or_default())
        )
    }
}
