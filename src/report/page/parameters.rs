//! The table of parameters: values with units, descriptions, and places of declaration.

use crate::base::index::FastMap;
use crate::report::markup::escaped;
use crate::report::scale;

/// A parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct Parameter {
    /// Full dotted name.
    pub name: String,
    /// Its value in each run.
    pub values: Vec<Value>,
    /// SI unit.
    pub unit: String,
    /// Display unit; may be empty.
    pub display_unit: String,
    /// Its description.
    pub description: String,
    /// `file:line:column` of its declaration.
    pub place: String,
    /// Whether a setting from outside gave it its value, run by run.
    pub set: Vec<bool>,
}

/// A value of a parameter.
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// A number, SI.
    Number(f64),
    /// Anything else, as a Modelica expression.
    Text(String),
}

/// A value with its unit, for display.
pub fn shown(value: &Value, unit: &str, display_unit: &str) -> (String, String) {
    match value {
        Value::Text(text) => (text.clone(), String::new()),
        Value::Number(x) => {
            let scale = scale::choose(unit, display_unit, x.abs());
            (figures(scale.shown(*x)), scale.unit)
        }
    }
}

/// Six significant digits, without zeros at the end.
pub fn figures(x: f64) -> String {
    let size = x.abs();
    let trimmed = |text: String| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    };
    if x == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (5.0 - size.log10().floor()).max(0.0) as usize;
        trimmed(format!("{x:.decimals$}"))
    } else {
        let text = format!("{x:.5e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{power}", trimmed(digits.to_owned()))
    }
}

/// The tables: parameters of the model itself open, those of each component folded.
pub fn tables(parameters: &[Parameter], runs: &[String], link: &dyn Fn(&str) -> String) -> String {
    let mut groups: Vec<(&str, Vec<&Parameter>)> = Vec::new();
    let mut known: FastMap<&str, usize> = FastMap::default();
    for p in parameters {
        let holder = holder(&p.name);
        let k = *known.entry(holder).or_insert_with(|| {
            groups.push((holder, Vec::new()));
            groups.len() - 1
        });
        groups[k].1.push(p);
    }
    let mut out = String::from(
        "<p><label>Find <input type=\"search\" class=\"filter\" data-filter=\"parameters\" placeholder=\"name or text\"></label></p>\n<div id=\"parameters\">\n",
    );
    for (holder, list) in &groups {
        let changed = list.iter().any(|p| p.set.contains(&true));
        let open = if holder.is_empty() || changed { " open" } else { "" };
        let title = if holder.is_empty() { "the model itself" } else { holder };
        out.push_str(&format!(
            "<details class=\"group\"{open}><summary><code>{}</code> <span>{}</span></summary>\n",
            escaped(title),
            list.len()
        ));
        out.push_str(&table(list, runs, link));
        out.push_str("</details>\n");
    }
    out.push_str("</div>\n");
    out
}

fn table(list: &[&Parameter], runs: &[String], link: &dyn Fn(&str) -> String) -> String {
    let varied = runs.len() > 1;
    let class = if varied { "parameters" } else { "parameters stacked" };
    let mut out = format!("<table class=\"{class}\"><thead><tr><th>parameter</th>");
    if varied {
        runs.iter().for_each(|r| out.push_str(&format!("<th>{}</th>", escaped(r))));
    } else {
        out.push_str("<th>value</th>");
    }
    out.push_str("<th class=\"l\">unit</th><th class=\"l\">description</th><th class=\"l\">declared at</th></tr></thead>\n<tbody>");
    for p in list {
        let name = p.name.rsplit_once('.').map_or(p.name.as_str(), |(_, n)| n);
        out.push_str(&format!(
            "<tr data-find=\"{}\"><td><code>{}</code></td>",
            escaped(&format!("{} {}", p.name, p.description).to_lowercase()),
            escaped(name)
        ));
        let same = p.values.windows(2).all(|w| w[0] == w[1]);
        // One unit for all runs: that of the largest value.
        let largest = p.values.iter().fold(0.0_f64, |a, v| match v {
            Value::Number(x) => a.max(x.abs()),
            Value::Text(_) => a,
        });
        let scale = scale::choose(&p.unit, &p.display_unit, largest);
        let texts: Vec<(String, String)> = p
            .values
            .iter()
            .map(|v| match v {
                Value::Number(x) => (figures(scale.shown(*x)), format!("{x:?} {}", p.unit)),
                Value::Text(text) => (text.clone(), text.clone()),
            })
            .collect();
        let unit = match p.values.first() {
            Some(Value::Number(_)) => scale.unit.as_str(),
            _ => "",
        };
        let cell = |k: usize, span: usize| {
            let set = p.set.get(k).copied().unwrap_or(false);
            let class = if set { " class=\"set\"" } else { "" };
            let span = if span > 1 { format!(" colspan=\"{span}\"") } else { String::new() };
            let mark = if set { " <em>set</em>" } else { "" };
            format!(
                "<td{class}{span} title=\"{}\">{}{mark}</td>",
                escaped(texts[k].1.trim()),
                escaped(&texts[k].0)
            )
        };
        let marks = p.set.windows(2).all(|w| w[0] == w[1]);
        if varied && !(same && marks) {
            (0..texts.len()).for_each(|k| out.push_str(&cell(k, 1)));
        } else if !texts.is_empty() {
            out.push_str(&cell(0, if varied { runs.len() } else { 1 }));
        }
        out.push_str(&format!(
            "<td class=\"l\">{}</td><td class=\"l text\">{}</td><td class=\"l place\">{}</td></tr>\n",
            escaped(unit),
            escaped(p.description.trim()),
            link(&p.place)
        ));
    }
    out.push_str("</tbody></table>\n");
    out
}

/// The component that a variable belongs to.
pub fn holder(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(holder, _)| holder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_right() {
        let pairs = [
            (0.0, "0"),
            (1.0, "1"),
            (0.1, "0.1"),
            (1500.0, "1500"),
            (1.0 / 3.0, "0.333333"),
            (123456.789, "123457"),
            (1.2e-6, "1.2e-6"),
            (-2.5e9, "-2.5e9"),
            (0.00123, "0.00123"),
            (1e30, "1e30"),
        ];
        for (x, text) in pairs {
            assert_eq!(figures(x), text);
        }
        let p = shown(&Value::Number(6e5), "Pa", "");
        assert_eq!(p, ("6".to_owned(), "bar".to_owned()));
    }
}
