//! The summary of a run as JSON, for programs.

use std::path::PathBuf;
use std::time::Duration;

use crate::io::json::Json;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Event};
use crate::simulate::run::Run;

/// Model, statistics, measures, events and the files that were written; times in s. `start` explains the initial values.
pub fn summary_json(
    program: &Program,
    run: &Run,
    compiled: Duration,
    measures: &[Column],
    values: &[Option<f64>],
    written: &[PathBuf],
    start: Option<Json>,
) -> Json {
    let dae = &program.blocks.dae;
    let s = &run.statistics;
    let count = |n: u64| Json::count(usize::try_from(n).unwrap_or(usize::MAX));
    let measure = |(column, value): (&Column, &Option<f64>)| {
        let value = value.map_or(Json::null(), Json::number);
        let unit = Json::text(column.unit.as_str());
        (column.name.clone(), Json::object([("value", value), ("unit", unit)]))
    };
    let event = |e: &Event| {
        Json::object([
            ("time", Json::number(e.time)),
            ("what", Json::text(e.what.as_str())),
            ("place", Json::text(e.place.as_str())),
        ])
    };
    let equations = dae.equations.len() + dae.discrete.len() + dae.eliminated.len();
    let statistics = Json::object([
        ("method", Json::text(s.method.to_string())),
        ("steps", count(s.integration.steps)),
        ("rejected", count(s.integration.rejected)),
        ("rows", count(s.rows)),
        ("compiled", Json::number(compiled.as_secs_f64())),
        ("simulated", Json::number(s.elapsed.as_secs_f64())),
    ]);
    let start = start.map(|start| ("start", start));
    Json::object(
        [
            ("model", Json::text(dae.name.as_str())),
            ("states", Json::count(program.state_count())),
            ("equations", Json::count(equations)),
            ("end", Json::number(s.end)),
            ("interrupted", Json::flag(s.interrupted)),
            ("terminated", s.terminated.as_deref().map_or(Json::null(), Json::text)),
            ("statistics", statistics),
            ("measures", Json::object(measures.iter().zip(values).map(measure))),
            ("events", Json::list(run.trajectory.events.iter().map(event))),
            ("files", Json::list(written.iter().map(|p| Json::text(p.display().to_string())))),
        ]
        .into_iter()
        .chain(start),
    )
}
