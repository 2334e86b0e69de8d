//! The skeleton of a page.

use crate::io::json::Json;
use crate::report::markup::{escaped, in_script};

const SKELETON: &str = include_str!("frame.html");
const STYLE: &str = include_str!("style.css");
const CHART: &str = include_str!("chart.js");
const START: &str = "mocc.figures();\n";

/// A page under construction.
pub struct Page {
    title: String,
    body: String,
    data: String,
    script: String,
}

impl Page {
    /// An empty page with charts.
    pub fn new(title: &str) -> Page {
        let (body, data) = (String::new(), String::new());
        Page { title: title.to_owned(), body, data, script: CHART.to_owned() }
    }

    /// Adds markup; strings of models must be escaped.
    pub fn add(&mut self, markup: &str) -> &mut Self {
        self.body.push_str(markup);
        self
    }

    /// Adds a section with a heading.
    pub fn section(&mut self, id: &str, heading: &str, markup: &str) -> &mut Self {
        let heading = escaped(heading);
        self.add(&format!(
            "<h2 id=\"{id}\">{heading}</h2>\n<section aria-labelledby=\"{id}\">\n{markup}</section>\n"
        ))
    }

    /// Adds a section that is folded at first.
    pub fn folded(&mut self, id: &str, heading: &str, markup: &str) -> &mut Self {
        let heading = escaped(heading);
        self.add(&format!(
            "<details id=\"{id}\"><summary>{heading}</summary>\n{markup}</details>\n"
        ))
    }

    /// Adds data that scripts find by `id`.
    pub fn data(&mut self, id: &str, data: &Json) -> &mut Self {
        self.data.push_str(&embedded(id, data));
        self
    }

    /// Adds a script, after those before.
    pub fn script(&mut self, text: &str) -> &mut Self {
        self.script.push_str(text);
        self
    }

    /// The page.
    pub fn finish(&self) -> String {
        // In one pass: inserted text may contain the names of other placeholders.
        let mut out = String::new();
        let mut rest = SKELETON;
        while let Some((before, after)) = rest.split_once('{') {
            out.push_str(before);
            let (name, after) = after.split_once('}').unwrap_or((after, ""));
            match name {
                "title" => out.push_str(&escaped(&self.title)),
                "style" => out.push_str(STYLE),
                "body" => out.push_str(&self.body),
                "data" => out.push_str(&self.data),
                "script" => {
                    out.push_str(&self.script);
                    out.push_str(START);
                }
                _ => {}
            }
            rest = after;
        }
        out.push_str(rest);
        out
    }
}

/// Data as an element that shows nothing.
pub fn embedded(id: &str, data: &Json) -> String {
    let text = in_script(&data.compact());
    format!("<script type=\"application/json\" id=\"{id}\">{text}</script>\n")
}

/// A table of names and values.
pub fn facts(facts: &[(String, String)]) -> String {
    let fact = |(what, value): &(String, String)| {
        format!(
            "<div class=\"fact\"><b>{}</b><span>{}</span></div>\n",
            escaped(value),
            escaped(what)
        )
    };
    format!("<div class=\"facts\">\n{}</div>\n", facts.iter().map(fact).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserted_text_cannot_change_the_skeleton() {
        let mut page = Page::new("a {script} </title>");
        page.add("<p>{title}</p>").data("x", &Json::text("</script><script>alert(1)"));
        let text = page.finish();
        assert!(text.contains("<title>a {script} &lt;/title&gt;</title>"));
        assert!(text.contains("<p>{title}</p>"));
        assert!(text.contains("\"\\u003c/script\\u003e\\u003cscript\\u003ealert(1)\""));
        assert_eq!(text.matches("</script>").count(), 2);
        for elsewhere in ["src=", "<link", "@import", "fetch(", "url(h"] {
            assert!(!text.contains(elsewhere), "`{elsewhere}`: nothing is loaded");
        }
    }
}
