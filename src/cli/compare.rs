//! `mocc compare`: two results in, their differences out.

use std::path::Path;

use super::args::model::is_standard;
use super::args::results::Compare;
use super::{Status, print, print_bytes, running, standard, standard_input};
use crate::compare::tolerance::Tolerance;
use crate::io::csv::{table_of, trajectory_of};
use crate::io::format::Format;
use crate::io::json::Json;
use crate::ir::trajectory::Trajectory;
use crate::regression::test_file::Traces;
use crate::regression::traces::{Differences, compare, picture, selected};
use crate::report::chart::{chart, svg};

/// Runs the command: status 0 if the results agree, 1 if they differ.
pub fn run(options: &Compare) -> Status {
    match carry_out(options) {
        Ok(status) => status,
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

fn carry_out(options: &Compare) -> Result<Status, String> {
    if is_standard(&options.found) && is_standard(&options.reference) {
        return Err("only one of the results can be the standard input".to_owned());
    }
    let is_piped =
        standard::single_with_json(&[("--plot", &options.plot)], options.json)?.is_some();
    let run = result(&options.found)?;
    let reference = result(&options.reference)?;
    let mut names = Vec::new();
    for text in &options.names {
        let pair = text.split_once('=').ok_or_else(|| format!("`{text}`: write NAME=OTHER"))?;
        names.push((pair.0.trim().to_owned(), pair.1.trim().to_owned()));
    }
    let tolerance =
        Tolerance { relative: options.relative, absolute: options.absolute, time: options.time };
    let mut traces = Traces {
        variables: options.show.as_deref().map(running::names_in).unwrap_or_default(),
        tolerance,
        each: Vec::new(),
        reference: None,
        names,
    };
    if traces.variables.is_empty() {
        traces.variables = common(&run, &reference, &traces.names);
        if traces.variables.is_empty() {
            let files = [&options.found, &options.reference].map(|p| p.display().to_string());
            return Err(format!("{} have no variable in common", files.join(" and ")));
        }
    }
    let columns = selected(&traces, &run.columns)
        .map_err(|why| format!("{}: {why}", options.found.display()))?;
    let found = compare(&run, &columns, &reference, &traces.names);
    let agree = found.messages.is_empty();
    if let Some(path) = options.plot.as_ref().filter(|_| !found.departures.is_empty()) {
        let title = format!("{} and {}", options.found.display(), options.reference.display());
        let drawn = picture(&title, &run, &reference, &found);
        match is_piped {
            true => print_bytes(svg(&drawn).map_err(|e| e.to_string())?.as_bytes())?,
            false => chart(&drawn, path).map_err(|e| e.to_string())?,
        }
    }
    let text = if options.json {
        json(&found, columns.len(), &run).pretty()
    } else {
        let mut text: String = found.messages.iter().map(|m| format!("{m}\n")).collect();
        text +=
            &format!("{} variables compared, {} differ\n", columns.len(), found.departures.len());
        text
    };
    let printed = match is_piped {
        true if options.quiet => Status::Done,
        true => {
            eprint!("{text}");
            Status::Done
        }
        false => print(&text),
    };
    match printed {
        Status::Done if !agree => Ok(Status::Model),
        status => Ok(status),
    }
}

/// The result in a file; `-` is CSV on the standard input.
fn result(path: &Path) -> Result<Trajectory, String> {
    if !is_standard(path) {
        return Format::read(path, &|_| true);
    }
    let table = table_of(path, standard_input().as_bytes());
    table.and_then(|table| trajectory_of(path, table)).map_err(|why| why.to_string())
}

/// The variables that both results have.
fn common(run: &Trajectory, reference: &Trajectory, names: &[(String, String)]) -> Vec<String> {
    let other = |name: &str| {
        let renamed = names.iter().find(|(own, _)| own == name);
        renamed.map_or(name.to_owned(), |(_, other)| other.clone())
    };
    let all = run.columns.iter().map(|c| c.name.clone());
    all.filter(|name| reference.position(&other(name)).is_some()).collect()
}

fn json(found: &Differences, compared: usize, run: &Trajectory) -> Json {
    let departures = found.departures.iter().map(|d| {
        Json::object([
            ("variable", Json::text(run.columns[d.column].name.as_str())),
            ("time", Json::number(d.deviation.time)),
            ("first", Json::number(d.deviation.first)),
            ("found", Json::number(d.deviation.found)),
            ("expected", Json::number(d.deviation.expected)),
            ("allowed", Json::number(d.deviation.allowed)),
            ("outside", Json::number(d.deviation.part)),
        ])
    });
    Json::object([
        ("agree", Json::flag(found.messages.is_empty())),
        ("compared", Json::count(compared)),
        ("differ", Json::list(departures)),
        ("messages", Json::list(found.messages.iter().map(|m| Json::text(m.as_str())))),
    ])
}
