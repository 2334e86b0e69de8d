//! Files of results: what every format says is what the table says; a run that is interrupted.

use std::collections::HashMap;
use std::path::Path;

use mocc::io::csv::read_csv;
use mocc::ir::trajectory::Trajectory;

use super::door::{Reading, Scratch, suite_model};
use super::program::mocc;

/// Aliases, a negative one, a constant, a parameter of initialisation, events, and each type.
fn machine_model() -> String {
    suite_model("io/models/machine")
}

/// A file of MATLAB level 4: matrices by name, column by column.
struct Matrices(HashMap<String, (usize, Vec<u8>)>);

impl Matrices {
    fn read(path: &Path) -> Matrices {
        let bytes = std::fs::read(path).expect("a file");
        let mut found = HashMap::new();
        let mut at = 0;
        while at < bytes.len() {
            let word = |k: usize| {
                let place = at + 4 * k;
                i32::from_le_bytes(bytes[place..place + 4].try_into().expect("four bytes")) as usize
            };
            let (kind, rows, columns, name) = (word(0), word(1), word(2), word(4));
            let width =
                [(0, 8), (20, 4), (51, 1)].iter().find(|(k, _)| *k == kind).expect("a kind").1;
            let begin = at + 20 + name;
            let end = begin + rows * columns * width;
            let name = String::from_utf8(bytes[at + 20..begin - 1].to_vec()).expect("a name");
            found.insert(name, (rows, bytes[begin..end].to_vec()));
            at = end;
        }
        Matrices(found)
    }
    fn strings(&self, name: &str) -> Vec<String> {
        let (height, bytes) = &self.0[name];
        let text = |t: &[u8]| String::from_utf8_lossy(t).trim_end().to_owned();
        bytes.chunks(*height).map(text).collect()
    }
    fn doubles(&self, name: &str) -> (usize, Vec<f64>) {
        let (rows, bytes) = &self.0[name];
        let number = |b: &[u8]| f64::from_le_bytes(b.try_into().expect("eight bytes"));
        (*rows, bytes.chunks(8).map(number).collect())
    }
    /// Name, matrix, signed row of each variable.
    fn places(&self) -> Vec<(String, i32, i32)> {
        let number = |b: &[u8]| i32::from_le_bytes(b.try_into().expect("four bytes"));
        let words: Vec<i32> = self.0["dataInfo"].1.chunks(4).map(number).collect();
        let pairs = self.strings("name").into_iter().zip(words.chunks(4));
        pairs.map(|(name, place)| (name, place[0], place[1])).collect()
    }
    /// All values of a variable.
    fn values(&self, wanted: &str) -> Vec<f64> {
        let places = self.places();
        let (_, matrix, row) = places.iter().find(|(name, ..)| name == wanted).expect(wanted);
        let (height, values) = self.doubles(if *matrix == 1 { "data_1" } else { "data_2" });
        let sign = f64::from(row.signum());
        let at = row.unsigned_abs() as usize - 1;
        values.chunks(height).map(|instant| sign * instant[at]).collect()
    }
}

#[test]
fn a_mat_file_says_what_the_table_says() {
    let folder = Scratch::new();
    folder.file("machine.mo", &machine_model());
    for output in ["run.csv", "run.mat"] {
        let ended = mocc(folder.path(), &["simulate", "machine.mo", "--output", output]);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    }
    let table = read_csv(folder.path().join("run.csv")).expect("a table");
    let mat = Matrices::read(&folder.path().join("run.mat"));
    let (height, fixed) = mat.doubles("data_1");
    assert_eq!((fixed[0], fixed[height]), (0.0, 1.0), "begin and end");
    let (height, all) = mat.doubles("data_2");
    let times: Vec<f64> = all.chunks(height).map(|instant| instant[0]).collect();
    assert_eq!(times, table.time);
    // Two events with two rows each.
    assert_eq!(table.rows(), 11 + 4);

    let places = mat.places();
    let place = |wanted: &str| {
        let found = places.iter().find(|(name, ..)| name == wanted).expect(wanted);
        (found.1, found.2)
    };
    assert_eq!(place("same"), place("x"));
    assert_eq!(place("other"), (2, -place("x").1));
    for constant in ["m", "k", "two", "rest"] {
        assert_eq!(place(constant).0, 1, "{constant}");
    }
    assert_eq!(mat.values("m"), [2.5, 2.5]);
    assert_eq!(mat.values("rest"), [9.5, 9.5]);
    // der(x) = -k x is -3 where x is 1.
    assert!(mat.values("k").iter().all(|k| (k - 3.0).abs() < 1e-12));

    let text = mat.strings("description");
    let described =
        |wanted: &str| &text[places.iter().position(|(name, ..)| name == wanted).expect(wanted)];
    assert_eq!(described("x"), "Place [m|mm]");
    assert_eq!(described("m"), "Mass [kg]");
    for (column, values) in table.columns.iter().zip(&table.data) {
        let found = mat.values(&column.name);
        match place(&column.name).0 {
            1 => assert!(values.iter().all(|v| *v == found[0]), "{}", column.name),
            _ => assert_eq!(&found, &**values, "{}", column.name),
        }
    }
}

#[test]
fn the_result_is_that_of_the_closed_form() {
    let folder = Scratch::new();
    folder.file("machine.mo", &machine_model());
    let ended = mocc(folder.path(), &["simulate", "machine.mo", "--output", "run.csv"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let run: Trajectory = read_csv(folder.path().join("run.csv")).expect("a table");
    assert!((run.last("x") - f64::exp(-3.0)).abs() < 1e-5);
    assert_eq!((run.last("n"), run.last("high"), run.last("mode")), (1.0, 0.0, 2.0));
    // A parameter that initialisation finds is a column of one value.
    assert!(run.of("k").iter().all(|k| *k == run.first("k")));
}

#[test]
fn the_format_is_that_of_the_extension() {
    let folder = Scratch::new();
    folder.file("machine.mo", &machine_model());
    let ended = mocc(folder.path(), &["simulate", "machine.mo", "--output", "run.parquet"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let bytes = std::fs::read(folder.path().join("run.parquet")).expect("a file");
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    let ended = mocc(folder.path(), &["simulate", "machine.mo", "--output", "run.xlsx"]);
    assert_eq!(ended.status, 2);
    let message = "results can be written as .csv, .parquet or .mat, not as `run.xlsx`";
    assert!(ended.err.contains(message), "{}", ended.err);
    assert!(!folder.path().join("run.xlsx").exists());
}

#[test]
fn a_filter_holds_for_parameters_too() {
    let folder = Scratch::new();
    folder.file("machine.mo", &machine_model());
    let arguments =
        ["simulate", "machine.mo", "--output", "run.mat", "--variables", "^(other|m|same)$"];
    let ended = mocc(folder.path(), &arguments);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let mat = Matrices::read(&folder.path().join("run.mat"));
    let names: Vec<String> = mat.places().into_iter().map(|p| p.0).collect();
    assert_eq!(names, ["time", "m", "same", "other"]);
    let (same, other) = (mat.values("same"), mat.values("other"));
    assert!(same.iter().zip(&other).all(|(a, b)| *a == -b) && same[0] == 1.0);
}

#[test]
fn a_run_without_states_has_no_steps() {
    let folder = Scratch::new();
    folder.file("wave.mo", "model Wave Real y = sin(time); end Wave;");
    let ended = mocc(folder.path(), &["simulate", "wave.mo", "--output", "run.csv"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(
        ended.out.contains("0 events, 501 rows") && !ended.out.contains("steps"),
        "{}",
        ended.out
    );
}

#[test]
fn an_impact_is_one_event() {
    // The relation turns back by the `reinit` of its own event.
    let folder = Scratch::new();
    let example = format!("{}/examples/bouncing_ball.mol", env!("CARGO_MANIFEST_DIR"));
    let ended = mocc(folder.path(), &["simulate", &example, "--events", "--output", "run.csv"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let events: Vec<&str> = ended.out.lines().filter(|l| l.starts_with("event")).collect();
    // The k-th impact is at t_1 (1 + 2 (e + ... + e^(k-1))) with t_1 = sqrt(2 h/g).
    let first = (2.0_f64 / 9.81).sqrt();
    let mut at = first;
    for k in 1..=6 {
        let found: f64 = events[k - 1].split(' ').nth(2).expect("a time").parse().expect("a time");
        assert!((found - at).abs() < 1e-6, "{found} instead of {at}");
        at += 2.0 * first * 0.8_f64.powi(k as i32);
    }
    assert!(at > 3.0 && events.len() == 6, "{events:?}");
    assert!(ended.out.contains("6 events"), "{}", ended.out);
}

#[test]
fn a_relation_that_is_seen_to_turn_back_is_two_events() {
    let folder = Scratch::new();
    let model = &suite_model("simulate/events/ball_results");
    folder.file("ball.mo", model);
    let arguments = ["simulate", "ball.mo", "--stop", "0.6", "--events", "--output", "run.csv"];
    let ended = mocc(folder.path(), &arguments);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.out.contains("2 events"), "{}", ended.out);
}

/// A step that takes longer than anyone waits: a second SIGINT ends the process, and no result has a name.
#[cfg(unix)]
#[test]
fn a_second_interrupt_ends_a_long_step() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let folder = Scratch::new();
    folder.file("slow.mo", SLOW);
    let mut command = Command::new(env!("CARGO_BIN_EXE_mocc"));
    command.current_dir(folder.path()).args(["simulate", "slow.mo", "--output", "slow.csv"]);
    let running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut running = running.expect("mocc starts");
    let files = || {
        let files = std::fs::read_dir(folder.path()).expect("a folder").flatten();
        files.into_iter().map(|f| f.file_name().to_string_lossy().into_owned()).collect::<Vec<_>>()
    };
    // The temporary file is there before the handler is.
    while !files().iter().any(|name| name.ends_with(".part")) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let pid = running.id().to_string();
    let interrupt = || {
        std::thread::sleep(Duration::from_millis(400));
        let sent = Command::new("kill").args(["-INT", &pid]).status().expect("kill is there");
        assert!(sent.success());
    };
    interrupt();
    std::thread::sleep(Duration::from_millis(400));
    assert!(running.try_wait().expect("a state").is_none(), "the step goes on");
    interrupt();
    let ended = running.wait_with_output().expect("an end");
    assert_eq!(ended.status.code(), Some(130));
    assert!(!files().contains(&"slow.csv".to_owned()), "{:?}", files());
}

/// The right side takes minutes.
const SLOW: &str = "
model Slow
  function work
    input Real u;
    input Real n;
    output Real y;
  protected
    Real i;
    Real j;
  algorithm
    y := 0;
    i := 0;
    while i < n loop
      j := 0;
      while j < n loop
        y := y + sin(u*i*j);
        j := j + 1;
      end while;
      i := i + 1;
    end while;
  end work;
  parameter Real n = 2e5;
  Real x(start = 0, fixed = true);
equation
  der(x) = work(time, n + time);
end Slow;
";

/// SIGINT ends a run after its step; what was computed is in a file of its own name.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_valid_files() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let folder = Scratch::new();
    // Millions of steps of an oscillator: no machine gets to their end in a moment.
    let model = &suite_model("simulate/events/long_results");
    folder.file("long.mo", model);
    for output in ["run.csv", "run.mat", "run.parquet"] {
        let path = folder.path().join(output);
        let mut command = Command::new(env!("CARGO_BIN_EXE_mocc"));
        command.current_dir(folder.path()).args(["simulate", "long.mo", "--output", output]);
        let running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let running = running.expect("mocc starts");
        let temporary = || {
            let files = std::fs::read_dir(folder.path()).expect("a folder").flatten();
            files.into_iter().any(|f| f.file_name().to_string_lossy().ends_with(".part"))
        };
        // The temporary file is there before the handler is.
        while !temporary() {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(300));
        let pid = running.id().to_string();
        let sent = Command::new("kill").args(["-INT", &pid]).status().expect("kill is there");
        assert!(sent.success());
        let ended = running.wait_with_output().expect("an end");
        let out = String::from_utf8_lossy(&ended.stdout);
        assert_eq!(ended.status.code(), Some(130), "{out}");
        assert_eq!(String::from_utf8_lossy(&ended.stderr), "");
        assert!(out.contains("interrupted at ") && out.contains(output), "{out}");
        assert!(!temporary(), "the temporary file has become the result");
        match output {
            "run.csv" => {
                let table = read_csv(&path).expect("a valid table");
                assert!(table.rows() >= 1 && table.verify().is_ok());
            }
            "run.mat" => {
                let mat = Matrices::read(&path);
                let (height, all) = mat.doubles("data_2");
                assert!(!all.is_empty() && all.len() % height == 0);
                let (constants, fixed) = mat.doubles("data_1");
                assert!(all[all.len() - height] <= fixed[constants] && fixed[constants] < 1e9);
            }
            _ => {
                let bytes = std::fs::read(&path).expect("a file");
                assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
            }
        }
    }
}
