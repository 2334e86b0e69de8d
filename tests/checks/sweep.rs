//! Sweeps: the table, its independence of threads and interruptions, and the measures against closed forms.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use mocc::driver::compile::{Request, Session};
use mocc::io::journal::{Found, Journal};
use mocc::simulate::settings::Settings;
use mocc::sweep::design::Design;
use mocc::sweep::runs::Sweep;
use mocc::sweep::variant::{Model, Variants};
use mocc::sweep::vary::Axis;

use super::door::{Scratch, assert_close, suite_model};
use super::program::{Ended, mocc};

/// A table as columns of strings.
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// The table that a sweep wrote; its values must not contain commas.
    pub fn read(path: &Path) -> Table {
        let text = std::fs::read_to_string(path).expect("a table");
        let mut lines = text.lines().map(|l| l.split(',').map(str::to_owned).collect::<Vec<_>>());
        let names = lines.next().expect("a header");
        Table { names, rows: lines.collect() }
    }
    /// The values of a column.
    pub fn strings(&self, name: &str) -> Vec<&str> {
        let k = self.names.iter().position(|n| n == name).expect(name);
        self.rows.iter().map(|row| row[k].as_str()).collect()
    }
    /// The numbers of a column, NaN where there is none.
    pub fn of(&self, name: &str) -> Vec<f64> {
        self.strings(name).iter().map(|t| t.parse().unwrap_or(f64::NAN)).collect()
    }
}

/// Runs a sweep of an example or of a model given as text.
pub fn sweep(model: &str, more: &[&str]) -> (Scratch, Ended) {
    let folder = Scratch::new();
    let root = env!("CARGO_MANIFEST_DIR");
    let file = if model.contains('\n') {
        folder.file("model.mo", model).display().to_string()
    } else {
        format!("{root}/{model}")
    };
    let mut arguments = vec!["sweep", &file, "--output", "out"];
    arguments.extend(more);
    let ended = mocc(folder.path(), &arguments);
    (folder, ended)
}

/// The table of a sweep that must succeed.
pub fn table(model: &str, more: &[&str]) -> Table {
    let (folder, ended) = sweep(model, more);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    Table::read(&folder.path().join("out/sweep.csv"))
}

/// One row of measures, as numbers.
fn measures(model: &str, more: &[&str], list: &[&str]) -> Vec<f64> {
    let mut arguments = more.to_vec();
    list.iter().for_each(|m| arguments.extend(["--measure", m]));
    let table = table(model, &arguments);
    list.iter().map(|m| table.of(m.split('=').next().expect("a name").trim())[0]).collect()
}

fn decay_model() -> String {
    suite_model("sweep/models/decay")
}

#[test]
fn a_grid_has_a_row_for_each_combination_in_order() {
    let table = table(
        &decay_model(),
        &["--vary", "rate=1:2:3", "--vary", "x[1].start=1,2", "--measure", "last = final(total)"],
    );
    assert_eq!(
        table.names,
        ["run", "rate", "x[1].start", "last", "status", "error", "steps", "events"]
    );
    assert_eq!(table.strings("run"), ["1", "2", "3", "4", "5", "6"]);
    assert_eq!(table.of("rate"), [1.0, 1.0, 1.5, 1.5, 2.0, 2.0]);
    assert_eq!(table.of("x[1].start"), [1.0, 2.0, 1.0, 2.0, 1.0, 2.0]);
    for ((rate, start), end) in
        table.of("rate").iter().zip(table.of("x[1].start")).zip(table.of("last"))
    {
        assert_close(end, start * (-rate).exp() + (-2.0 * rate).exp(), 1e-7);
    }
}

#[test]
fn structural_parameters_are_compiled_for_each_value() {
    let table = table(
        &decay_model(),
        &["--vary", "n=1,2,3", "--vary", "doubled=false,true", "--measure", "last = final(total)"],
    );
    let sum = |n: i32| (1..=n).map(|i| (-f64::from(i)).exp()).sum::<f64>();
    let expected = [sum(1), 2.0 * sum(1), sum(2), 2.0 * sum(2), sum(3), 2.0 * sum(3)];
    for (found, expected) in table.of("last").iter().zip(expected) {
        assert_close(*found, expected, 1e-7);
    }
    assert_eq!(table.strings("doubled"), ["false", "true", "false", "true", "false", "true"]);
}

#[test]
fn a_failure_has_a_row_and_does_not_stop_the_rest() {
    let arguments = ["--vary", "rate=1,5,2", "--measure", "last = final(x[1])", "--jobs", "2"];
    let (folder, ended) = sweep(&decay_model(), &arguments);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(
        ended.out.contains("3 runs, 1 failed") && ended.out.contains("run 2: "),
        "{}",
        ended.out
    );
    let table = Table::read(&folder.path().join("out/sweep.csv"));
    assert_eq!(table.strings("status"), ["ok", "failed", "ok"]);
    assert_eq!(table.strings("last")[1], "");
    assert!(table.strings("error")[1].contains("too fast"), "{}", table.strings("error")[1]);
    let (_, ended) = sweep(&decay_model(), &["--vary", "rate=5,6"]);
    assert_eq!(ended.status, 3, "{}", ended.out);
}

#[test]
fn a_latin_hypercube_hits_each_stratum_once() {
    let sample =
        ["--vary", "rate=1:3", "--vary", "x[2].start=0:10", "--sample", "lhs:40", "--seed", "3"];
    let table = table(&decay_model(), &sample);
    for (name, from, length) in [("rate", 1.0, 2.0), ("x[2].start", 0.0, 10.0)] {
        let mut strata: Vec<u64> =
            table.of(name).iter().map(|x| ((x - from) / length * 40.0) as u64).collect();
        strata.sort_unstable();
        assert_eq!(strata, (0..40).collect::<Vec<_>>(), "{name}");
    }
}

#[test]
fn the_table_does_not_depend_on_the_number_of_threads() {
    let text = |jobs: &str, output: &str| {
        let arguments = [
            "--vary",
            "p_supply=2e5:9e5",
            "--vary",
            "t_dwell=1:3600",
            "--sample",
            "lhs:24",
            "--jobs",
            jobs,
            "--measure",
            "t_switch = when(s > 0.95*s_max)",
            "--measure",
            "v_mean = mean(v)",
            "--output",
            output,
        ];
        let folder = Scratch::new();
        let file = format!("{}/examples/valve52.mol", env!("CARGO_MANIFEST_DIR"));
        let mut all = vec!["sweep", file.as_str()];
        all.extend(arguments);
        let ended = mocc(folder.path(), &all);
        assert_eq!(ended.status, 0, "{}", ended.err);
        std::fs::read(folder.path().join(output)).expect("a table")
    };
    assert_eq!(text("1", "a.csv"), text("2", "a.csv"));
    assert_eq!(text("1", "a.parquet"), text("2", "a.parquet"));
}

#[test]
fn courses_are_kept_on_request() {
    let (folder, ended) = sweep(
        &decay_model(),
        &["--vary", "rate=1,2", "--show", "x[1], total", "--interval", "0.5"],
    );
    assert_eq!(ended.status, 0, "{}", ended.err);
    let run = mocc::io::csv::read_csv(folder.path().join("out/runs/00002.csv")).expect("a course");
    assert_eq!(run.time, [0.0, 0.5, 1.0]);
    assert_eq!(run.columns.len(), 2);
    assert_close(run.values("x[1]").expect("x[1]")[2], (-2.0_f64).exp(), 1e-7);
    let (_, ended) = sweep(&decay_model(), &["--vary", "rate=1", "--show", "nothing"]);
    assert_eq!(ended.status, 2);
}

/// Sweeps in process up to some number of runs, so that the interruption does not depend on a clock.
fn sweep_until(journal: &Path, jobs: usize, stop_after: u64) -> Option<Vec<u8>> {
    let file = journal.with_file_name("model.mo");
    std::fs::write(&file, decay_model()).expect("a model");
    let axes = vec![Axis::read("rate=0.5:3.5:600").expect("an axis")];
    let design = Design::grid(axes).expect("a grid");
    let model = Model {
        request: Request { file: Some(file), ..Request::default() },
        measures: vec!["last = final(x[1])".into(), "half = when(x[1] < 0.5)".into()],
        keep: None,
    };
    let mut session = Session::default();
    let Ok(base) = model.compile(&[], &mut session) else { panic!("{:?}", session.problems) };
    let settings = Settings::of(&base.program.blocks.dae.experiment);
    let measures = base.plan.columns.clone();
    let variants = Variants::new(model, base, &design.axes, design.count);
    let sweep =
        Sweep { design: &design, variants: &variants, settings, traces: None, measures, jobs };
    let Ok(Found::Ours(mut journal)) = Journal::open(journal, 1, 2) else { panic!("no journal") };
    let done = AtomicU64::new(journal.lines);
    let stop = || done.load(Ordering::Relaxed) >= stop_after;
    let observe = |k| done.store(k, Ordering::Relaxed);
    let complete = sweep.run(0..600, &mut journal, &stop, observe).expect("a sweep");
    if !complete {
        return None;
    }
    let table = std::env::temp_dir().join(format!("mocc-sweep-{}-{jobs}.csv", std::process::id()));
    let tally = sweep.write(&mut [journal], &table).expect("a table");
    assert_eq!((tally.runs, tally.failed), (600, 0));
    let text = std::fs::read(&table).expect("a table");
    std::fs::remove_file(&table).expect("a table");
    Some(text)
}

#[test]
fn an_interrupted_sweep_goes_on_to_the_same_table() {
    let folder = Scratch::new();
    let whole = sweep_until(&folder.path().join("whole"), 1, u64::MAX).expect("complete");
    let journal = folder.path().join("parts");
    assert!(sweep_until(&journal, 2, 17).is_none());
    // However late it hears of the end, only so many runs may wait for their turn. Killed while it wrote a line:
    let mut text = std::fs::read_to_string(&journal).expect("a journal");
    assert!((18..600).contains(&text.lines().count()), "{}", text.lines().count());
    text.push_str("18,1.3"); // cut off
    std::fs::write(&journal, text).expect("a journal");
    assert!(sweep_until(&journal, 3, 250).is_none());
    assert_eq!(sweep_until(&journal, 2, u64::MAX).expect("complete"), whole);
}

#[test]
fn another_sweep_at_the_same_place_is_refused() {
    let folder = Scratch::new();
    folder.file("model.mo", &decay_model());
    let run = |more: &[&str]| {
        let mut all = vec!["sweep", "model.mo", "--output", "out"];
        all.extend(more);
        mocc(folder.path(), &all)
    };
    assert_eq!(run(&["--vary", "rate=1,2"]).status, 0);
    let again = run(&["--vary", "rate=1,2"]);
    assert_eq!((again.status, again.err.contains("--restart")), (2, true), "{}", again.err);
    assert_eq!(run(&["--vary", "rate=1,3", "--restart"]).status, 0);
    // A journal of something else.
    folder.file(
        "out/sweep.journal",
        "mocc journal 2 0000000000000001 0000000000000002\n1,1,ok,,3,0\n",
    );
    let other = run(&["--vary", "rate=1,3"]);
    assert_eq!((other.status, other.err.contains("another sweep")), (2, true), "{}", other.err);
}

#[test]
fn shards_make_the_table_of_one_process() {
    let folder = Scratch::new();
    folder.file("model.mo", &decay_model());
    let run = |more: &[&str]| {
        let mut all = vec!["sweep", "model.mo", "--vary", "rate=0.5:3.5:50", "--output"];
        all.extend(more);
        mocc(folder.path(), &all)
    };
    assert_eq!(run(&["whole.csv"]).status, 0);
    for shard in ["3/3", "1/3"] {
        let ended = run(&["parts.csv", "--shard", shard]);
        assert_eq!((ended.status, ended.out.contains("complete")), (0, true), "{}", ended.err);
    }
    let early = run(&["parts.csv", "--gather"]);
    assert_eq!(early.status, 2);
    assert!(early.err.contains("2/3 has 0 of 17 runs"), "{}", early.err);
    assert_eq!(run(&["parts.csv", "--shard", "2/3"]).status, 0);
    // A shard that is complete stays so.
    assert_eq!(run(&["parts.csv", "--shard", "2/3"]).status, 0);
    let gathered = run(&["parts.csv", "--gather"]);
    assert_eq!(gathered.status, 0, "{}", gathered.err);
    assert!(gathered.out.contains("gathered from 3 shards"), "{}", gathered.out);
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a table");
    assert_eq!(read("parts.csv"), read("whole.csv"));
    let left = std::fs::read_dir(folder.path()).expect("a folder").flatten();
    assert!(left.into_iter().all(|e| !e.file_name().to_string_lossy().contains("journal")));
}

#[test]
fn shards_of_other_sweeps_and_machines_are_refused() {
    let folder = Scratch::new();
    folder.file("model.mo", &decay_model());
    let run = |vary: &str, more: &[&str]| {
        let mut all = vec!["sweep", "model.mo", "--vary", vary, "--output", "out"];
        all.extend(more);
        let ended = mocc(folder.path(), &all);
        (ended.status, ended.err)
    };
    assert!(run("rate=1,2", &["--gather"]).1.contains("no journal of a shard"));
    assert_eq!(run("rate=1,2", &["--shard", "1/2"]).0, 0);
    assert_eq!(run("rate=1,3", &["--shard", "2/2"]).0, 0);
    let mixed = run("rate=1,2", &["--gather"]);
    assert_eq!((mixed.0, mixed.1.contains("another sweep")), (2, true), "{}", mixed.1);
    // The same task, from a machine with another arithmetic.
    let path = folder.path().join("out/sweep.1-of-2.journal");
    let text = std::fs::read_to_string(&path).expect("a journal");
    let head = text.lines().next().expect("a head");
    let other = format!("{} {:016x}", &head[..head.len() - 17], 7);
    std::fs::write(&path, text.replacen(head, &other, 1)).expect("a journal");
    let foreign = run("rate=1,2", &["--shard", "1/2"]);
    assert_eq!((foreign.0, foreign.1.contains("round differently")), (2, true), "{}", foreign.1);
    assert!(run("rate=1,2", &["--shard", "3/2"]).1.contains("write I/N"));
    assert_eq!(run("rate=1,2", &["--shard", "1/3"]).0, 0);
    assert!(run("rate=1,2", &["--gather"]).1.contains("of 2 and of 3 shards"));
    assert!(run("rate=1,2", &["--cluster", "tcp://nowhere:1"]).1.contains("Python package"));
}

#[test]
fn errors_of_the_request_are_reported_at_once() {
    let said = |more: &[&str]| {
        let (_, ended) = sweep(&decay_model(), more);
        assert_eq!(ended.status, 2, "{}", ended.err);
        ended.err
    };
    assert!(said(&["--vary", "rat=1,2"]).contains("did you mean `rate`?"));
    assert!(said(&["--vary", "rate=1:2"]).contains("lhs:N"));
    assert!(said(&["--vary", "rate=1,2", "--sample", "x"]).contains("lhs:N"));
    let wrong = said(&["--measure", "a = max(y)"]);
    assert!(wrong.contains("`y` is not declared") && wrong.contains("a = max(y)"), "{wrong}");
    let wrong = said(&["--measure", "a = 2*x[1]"]);
    assert!(wrong.contains("`a` is not a single number") && wrong.contains("final(e)"), "{wrong}");
}

#[test]
fn measures_of_the_oscillator() {
    let (s_0, omega_0, damping): (f64, f64, f64) = (0.1, 10.0, 0.1);
    let omega = omega_0 * (1.0 - damping * damping).sqrt();
    let decay = damping * omega_0;
    let s =
        |t: f64| s_0 * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
    // (omega_0^2) integral of s = -[v + 2 D omega_0 s].
    let v = |t: f64| -s_0 * omega_0 * omega_0 / omega * (-decay * t).exp() * (omega * t).sin();
    let area = |a: f64, b: f64| -(v(b) - v(a) + 2.0 * decay * (s(b) - s(a))) / (omega_0 * omega_0);
    let crossing = (PI - (omega / decay).atan()) / omega;
    let found = measures(
        "examples/oscillator.mol",
        &["--tolerance", "1e-9"],
        &[
            "t_0 = when(mass.s < 0)",
            "least = min(mass.s)",
            "second = max(mass.s, from = t_0)",
            "swing = second - least",
            "fastest = min(mass.v, until = mass.s < 0)",
            "area = integral(mass.s)",
            "part = integral(mass.s, when(mass.s < 0))",
            "mean = mean(mass.s, from = time >= 1, until = time >= 2)",
            "at_1 = at(mass.s, 1)",
            "at_0 = at(mass.v, t_0)",
            "begin = initial(mass.s)",
            "last = final(mass.s)",
            "elementwise = max(1, min(2, 3))",
        ],
    );
    // s is extreme at half periods.
    let (least, second) = (s(PI / omega), s(2.0 * PI / omega));
    // v is extreme where a = 0: tan(omega t) = omega/(D omega_0).
    let fastest = v((omega / decay).atan() / omega);
    let expected = [
        crossing,
        least,
        second,
        second - least,
        fastest,
        area(0.0, 5.0),
        area(0.0, crossing),
        area(1.0, 2.0),
        s(1.0),
        v(crossing),
        s_0,
        s(5.0),
        2.0,
    ];
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < 1e-8, "measure {k}: {found} instead of {expected}");
    }
}

#[test]
fn measures_of_the_bouncing_ball() {
    let (g, e): (f64, f64) = (9.81, 0.8);
    let t_1 = (2.0 / g).sqrt();
    let found = measures(
        "examples/bouncing_ball.mol",
        &[],
        &[
            "t_3 = when(impacts >= 3)",
            "height = max(h, from = impacts >= 1)",
            "arrival = at(v, when(impacts >= 1))",
            "fastest_up = max(v)",
            "never = when(h > 2)",
            "needs = 1 + never",
        ],
    );
    let expected =
        [t_1 * (1.0 + 2.0 * (e + e * e)), e * e, -(2.0 * g).sqrt(), e * (2.0 * g).sqrt()];
    for (found, expected) in found.iter().zip(expected) {
        assert_close(*found, expected, 1e-7);
    }
    assert!(found[4].is_nan() && found[5].is_nan(), "{found:?}");
}

#[test]
fn measures_of_a_filling_vessel() {
    let rate = 1e-9 * 1.185 * 7e5 * 287.1 * 293.15 / 1e-3;
    let found = measures(
        "examples/filling.mol",
        &["--tolerance", "1e-9"],
        &[
            "t_choked = when(p > 2e5)",
            "inflow = integral(line.m_flow)",
            "stored = final(vessel.m) - initial(vessel.m)",
            "steepest = max(line.m_flow)",
        ],
    );
    assert_close(found[0], 1e5 / rate, 1e-8);
    assert_close(found[1], found[2], 1e-8);
    assert_close(found[3], 1e-9 * 1.185 * 7e5, 1e-12);
}

#[test]
fn simulate_prints_measures() {
    let folder = Scratch::new();
    let file = format!("{}/examples/bouncing_ball.mol", env!("CARGO_MANIFEST_DIR"));
    let run = |more: &[&str]| {
        let mut all = vec!["simulate", file.as_str(), "--output", "b.csv"];
        all.extend(more);
        let ended = mocc(folder.path(), &all);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""));
        let table = std::fs::read_to_string(folder.path().join("b.csv")).expect("a table");
        (ended.out, table)
    };
    let (out, measured) = run(&["--measure", "top = max(h)", "--measure", "never = when(h > 2)"]);
    assert!(out.contains("  top = 1 m\n") && out.contains("  never: did not happen\n"), "{out}");
    let (_, plain) = run(&[]);
    let header = |text: &str| text.lines().next().map(str::to_owned);
    assert_eq!(header(&measured), header(&plain), "measures leave no columns behind");
}
