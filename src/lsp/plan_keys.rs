//! Completion of the keys of plans, tests and settings of projects, which are TOML files.
//!
//! The table that a key belongs to is found by its heading above the place, or by the inline table around it.

use crate::io::json::Json;

/// The keys of a table, with what they are.
type Keys = &'static [(&'static str, &'static str)];

const PLAN: &[(&str, Keys)] = &[
    (
        "",
        &[
            ("model", "file of the model"),
            ("name", "full name of the model, if it is not the last of its file"),
            ("libraries", "folders of libraries"),
            ("window", "length of runs, s"),
            ("skip", "time at the start of each run that is not compared, s"),
            ("every", "only every n-th row is compared"),
            ("recordings", "list of recordings"),
            ("starts", "number of searches of mocc optimize; values at the start of runs"),
            ("stop", "end of the run, s"),
            ("tolerance", "relative tolerance"),
            ("show", "variables on the page"),
        ],
    ),
    ("fixed", &[]),
    (
        "data",
        &[
            ("folder", "folder of the recordings"),
            ("table", "table of the recordings"),
            ("file", "its column with the files"),
            ("recording", "its column with the names"),
            ("split", "its column with train, validation or test"),
        ],
    ),
    (
        "recordings",
        &[
            ("file", "the recording"),
            ("name", "its name"),
            ("split", "train, validation or test"),
            ("from", "begin of the part that is used, s"),
            ("to", "end of the part that is used, s"),
            ("window", "length of runs, s"),
            ("skip", "time at the start that is not compared, s"),
        ],
    ),
    (
        "conditions",
        &[("parameter", "the parameter that the column sets"), ("unit", "unit of the column")],
    ),
    (
        "inputs",
        &[
            ("input", "the input that the column drives"),
            ("unit", "unit of the column"),
            ("interpolation", "how values between rows are found"),
            ("smooth", "half-width of smoothing, s"),
            ("every", "only every n-th row is used"),
            ("absent", "value where the column is empty"),
        ],
    ),
    ("time", &[("column", "the column"), ("unit", "its unit")]),
    (
        "signals",
        &[
            ("variable", "the variable that the column measures"),
            ("unit", "unit of the column"),
            ("sigma", "standard deviation of the noise, in that unit"),
            ("smooth", "half-width of smoothing, s"),
        ],
    ),
    (
        "free",
        &[
            ("start", "start of the search"),
            ("min", "least value"),
            ("max", "greatest value"),
            ("tied", "parameters that take the value"),
        ],
    ),
    (
        "goal",
        &[
            ("minimize", "a measure, NAME = EXPRESSION"),
            ("maximize", "a measure, NAME = EXPRESSION"),
        ],
    ),
    (
        "limits",
        &[("is", "expression of a measure"), ("min", "least value"), ("max", "greatest value")],
    ),
];

const TESTS: &[(&str, Keys)] = &[
    (
        "",
        &[
            ("model", "file of the model"),
            ("name", "full name of the model"),
            ("libraries", "folders of libraries"),
        ],
    ),
    (
        "tolerances",
        &[
            ("relative", "relative to the extent of each variable"),
            ("absolute", "in the unit of the variables"),
            ("time", "by which changes may move, s"),
        ],
    ),
    (
        "test",
        &[
            ("name", "name of the test"),
            ("set", "overridden parameters"),
            ("vary", "parameters with several values"),
            ("stop", "end of the run, s"),
            ("interval", "time between rows, s"),
            ("tolerance", "relative tolerance"),
            ("diagnostics", "codes that are expected"),
            ("flat", "snapshot of the flat model"),
            ("blocks", "snapshot of the blocks"),
            ("events", "snapshot of the events"),
            ("traces", "snapshot of variables over time"),
            ("measures", "measures within bounds"),
        ],
    ),
    (
        "measures",
        &[
            ("is", "expression of a measure"),
            ("min", "least value"),
            ("max", "greatest value"),
            ("never", "the condition must not become true"),
        ],
    ),
];

const PROJECT: &[(&str, Keys)] = &[(
    "",
    &[
        ("libraries", "folders of libraries"),
        ("allow_read", "folders whose data files models may read"),
        ("method", "integration method of runs"),
        ("tolerance", "relative tolerance of runs"),
    ],
)];

/// The keys that may be written at a place.
pub fn completion(name: &str, text: &str, offset: usize) -> Json {
    let tables = match name {
        _ if name.ends_with(".test.toml") => TESTS,
        _ if name.ends_with("mocc.toml") => PROJECT,
        _ => PLAN,
    };
    let before = &text[..offset.min(text.len())];
    let line = before.rsplit('\n').next().unwrap_or_default();
    // A value is no key.
    let is_value = |part: &str| part.contains('=') && !part.trim_end().ends_with(',');
    let inside = line.rfind('{').filter(|at| !line[*at..].contains('}'));
    let heading = before.lines().rev().find_map(|l| {
        let name = l.trim().strip_prefix('[')?.trim_start_matches('[');
        Some(name.split(']').next().unwrap_or_default().trim().to_owned())
    });
    let part = inside.map_or(line, |at| &line[at + 1..]);
    let last = part.rsplit(',').next().unwrap_or_default();
    if is_value(last) {
        return Json::list([]);
    }
    // Tables whose entries have names of the user's, with keys in an inline table.
    let key = inside.map(|at| line[..at].split('=').next().unwrap_or_default().trim());
    let heading = heading.unwrap_or_default();
    let table = match key {
        Some(key) if tables.iter().any(|(name, _)| *name == key) => key,
        _ => heading.as_str(),
    };
    let named = ["conditions", "inputs", "signals", "free", "limits", "measures", "fixed"];
    if inside.is_none() && named.contains(&table) {
        return Json::list([]);
    }
    let keys = tables.iter().find(|(name, _)| *name == table).map_or(&[][..], |(_, keys)| keys);
    let mut out: Vec<Json> = keys.iter().map(|(key, what)| item(key, what, 10)).collect();
    if line.trim_start().starts_with('[') {
        let all = tables.iter().filter(|(name, _)| !name.is_empty());
        out = all.map(|(name, _)| item(name, "table", 9)).collect();
    }
    Json::list(out)
}

fn item(key: &str, what: &str, kind: usize) -> Json {
    Json::object([
        ("label", Json::text(key)),
        ("kind", Json::count(kind)),
        ("detail", Json::text(what)),
    ])
}

#[cfg(test)]
mod tests {
    use super::completion;
    use crate::io::json::Json;

    fn keys(name: &str, text: &str) -> Vec<String> {
        let all = Json::object([("all", completion(name, text, text.len()))]);
        all.items_at(&["all"])
            .iter()
            .filter_map(|i| i.text_at(&["label"]).map(str::to_owned))
            .collect()
    }

    #[test]
    fn keys_are_those_of_the_table() {
        assert!(keys("plan.toml", "mo").contains(&"model".to_owned()));
        assert_eq!(keys("plan.toml", "[goal]\n"), ["minimize", "maximize"]);
        assert_eq!(keys("plan.toml", "[free]\nm = { min = 1, "), ["start", "min", "max", "tied"]);
        assert_eq!(keys("plan.toml", "[free]\nm = { min = "), [""; 0]);
        assert_eq!(keys("plan.toml", "[free]\n"), [""; 0]);
        assert_eq!(keys("a.test.toml", "[[test]]\nmeasures = {"), ["is", "min", "max", "never"]);
        assert_eq!(keys("mocc.toml", ""), ["libraries", "allow_read", "method", "tolerance"]);
        assert!(keys("plan.toml", "[").contains(&"signals".to_owned()));
    }
}
