//! The traces of a run, compared with those of a snapshot or of another program.

use super::test_file::Traces;
use crate::compare::tolerance::Tolerance;
use crate::compare::tube::{Curve, Deviation, deviation};
use crate::ir::trajectory::{Column, Kind, Trajectory, position};
use crate::report::chart::{Chart, Group, Series};

/// Panels of a picture at most.
const MAX_PANELS: usize = 8;

/// Columns of a run that a test compares, each with its tolerance. The error names a variable that the run does not have.
pub fn selected(traces: &Traces, columns: &[Column]) -> Result<Vec<(usize, Tolerance)>, String> {
    let mut chosen = Vec::new();
    for wanted in &traces.variables {
        let before = chosen.len();
        if wanted.contains('*') {
            let found = columns.iter().enumerate().filter(|(_, c)| is_match(wanted, &c.name));
            chosen.extend(found.map(|(k, _)| k));
        } else {
            chosen.extend(position(columns, wanted));
        }
        if chosen.len() == before {
            return Err(format!("the run has no variable `{wanted}`"));
        }
    }
    if traces.variables.is_empty() {
        chosen.extend(own(columns));
    }
    if let Some((name, _)) = traces.each.iter().find(|(name, _)| position(columns, name).is_none())
    {
        return Err(format!("the run has no variable `{name}`"));
    }
    chosen.sort_unstable();
    chosen.dedup();
    let tolerance = |k: usize| {
        let own = traces.each.iter().find(|(name, _)| position(columns, name) == Some(k));
        own.map_or(traces.tolerance, |(_, own)| *own)
    };
    Ok(chosen.into_iter().map(|k| (k, tolerance(k))).collect())
}

/// The variables of the model itself; of a model that has none, all continuous ones that are not derivatives.
fn own(columns: &[Column]) -> Vec<usize> {
    let of = |accepts: &dyn Fn(&Column) -> bool| {
        let all =
            columns.iter().enumerate().filter(|(_, c)| accepts(c) && !c.name.starts_with("der("));
        all.map(|(k, _)| k).collect::<Vec<_>>()
    };
    let top = of(&|c| !c.name.contains('.'));
    if top.is_empty() { of(&|c| c.kind == Kind::Continuous) } else { top }
}

/// Whether a name matches a pattern, in which `*` means any characters.
fn is_match(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((head, rest)) => name.strip_prefix(head).is_some_and(|name| {
            name.char_indices().any(|(k, _)| is_match(rest, &name[k..])) || is_match(rest, "")
        }),
    }
}

/// A variable that departs from its reference.
#[derive(Clone, PartialEq, Debug)]
pub struct Departure {
    /// Its column in the run.
    pub column: usize,
    /// Its column in the reference.
    pub of_reference: usize,
    /// How far.
    pub deviation: Deviation,
}

/// The differences of two runs.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Differences {
    /// Messages, one for each variable.
    pub messages: Vec<String>,
    /// The variables that depart, the worst first.
    pub departures: Vec<Departure>,
}

/// Compares columns of a run with those of the same name in a reference, or of another name that `names` gives. The time
/// that both have in common is compared; it must be all of the reference.
pub fn compare(
    run: &Trajectory,
    columns: &[(usize, Tolerance)],
    reference: &Trajectory,
    names: &[(String, String)],
) -> Differences {
    let mut found = Differences::default();
    for (what, rows) in [("run", &run.time), ("reference", &reference.time)] {
        if rows.is_empty() {
            found.messages.push(format!("the {what} has no rows"));
        }
    }
    let shift = columns.iter().map(|(_, t)| t.shift(&reference.time)).fold(0.0, f64::max);
    for (happens, own, of_reference) in [
        ("begins", run.time.first(), reference.time.first()),
        ("ends", run.time.last(), reference.time.last()),
    ] {
        if let (Some(own), Some(of_reference)) = (own, of_reference)
            && (own - of_reference).abs() > shift.max(1e-9 * of_reference.abs())
        {
            let message =
                format!("the run {happens} at {own} s, the reference at {of_reference} s");
            found.messages.push(message);
        }
    }
    for (column, tolerance) in columns {
        let Column { name, unit, .. } = &run.columns[*column];
        let other = names.iter().find(|(own, _)| own == name).map_or(name, |(_, other)| other);
        let Some(of_reference) = reference.position(other) else {
            found.messages.push(format!("the reference has no variable `{other}`"));
            continue;
        };
        let curve = Curve { time: &run.time, values: &run.data[*column] };
        let expected = Curve { time: &reference.time, values: &reference.data[of_reference] };
        if let Some(deviation) = deviation(curve, expected, tolerance) {
            found.messages.push(message(name, unit, &deviation));
            found.departures.push(Departure { column: *column, of_reference, deviation });
        }
    }
    let size =
        |d: &Departure| (d.deviation.found - d.deviation.expected).abs() / d.deviation.allowed;
    found.departures.sort_by(|a, b| size(b).total_cmp(&size(a)));
    found
}

fn message(name: &str, unit: &str, d: &Deviation) -> String {
    let unit = if matches!(unit, "" | "1") { String::new() } else { format!(" {unit}") };
    let (found, expected, allowed) = (digits(d.found), digits(d.expected), short(d.allowed));
    let part = match 100.0 * d.part {
        part if part < 1.0 => "less than 1 %".to_owned(),
        part => format!("{part:.0} %"),
    };
    format!(
        "`{name}` is {found}{unit} at {} s, the reference {expected} ± {allowed}{unit}; {part} of the instants are outside, \
         the first at {} s",
        digits(d.time),
        digits(d.first)
    )
}

/// Seven significant digits.
fn digits(value: f64) -> String {
    let near: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    if near != 0.0 && !(1e-4..1e7).contains(&near.abs()) {
        format!("{near:e}")
    } else {
        near.to_string()
    }
}

/// Two significant digits.
fn short(value: f64) -> String {
    let near: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    if near != 0.0 && !(1e-3..1e7).contains(&near.abs()) {
        format!("{near:e}")
    } else {
        near.to_string()
    }
}

/// A picture of the variables that depart most, before and now.
pub fn picture(
    title: &str,
    run: &Trajectory,
    reference: &Trajectory,
    found: &Differences,
) -> Chart {
    let shown = &found.departures[..found.departures.len().min(MAX_PANELS)];
    let panel = |d: &Departure| {
        let Column { name, unit, .. } = &run.columns[d.column];
        if unit.is_empty() { name.clone() } else { format!("{name} in {unit}") }
    };
    let of = |run: &Trajectory, column: &dyn Fn(&Departure) -> usize| {
        shown.iter().map(|d| Some(run.data[column(d)].to_vec())).collect()
    };
    let before = Series {
        label: "reference".into(),
        x: reference.time.clone(),
        y: of(reference, &|d| d.of_reference),
    };
    let now = Series { label: "this run".into(), x: run.time.clone(), y: of(run, &|d| d.column) };
    Chart {
        title: title.to_owned(),
        groups: vec![Group { heading: String::new(), series: vec![before, now] }],
        panels: shown.iter().map(panel).collect(),
        across: "time in s".into(),
        logarithmic: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_any_characters() {
        for (pattern, name, matches) in [
            ("p*", "p2", true),
            ("p*", "s", false),
            ("*.v", "spool.v", true),
            ("*.v", "spool.vx", false),
            ("a*b*c", "abc", true),
            ("*", "", true),
            ("s", "s", true),
        ] {
            assert_eq!(is_match(pattern, name), matches, "{pattern} {name}");
        }
    }

    #[test]
    fn variables_are_chosen_by_name_or_are_those_of_the_model() {
        let columns = ["s", "spool.v", "der(s)", "p2", "p4"].map(|n| Column::new(n, "")).to_vec();
        let of = |variables: &[&str]| {
            let traces = Traces {
                variables: variables.iter().map(|v| (*v).to_owned()).collect(),
                tolerance: Tolerance::default(),
                each: Vec::new(),
                reference: None,
                names: Vec::new(),
            };
            selected(&traces, &columns).map(|c| c.into_iter().map(|(k, _)| k).collect::<Vec<_>>())
        };
        assert_eq!(of(&[]), Ok(vec![0, 3, 4]));
        assert_eq!(of(&["p*", "spool.v"]), Ok(vec![1, 3, 4]));
        assert_eq!(of(&["q"]), Err("the run has no variable `q`".to_owned()));
    }
}
