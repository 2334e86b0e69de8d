//! `mocc test` and `mocc compare`, as a user runs them.

use std::fs;
use std::path::Path;

use super::door::Scratch;
use super::program::{Ended, mocc, piped};

/// A ramp that a switch starts, and a wave.
const MODEL: &str = "model Ramp
  parameter Real t_on = 0.3;
  parameter Real gain = 1;
  Real x(start = 0, fixed = true);
  Real y = gain*sin(7*time);
  Boolean on = time >= t_on;
equation
  der(x) = if on then gain else 0;
  annotation(experiment(StopTime = 1, Interval = 0.01));
end Ramp;
";

const TESTS: &str = "[[test]]
name = \"all\"
flat = true
blocks = true
events = { time = 1e-3 }
traces = { variables = [\"x\", \"y\"], time = 1e-3 }
diagnostics = []

[test.measures]
t_half = { is = \"when(x > 0.5)\", min = \"0.79 s\", max = \"810 ms\" }
";

fn project() -> Scratch {
    let folder = Scratch::new();
    folder.file("ramp.mo", MODEL);
    folder.file("ramp.test.toml", TESTS);
    folder
}

fn accepted() -> Scratch {
    let folder = project();
    let ended = mocc(folder.path(), &["test", "--update"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    folder
}

fn edited(folder: &Scratch, old: &str, new: &str) {
    assert_eq!(MODEL.matches(old).count(), 1, "{old}");
    folder.file("ramp.mo", &MODEL.replace(old, new));
}

fn test(folder: &Scratch, more: &[&str]) -> Ended {
    let mut all = vec!["test"];
    all.extend(more);
    mocc(folder.path(), &all)
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|why| panic!("{name}: {why}"))
}

#[test]
fn a_snapshot_is_missing_until_it_is_accepted() {
    let folder = project();
    let ended = test(&folder, &[]);
    assert_eq!(ended.status, 1);
    assert_eq!(ended.out.matches("there is no snapshot").count(), 4, "{}", ended.out);
    let ended = test(&folder, &["--update"]);
    assert_eq!(ended.status, 0, "{}", ended.out);
    assert!(ended.out.contains("1 passed, 0 failed, 4 snapshots written"), "{}", ended.out);
    assert_eq!(
        read(folder.path(), "ramp.test/all.events.txt"),
        "0.300000000 s: time >= t_on became true\n"
    );
    let ended = test(&folder, &[]);
    assert_eq!(ended.status, 0, "{}", ended.out);
    // The reference has few rows: a ramp needs its corners, and 7 rad of a sine a few dozen.
    let rows = read(folder.path(), "ramp.test/all.traces.csv").lines().count();
    assert!((20..101).contains(&rows), "{rows} rows");
}

#[test]
fn a_trace_that_is_off_by_one_percent_fails() {
    let folder = accepted();
    edited(&folder, "y = gain*sin", "y = 1.01*gain*sin");
    let ended = test(&folder, &[]);
    assert_eq!(ended.status, 1);
    assert!(ended.out.contains("traces: `y` is -1.0097"), "{}", ended.out);
    assert!(!ended.out.contains("`x`"), "{}", ended.out);
    let page = read(folder.path(), "mocc-test.html");
    assert!(page.contains("this run") && page.contains("<svg"), "the page shows the traces");
}

#[test]
fn an_event_may_move_within_its_tolerance() {
    let folder = accepted();
    edited(&folder, "t_on = 0.3;", "t_on = 0.3005;");
    // The flat model is another one; traces and events are the same within a millisecond.
    let ended = test(&folder, &[]);
    assert!(ended.out.contains("flat: differs"), "{}", ended.out);
    assert!(!ended.out.contains("events:") && !ended.out.contains("traces:"), "{}", ended.out);
    edited(&folder, "t_on = 0.3;", "t_on = 0.302;");
    let ended = test(&folder, &[]);
    let moved = "events: `time >= t_on` happens";
    assert!(
        ended.out.contains("became true` happens at 0.302000000 s, not at 0.300000000 s"),
        "{moved}\n{}",
        ended.out
    );
    assert!(ended.out.contains("traces: `x`"), "{}", ended.out);
}

#[test]
fn an_update_shows_the_change_and_writes_only_snapshots() {
    let folder = accepted();
    edited(&folder, "gain = 1;", "gain = 1.1;");
    let before = read(folder.path(), "ramp.test/all.events.txt");
    let ended = test(&folder, &["--update"]);
    // The measure is out of its bounds, which no update changes.
    assert_eq!(ended.status, 1);
    for part in [
        "-  parameter Real gain = 1.0",
        "+  parameter Real gain = 1.1",
        "measures: `t_half` = 0.7545",
    ] {
        assert!(ended.out.contains(part), "no `{part}` in\n{}", ended.out);
    }
    assert_eq!(read(folder.path(), "ramp.test/all.events.txt"), before, "it agreed");
    let files: Vec<String> = fs::read_dir(folder.path().join("ramp.test"))
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(files.len(), 4, "no temporary file remains: {files:?}");
}

#[test]
fn outcomes_are_written_for_programs() {
    let folder = accepted();
    folder.file("other.test.toml", "model = \"ramp.mo\"\n[[test]]\nname = \"steep <&>\"\nset = { gain = 2 }\n[test.measures]\nx_end = { is = \"final(x)\", max = 1 }\n");
    let ended = test(&folder, &["--json", "--junit", "out.xml", "--jobs", "1"]);
    assert_eq!(ended.status, 1);
    let json: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!((json["passed"].as_u64(), json["failed"].as_u64()), (Some(1), Some(1)));
    assert_eq!(json["tests"][0]["name"], "steep <&>");
    let message = json["tests"][0]["failures"][0]["message"].as_str().expect("a message");
    assert!(
        message.starts_with("`x_end` = 1.") && message.ends_with("is greater than 1"),
        "{message}"
    );
    let junit = read(folder.path(), "out.xml");
    for part in [
        "<testsuites name=\"mocc\" tests=\"2\" failures=\"1\"",
        "name=\"steep &lt;&amp;&gt;\"",
        "<failure type=\"measures\"",
        "<testsuite name=\"ramp.test.toml\" tests=\"1\" failures=\"0\"",
    ] {
        assert!(junit.contains(part), "no `{part}` in\n{junit}");
    }
    let ended = test(&folder, &["--filter", "ramp.test.toml: a"]);
    assert_eq!((ended.status, ended.out.lines().count()), (0, 2), "{}", ended.out);
}

#[test]
fn results_of_other_programs_are_references() {
    let folder = project();
    for name in ["ref.mat", "ref.parquet", "ref.csv"] {
        let ended = mocc(folder.path(), &["simulate", "ramp.mo", "--output", name]);
        assert_eq!(ended.status, 0, "{}", ended.err);
        let tests = format!(
            "model = \"ramp.mo\"\n[[test]]\nname = \"a\"\ntraces = {{ reference = \"{name}\" }}\n"
        );
        folder.file("reference.test.toml", &tests);
        let ended = test(&folder, &["reference.test.toml"]);
        assert_eq!(ended.status, 0, "{name}: {}", ended.out);
        edited(&folder, "y = gain*sin", "y = 1.01*gain*sin");
        let ended = test(&folder, &["reference.test.toml", "--update"]);
        assert_eq!(ended.status, 1, "a reference is never accepted: {}", ended.out);
        assert!(ended.out.contains("traces: `y` is"), "{name}: {}", ended.out);
        folder.file("ramp.mo", MODEL);
    }
    let compare = |more: &[&str]| {
        let mut all = vec!["compare"];
        all.extend(more);
        mocc(folder.path(), &all)
    };
    let ended = compare(&["ref.mat", "ref.parquet"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    mocc(folder.path(), &["simulate", "ramp.mo", "--set", "gain=1.01", "--output", "off.csv"]);
    let ended = compare(&["off.csv", "ref.mat", "--plot", "off.svg"]);
    assert_eq!(ended.status, 1);
    assert!(ended.out.contains("`x` is") && ended.out.contains("`y` is"), "{}", ended.out);
    assert!(folder.path().join("off.svg").exists());
    assert_eq!(compare(&["off.csv", "ref.mat", "--relative", "0.02"]).status, 0);
    let json = compare(&["off.csv", "ref.csv", "--show", "y", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!((&json["agree"], &json["differ"][0]["variable"]), (&false.into(), &"y".into()));
    folder.file("empty.csv", "time,y\n");
    folder.file("late.csv", "time,y\n0.9,0.5\n1,0.5\n");
    folder.file("whole.csv", "time,y\n0,0.5\n0.9,0.5\n1,0.5\n");
    for (pair, why) in [
        (["empty.csv", "whole.csv"], "the run has no rows"),
        (["whole.csv", "empty.csv"], "the reference has no rows"),
        (["late.csv", "whole.csv"], "the run begins at 0.9 s, the reference at 0 s"),
    ] {
        let ended = compare(&pair);
        assert!(ended.status == 1 && ended.out.contains(why), "{pair:?}: {}", ended.out);
    }
    folder.file("pico.csv", "time,y\n0,1e-13\n1,3e-13\n");
    folder.file("larger.csv", "time,y\n0,1e-13\n1,4e-13\n");
    // What is smaller than 1e-12 counts as rounding unless the tolerance says otherwise.
    assert_eq!(compare(&["larger.csv", "pico.csv"]).status, 0);
    assert_eq!(compare(&["larger.csv", "pico.csv", "--absolute", "0"]).status, 1);
    for (wrong, why) in [
        (&["none.csv", "ref.csv"][..], "cannot read none.csv"),
        (&["ref.txt", "ref.csv"], "results can be read from .csv, .parquet or .mat"),
        (&["ref.csv", "ref.mat", "--show", "z"], "the run has no variable `z`"),
        (&["ref.csv", "ref.mat", "--relative", "-1"], "not negative"),
    ] {
        let ended = compare(wrong);
        assert_eq!(ended.status, 2, "{wrong:?}");
        assert!(ended.err.contains(why), "{wrong:?}: {}", ended.err);
    }
}

#[test]
fn wrong_use_has_one_message_and_status_2() {
    let folder = project();
    let empty = Scratch::new();
    let said = |folder: &Scratch, more: &[&str]| {
        let ended = test(folder, more);
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{more:?}");
        ended.err
    };
    let nothing = "neither a file NAME.test.toml nor a model with `__mocc(tests(...))`\n";
    assert_eq!(said(&empty, &[]), format!("error: there are no tests in .: {nothing}"));
    assert!(said(&folder, &["none"]).starts_with("error: cannot read none: "));
    folder.file("plain.mo", MODEL);
    let err = said(&folder, &["plain.mo"]);
    assert_eq!(err, format!("error: there are no tests in plain.mo: {nothing}"));
    folder.file("ramp.csv", "time,x\n");
    assert!(said(&folder, &["ramp.csv"]).contains("ramp.csv is neither a test file"));
    assert_eq!(said(&folder, &["--filter", "zzz"]), "error: no test matches `zzz`; there are 1\n");
    assert!(said(&folder, &["--jobs", "0"]).contains("--jobs"));
    assert!(said(&folder, &["--review", "page.txt"]).contains("must end in .html"));
    folder.file("bad.test.toml", "model = \"ramp.mo\"\n[[test]]\nname = \"a\"\ntrace = true\n");
    let err = said(&folder, &[]);
    assert!(
        err.contains("error[MO1402]: unknown key `trace`")
            && err.contains("did you mean `traces`?")
            && !err.contains("expects nothing"),
        "{err}"
    );
    folder.file("bad.test.toml", "model = \"ramp.mo\"\n");
    assert!(said(&folder, &[]).contains("help: add a table `[[test]]`"));
    folder.file("bad.test.toml", "[[test]]\nname = \"a\"\ntraces = true\n");
    folder.file(
        "slip.mo",
        "model A\n  Real x = time;\n  annotation(__mocc(test(a(traces = true))));\nend A;\n",
    );
    let err = said(&folder, &["slip.mo"]);
    assert!(err.contains("unknown key `test`") && err.contains("`tests`?"), "{err}");
}

#[test]
fn a_model_stands_for_its_test_file_and_a_test_file_may_be_piped() {
    let folder = accepted();
    let ended = test(&folder, &["ramp.mo"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    assert!(ended.out.contains("pass  ramp.test.toml"), "{}", ended.out);
    let text = "model = \"ramp.mo\"\n[[test]]\nname = \"ends\"\ndiagnostics = []\n";
    let ended = piped(folder.path(), &["test", "-"], text);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    assert!(ended.out.starts_with("pass  stdin.test.toml: ends"), "{}", ended.out);
}

/// Bounds are in the units of what they bound, which need not be SI.
#[test]
fn bounds_of_measures_are_converted_to_their_units() {
    let folder = Scratch::new();
    folder.file(
        "warm.mo",
        "model Warm\n  Real T(unit = \"degC\", start = 20, fixed = true);\nequation\n  der(T) = 1;\nend Warm;\n",
    );
    let bounded = |min: &str| {
        let text = format!(
            "[[test]]\nname = \"a\"\nmeasures = {{ T_e = {{ is = \"final(T)\", min = \"{min}\" }} }}\n"
        );
        folder.file("warm.test.toml", &text);
        test(&folder, &[])
    };
    assert_eq!(bounded("294 K").status, 0);
    assert_eq!(bounded("20.9 degC").status, 0);
    assert_eq!(bounded("295 K").status, 1);
    let ended = bounded("3 bar");
    assert!(
        ended.out.contains("`T_e` is in `degC`, which `bar` does not measure"),
        "{}",
        ended.out
    );
}

/// The model of the tests in annotations, within a package.
fn annotated(tests: &str) -> String {
    let model = MODEL.replace(
        "annotation(experiment(StopTime = 1, Interval = 0.01));",
        &format!("annotation(experiment(StopTime = 1, Interval = 0.01), __mocc(tests({tests})));"),
    );
    format!("package P\n{model}end P;\n")
}

#[test]
fn tests_in_annotations_are_those_of_files() {
    const TESTS: &str = "all(flat = true, blocks = true, events(time = 1e-3), traces(variables = {\"x\", \"y\"}, \
                         time = 1e-3), diagnostics = {}, measures(t_half(is = \"when(x > 0.5)\", min = \"0.79 s\", \
                         max = 0.81))), 'other gain'(vary(gain = {1, 2}), stop = 0.5, measures(y_max(is = \"max(y)\", \
                         max = \"2.1\")))";
    let folder = Scratch::new();
    folder.file("ramp.mo", &annotated(TESTS));
    let ended = test(&folder, &["--update"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    assert!(folder.path().join("ramp.mo.test/P.Ramp.all.traces.csv").is_file());
    let ended = test(&folder, &["ramp.mo"]);
    assert!(ended.out.contains("pass  ramp.mo: P.Ramp.other gain[gain=2] "), "{}", ended.out);
    assert!(ended.out.ends_with("3 passed, 0 failed\n"), "{}", ended.out);
    // An event within its tolerance, and one beyond it.
    let moved = |by: &str| {
        folder.file("ramp.mo", &annotated(TESTS).replace("t_on = 0.3", by));
        test(&folder, &["--filter", "all"])
    };
    let within = moved("t_on = 0.3005");
    assert!(!within.out.contains("events:") && !within.out.contains("traces:"), "{}", within.out);
    assert!(moved("t_on = 0.303").out.contains("events:"));
    // A trace that is off by 1 %.
    folder.file("ramp.mo", &annotated(TESTS).replace("gain*sin", "1.01*gain*sin"));
    let off = test(&folder, &["--filter", "all"]);
    assert_eq!(off.status, 1);
    assert!(off.out.contains("traces: `y` is "), "{}", off.out);
}

#[test]
fn errors_in_annotations_have_a_place() {
    let folder = Scratch::new();
    let said = |tests: &str| {
        folder.file("ramp.mo", &annotated(tests));
        let ended = test(&folder, &[]);
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{tests}");
        ended.err
    };
    let err = said("all(trace = true, flat = true)");
    assert!(err.contains("error[MO1402]: unknown key `trace`"), "{err}");
    assert!(err.contains("ramp.mo:10:"), "{err}");
    assert!(said("all(flat = 1)").contains("error[MO1403]: `flat` must be `true` or `false`"));
    assert!(said("all = true").contains("`all` must be a test `NAME(...)`"));
    assert!(said("all(stop = 1)").contains("error[MO1405]"));
    assert!(said("a(flat = true), a(flat = true)").contains("error[MO1404]"));
    // A source that cannot be read may have tests.
    folder.file("ramp.mo", "model Ramp __mocc tests");
    assert!(test(&folder, &[]).err.contains("error[MO00"));
}

#[test]
fn snapshots_do_not_depend_on_the_working_directory() {
    let folder = accepted();
    let parent = folder.path().parent().expect("a folder");
    let name = folder.path().file_name().expect("a name").to_string_lossy().into_owned();
    let ended = mocc(parent, &["test", &name]);
    assert_eq!(ended.status, 0, "{}", ended.out);
}

#[test]
fn an_update_that_is_killed_leaves_the_old_or_the_new_file() {
    let folder = accepted();
    let snapshots = |folder: &Scratch| -> Vec<(String, String)> {
        let list = fs::read_dir(folder.path().join("ramp.test")).expect("the snapshots");
        let mut all: Vec<(String, String)> = list
            .flatten()
            .map(|e| e.file_name().to_string_lossy().into_owned())
            .filter(|name| !name.starts_with('.') && !name.contains(".tmp"))
            .map(|name| (name.clone(), read(folder.path(), &format!("ramp.test/{name}"))))
            .collect();
        all.sort();
        all
    };
    let old = snapshots(&folder);
    edited(&folder, "gain = 1;", "gain = 1.2;");
    let other = project();
    edited(&other, "gain = 1;", "gain = 1.2;");
    mocc(other.path(), &["test", "--update"]);
    let new = snapshots(&other);
    let mut ends = [0, 0];
    for delay in 0..24 {
        for (name, text) in &old {
            folder.file(&format!("ramp.test/{name}"), text);
        }
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_mocc"))
            .current_dir(folder.path())
            .args(["test", "--update", "--jobs", "1"])
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("mocc starts");
        std::thread::sleep(std::time::Duration::from_micros(1500 * delay));
        // It may have ended.
        let _ = child.kill();
        child.wait().expect("it ends");
        for (name, text) in &old {
            let found = read(folder.path(), &format!("ramp.test/{name}"));
            let after = new.iter().find(|(other, _)| other == name).map(|(_, text)| text);
            assert!(found == *text || Some(&found) == after, "{name} is neither: {found}");
            ends[usize::from(found != *text)] += 1;
        }
    }
    assert!(ends[0] > 0, "no run was killed before its end: {ends:?}");
}
