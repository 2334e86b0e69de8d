//! The command line: options, files, exit statuses.

use std::path::Path;

use mocc::io::csv::read_csv;

use super::door::{Case, Reading, Scratch, suite_model};
use super::program::{command, mocc};

/// A model with a parameter of each type and an array whose size is one.
fn shop_model() -> String {
    suite_model("driver/requests/shop")
}

/// A folder with the model in it.
fn shop() -> Scratch {
    let scratch = Scratch::new();
    scratch.file("shop.mo", &shop_model());
    scratch
}

fn files(folder: &Path) -> Vec<String> {
    let list = std::fs::read_dir(folder).expect("a folder").flatten();
    let mut names: Vec<String> =
        list.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn example(name: &str) -> String {
    format!("{}/examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_default_run_writes_a_table_and_a_picture_where_it_runs() {
    let folder = Scratch::new();
    let ended = mocc(folder.path(), &["simulate", &example("valve52.mol")]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert_eq!(files(folder.path()), ["valve52.csv", "valve52.svg"]);
    for word in ["13 states", "15 events", "steps", " ms", "valve52.csv", "valve52.svg"] {
        assert!(ended.out.contains(word), "no `{word}` in:\n{}", ended.out);
    }
    let csv = std::fs::read_to_string(folder.path().join("valve52.csv")).expect("a table");
    assert!(csv.starts_with("time,"), "{}", csv.lines().next().unwrap_or_default());
    assert!(csv.lines().next().is_some_and(|h| h.contains(",seal_12.friction.f_slide,")));
    let svg = std::fs::read_to_string(folder.path().join("valve52.svg")).expect("a picture");
    for name in ["p14", "p12", "p2", "p4"] {
        assert!(svg.lines().any(|l| l.trim() == name), "the picture does not name `{name}`");
    }
}

#[test]
fn the_table_reads_back_to_the_bit() {
    let folder = Scratch::new();
    let ended = mocc(folder.path(), &["simulate", &example("valve52.mol"), "--output", "v.csv"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert_eq!(files(folder.path()), ["v.csv"]);
    let run = Case::file("examples/valve52.mol").run();
    let table = read_csv(folder.path().join("v.csv")).expect("a table");
    assert_eq!(table.rows(), run.rows());
    assert_eq!(table.columns.len(), run.columns.len());
    for (k, column) in run.columns.iter().enumerate() {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&run.data[k]), bits(table.of(&column.name)), "{}", column.name);
    }
    // Each event is two rows at its time; at its grid point one row for every 0.1 ms.
    for event in &run.events {
        assert_eq!(table.time.iter().filter(|t| **t == event.time).count(), 2, "{event:?}");
    }
    for k in 0..=1200 {
        let t = f64::from(k) * 1e-4;
        assert!(table.time.iter().any(|x| (x - t).abs() < 1e-12), "no row at {t} s");
    }
}

#[test]
fn events_are_listed_on_demand() {
    let folder = Scratch::new();
    let path = example("bouncing_ball.mol");
    let ended = mocc(folder.path(), &["simulate", &path, "--events", "--output", "b.csv"]);
    assert_eq!(ended.status, 0);
    let first = ended.out.lines().find(|l| l.starts_with("event at ")).expect("an event");
    assert!(first.starts_with("event at 0.451523641 s: h <= 0.0 became true"), "{first}");
    assert_eq!(ended.out.matches("became true").count(), 6);
    assert!(first.contains("bouncing_ball.mol:16:3"), "{first}");
}

#[test]
fn what_is_written_follows_the_options() {
    let folder = shop();
    let run = |arguments: &[&str]| {
        let mut all = vec!["simulate", "shop.mo"];
        all.extend(arguments);
        let ended = mocc(folder.path(), &all);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{arguments:?}");
    };
    run(&["--output", "only.csv"]);
    assert_eq!(files(folder.path()), ["only.csv", "shop.mo"]);
    run(&["--plot", "a.svg", "--show", "part[1].x,out"]);
    run(&["--plot", "b.png"]);
    assert_eq!(files(folder.path()), ["a.svg", "b.png", "only.csv", "shop.mo"]);
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).expect("a picture");
    assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"));
    assert!(svg.contains("part[1].x") && !svg.contains("part[2].x"));
    let png = std::fs::read(folder.path().join("b.png")).expect("a picture");
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    run(&["--output", "both.csv", "--plot", "both.svg"]);
    run(&[]);
    assert_eq!(files(folder.path()).len(), 8);
    assert!(folder.path().join("shop.csv").exists() && folder.path().join("shop.svg").exists());
}

#[test]
fn settings_of_each_type() {
    let folder = shop();
    let run = |settings: &[&str]| {
        let mut all = vec!["simulate", "shop.mo", "--output", "o.csv"];
        settings.iter().for_each(|s| all.extend(["--set", s]));
        let ended = mocc(folder.path(), &all);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{settings:?}");
        read_csv(folder.path().join("o.csv")).expect("a table")
    };
    let plain = run(&[]);
    assert_eq!((plain.last("out"), plain.columns.len()), (1.0, 5));
    assert_eq!(run(&["gain=2.5e-1"]).last("out"), 0.25);
    assert_eq!(run(&["running=false"]).last("out"), 0.0);
    assert_eq!(run(&["kind=Kind.Fast"]).last("out"), 10.0);
    assert_eq!(run(&["kind=Shop.Kind.Fast", "gain=3"]).last("out"), 30.0);
    let larger = run(&["n=4", "part[3].rate=2"]);
    assert!((larger.last("part[3].x") - f64::exp(-2.0)).abs() < 1e-7);
    assert!((larger.last("part[4].x") - f64::exp(-1.0)).abs() < 1e-7);
}

#[test]
fn stop_interval_tolerance_and_model() {
    let folder = shop();
    let run = |options: &[&str]| {
        let mut all = vec!["simulate", "shop.mo", "--output", "o.csv"];
        all.extend(options);
        let ended = mocc(folder.path(), &all);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{options:?}");
        (read_csv(folder.path().join("o.csv")).expect("a table"), ended.out)
    };
    assert_eq!(run(&[]).0.rows(), 11);
    let (longer, _) = run(&["--stop", "2", "--interval", "0.5"]);
    assert_eq!(longer.time, [0.0, 0.5, 1.0, 1.5, 2.0]);
    let exact = f64::exp(-1.0);
    let error = |t: &str| (run(&["--tolerance", t]).0.last("part[1].x") - exact).abs();
    assert!(error("1e-10") < 1e-9 && error("1e-10") < error("1e-2"));
    let (other, _) = run(&["--model", "Shop.Other"]);
    assert_eq!(other.last("y"), 7.0);
}

/// A loop `z + z^3 = 0.625 x` is solved by the model or by the integrator, with the same result; but no
/// explicit method can solve it.
#[test]
fn modes() {
    let folder = Scratch::new();
    let text = &suite_model("driver/requests/loop");
    folder.file("loop.mo", text);
    let part = ["simulate", "loop.mo", "--tolerance", "1e-9"];
    let mut ends = Vec::new();
    for (mode, said) in [("reduced", "1 states, "), ("dae", "1 states and 1 algebraic unknowns")] {
        let ended = mocc(folder.path(), &[&part[..], &["--mode", mode]].concat());
        assert_eq!((ended.status, ended.err.as_str()), (0, ""));
        assert!(ended.out.contains(said), "{}", ended.out);
        let table = read_csv(folder.path().join("loop.csv")).expect("a table");
        ends.push(["x", "z"].map(|name| *table.values(name).expect("a column").last().unwrap()));
    }
    let [[x, z], [other, _]] = ends[..] else { panic!("{ends:?}") };
    assert!((z.powi(3) + z - 0.625 * x).abs() < 1e-8);
    assert!((x - other).abs() < 1e-7, "{x} and {other}");
    let explicit = [&part[..], &["--mode", "dae", "--method", "dopri"]].concat();
    let refused = mocc(folder.path(), &explicit);
    assert_eq!(refused.status, 2);
    assert!(refused.err.contains("dopri is explicit"), "{}", refused.err);
}

/// Every method comes to `exp(-1)` within the tolerance, and the summary names it.
#[test]
fn methods() {
    let folder = shop();
    let part = ["simulate", "shop.mo", "--model", "Shop.Part", "--tolerance", "1e-8"];
    let methods = [
        ("auto", "by dopri (auto: 1 state, no events, not stiff)"),
        ("radau", "by radau,"),
        ("bdf", "by bdf,"),
        ("dopri", "by dopri,"),
    ];
    for (method, said) in methods {
        let ended = mocc(folder.path(), &[&part[..], &["--method", method]].concat());
        assert_eq!((ended.status, ended.err.as_str()), (0, ""));
        assert!(ended.out.contains(said), "{}", ended.out);
        let table = read_csv(folder.path().join("shop.csv")).expect("a table");
        let x = table.values("x").expect("a column");
        let error = x[x.len() - 1] - (-1.0_f64).exp();
        assert!(error.abs() < 1e-8, "{method}: {error}");
    }
    let ended = mocc(folder.path(), &["simulate", &example("oscillator.mol"), "--method", "bdf"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
}

#[test]
fn libraries_are_found_by_option_and_by_environment() {
    let folder = Scratch::new();
    folder.file("libraries/Hall/package.mo", "within;\npackage Hall\nend Hall;\n");
    folder.file(
        "libraries/Hall/Lamp.mo",
        "within Hall;\nmodel Lamp\n  parameter Real P = 60;\n  Real heat = P;\nend Lamp;\n",
    );
    folder.file("libraries/Single.mo", "model Single\n  Real x = 3;\nend Single;\n");
    folder.file("use.mo", "model Use\n  Hall.Lamp lamp(P = 40);\n  Single one;\nend Use;\n");
    let alone = mocc(folder.path(), &["flatten", "use.mo"]);
    assert_eq!(alone.status, 1);
    assert!(alone.err.contains("there is no class `Hall.Lamp`"), "{}", alone.err);
    let arguments = ["simulate", "use.mo", "--output", "u.csv", "--lib", "libraries"];
    assert_eq!(mocc(folder.path(), &arguments).status, 0);
    let libraries = folder.path().join("libraries");
    let ended =
        command(folder.path(), &["flatten", "use.mo"], &[("MODELICAPATH", libraries.as_path())]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert!(ended.out.contains("'lamp.P' = 40"), "{}", ended.out);
    // A model of a library needs no file.
    let arguments = ["simulate", "--model", "Hall.Lamp", "--lib", "libraries", "--output", "l.csv"];
    assert_eq!(mocc(folder.path(), &arguments).status, 0);
}

/// A file of a library sees the packages that enclose it, and a `package.mo` the files next to it.
#[test]
fn files_of_a_library_belong_to_it() {
    let folder = Scratch::new();
    let root = "within;\npackage Hall\n  constant Real u = 230;\nend Hall;\n";
    folder.file("copies/Hall-main/package.mo", root);
    folder.file("Hall 2.0/package.mo", root);
    for place in ["copies/Hall-main", "Hall 2.0"] {
        let parts = "within Hall;\npackage Parts\n  model Pair\n    Lamp a, b(P = u);\n  end Pair;\nend Parts;\n";
        folder.file(&format!("{place}/Parts/package.mo"), parts);
        folder.file(
            &format!("{place}/Parts/Lamp.mo"),
            "within Hall.Parts;\nmodel Lamp\n  parameter Real P = 60;\n  Real i = P/u;\nend Lamp;\n",
        );
    }
    let good = |from: &str, arguments: &[&str]| {
        let ended = mocc(&folder.path().join(from), arguments);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{arguments:?}");
        ended.out
    };
    good(".", &["check", "Hall 2.0/package.mo"]);
    good(".", &["check", "Hall 2.0/Parts/package.mo"]);
    good("Hall 2.0/Parts", &["check", "package.mo"]);
    let lamp = good("Hall 2.0/Parts", &["flatten", "Lamp.mo"]);
    assert!(lamp.contains("model 'Hall.Parts.Lamp'") && lamp.contains("i = P / 230"), "{lamp}");
    let pair =
        good("Hall 2.0", &["flatten", "./Parts/../Parts/package.mo", "--model", "Parts.Pair"]);
    assert!(pair.contains("'b.P' = 230"), "{pair}");
    let pair = good("copies", &["flatten", "Hall-main/package.mo", "--model", "Hall.Parts.Pair"]);
    assert!(pair.contains("'b.P' = 230"), "{pair}");
    // In no folder of its packages a file stands for itself, and next to them for the class that it names.
    let other = "within Hall.Parts;\nmodel Lamp\n  Real i = 1;\nend Lamp;\n";
    folder.file("alone/Lamp.mo", other);
    assert!(good("alone", &["flatten", "Lamp.mo"]).contains("model Lamp"));
    folder.file("Lamp.mo", other);
    let lamp = good(".", &["flatten", "Lamp.mo"]);
    assert!(lamp.contains("model 'Hall.Parts.Lamp'") && lamp.contains("i = 1.0"), "{lamp}");
}

/// A class in a file of its own belongs to the packages that extend its package, and to those that
/// are another name for it.
#[test]
fn classes_in_files_are_inherited() {
    let folder = Scratch::new();
    let package = "within Hall;\npackage Base\n  constant Real c = 2;\n  function g\n    \
                   input Real x;\n    output Real y = Deep.h(x);\n  end g;\nend Base;\n";
    let deep =
        "within Hall.Base.Deep;\nfunction h\n  input Real x;\n  output Real y = 10*c*x;\nend h;\n";
    let function =
        "within Hall.Base;\nfunction f\n  input Real x;\n  output Real y = c*x;\nend f;\n";
    folder.file("libraries/Hall/package.mo", "within;\npackage Hall\nend Hall;\n");
    folder.file("libraries/Hall/Base/package.mo", package);
    folder.file("libraries/Hall/Base/f.mo", function);
    folder.file(
        "libraries/Hall/Base/Deep/package.mo",
        "within Hall.Base;\npackage Deep\nend Deep;\n",
    );
    folder.file("libraries/Hall/Base/Deep/h.mo", deep);
    let user = "model User\n  package Extended\n    extends Hall.Base(c = 5);\n  end Extended;\n  \
                replaceable package Other = Hall.Base;\n  Real a = Extended.f(time);\n  \
                Real b = Other.f(time);\n  Real d = Extended.g(time);\n  \
                Real e = Other.g(time);\nend User;\n";
    folder.file("user.mo", user);
    let arguments = ["simulate", "user.mo", "--output", "u.csv", "--lib", "libraries"];
    let ended = mocc(folder.path(), &arguments);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let table = read_csv(folder.path().join("u.csv")).expect("a table");
    let last = |name: &str| *table.values(name).expect("a column").last().expect("a row");
    assert_eq!((last("a"), last("b")), (5.0, 2.0));
    assert_eq!((last("d"), last("e")), (50.0, 20.0));
}

/// The version that `uses` asks for is taken, else the newest; another one is warned of unless it serves.
#[test]
fn libraries_come_in_the_version_that_is_asked_for() {
    let folder = Scratch::new();
    let library = |version: &str, more: &str| {
        let annotation = format!("annotation(version = \"{version}\"{more})");
        format!("package Hall\n  constant String v = \"{version}\";\n  {annotation};\nend Hall;\n")
    };
    for version in ["2.0.0", "10.0.0"] {
        folder.file(&format!("libraries/Hall {version}/package.mo"), &library(version, ""));
    }
    folder.file("libraries/Hall 9.1.mo", &library("9.1", ""));
    let serving = library("3.1.0", ", conversion(noneFromVersion = \"3.0.0\")");
    folder.file("libraries/Hall/package.mo", &serving);
    let asked = |version: Option<&str>| {
        let uses = version.map(|v| format!("  annotation(uses(Hall(version = \"{v}\")));\n"));
        let text = format!(
            "model Use\n  parameter String v = Hall.v;\n  Real x = 1;\n{}end Use;\n",
            uses.unwrap_or_default()
        );
        folder.file("use.mo", &text);
        let ended = mocc(folder.path(), &["flatten", "use.mo", "--lib", "libraries"]);
        assert_eq!(ended.status, 0, "{}", ended.err);
        let taken = ended.out.split("v = \"").nth(1).and_then(|rest| rest.split('"').next());
        (taken.unwrap_or_default().to_string(), ended.err)
    };
    for (version, taken) in [
        (None, "10.0.0"),
        (Some("2.0.0"), "2.0.0"),
        (Some("9.1"), "9.1"),
        (Some("10.0.0"), "10.0.0"),
        (Some("3.1.0"), "3.1.0"),
        (Some("3.0.0"), "3.1.0"),
    ] {
        assert_eq!(asked(version), (taken.to_string(), String::new()));
    }
    let (taken, said) = asked(Some("4.0.0"));
    assert_eq!(taken, "3.1.0");
    assert!(said.contains("warning[MO0105]: `Hall` 4.0.0 is required, but only 3.1.0"), "{said}");
    assert!(said.contains("use.mo:4:"), "{said}");
}

#[test]
fn flat_text_and_structure_go_to_the_standard_output() {
    let folder = shop();
    let flat = mocc(folder.path(), &["flatten", "shop.mo", "--set", "n=3"]);
    assert_eq!((flat.status, flat.err.as_str()), (0, ""));
    assert!(flat.out.starts_with("model 'Shop.Machine'") && flat.out.contains("'part[3].x'"));
    let structure = mocc(folder.path(), &["structure", "shop.mo"]);
    assert_eq!((structure.status, structure.err.as_str()), (0, ""));
    assert!(structure.out.contains("states (2): part[1].x, part[2].x"), "{}", structure.out);
    assert_eq!(files(folder.path()), ["shop.mo"]);
}

#[test]
fn exit_statuses() {
    let folder = shop();
    folder.file("wrong.mo", "model W\n  Real x = y;\nend W;\n");
    folder.file("pole.mo", "model P\n  Real x = 1/(time - 0.5);\nend P;\n");
    let status = |arguments: &[&str]| mocc(folder.path(), arguments).status;
    assert_eq!(status(&["simulate", "shop.mo"]), 0);
    assert_eq!(status(&["--help"]), 0);
    assert_eq!(status(&["--version"]), 0);
    for command in ["simulate", "flatten", "structure"] {
        assert_eq!(status(&[command, "wrong.mo"]), 1);
        assert_eq!(status(&[command, "shop.mo", "--model", "Shop.None"]), 2);
        assert_eq!(status(&[command, "missing.mo"]), 2);
        assert_eq!(status(&[command, "shop.mo", "--set", "nothing=1"]), 2);
        assert_eq!(status(&[command, "shop.mo", "--set", "gain=true"]), 2);
        assert_eq!(status(&[command]), 2);
    }
    assert_eq!(status(&["simulate", "shop.mo", "--nonsense"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--stop", "soon"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--stop", "-1"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--tolerance", "0"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--interval", "0"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--method", "euler"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--plot", "a.jpg"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--show", "part[9].x"]), 2);
    assert_eq!(status(&["simulate", "shop.mo", "--output", "no/such/folder.csv"]), 2);
    assert_eq!(status(&["simulate", "pole.mo"]), 3);
}

#[test]
fn limits_end_a_command() {
    let folder = shop();
    folder.file(
        "fast.mo",
        "model F\n  Real x(start = 0, fixed = true);\nequation\n  der(x) = 1e5*cos(1e5*time);\nend F;\n",
    );
    let limited = |limit: &[&str]| {
        // Millions of steps, but not so many that the run is hopeless.
        let arguments = [&["simulate", "fast.mo", "--stop", "10"], limit].concat();
        mocc(folder.path(), &arguments)
    };
    let late = limited(&["--max-seconds", "0.3"]);
    assert_eq!(late.status, 1, "{}", late.err);
    assert!(late.err.contains("the limit of 0.3 s is reached"), "{}", late.err);
    assert!(late.err.contains("--max-seconds"), "{}", late.err);
    // Only Linux tells how much memory a process occupies.
    if cfg!(target_os = "linux") {
        let large = limited(&["--max-memory", "0.001"]);
        assert_eq!(large.status, 1, "{}", large.err);
        assert!(large.err.contains("of memory is reached"), "{}", large.err);
    }
}

#[test]
fn of_thousands_of_errors_the_first_are_shown() {
    let folder = shop();
    let unknown: String = (0..20_000).map(|i| format!("  Lost x{i};\n")).collect();
    folder.file("lost.mo", &format!("model L\n{unknown}end L;\n"));
    let ended = mocc(folder.path(), &["check", "lost.mo", "--max-seconds", "100"]);
    assert_eq!(ended.status, 1);
    assert_eq!(ended.err.matches("error[MO0201]").count(), 200);
    assert!(ended.err.contains("19800 further problems are not shown"));
}

#[test]
fn requests_that_cannot_be_met_are_explained() {
    let folder = shop();
    folder.file("latin.mo", "model A\nend A;\n");
    std::fs::write(folder.path().join("latin.mo"), b"model A \"Gr\xf6\xdfe\"\nend A;\n")
        .expect("a writable folder");
    folder.file("empty.mo", "");
    let said = |arguments: &[&str]| {
        let ended = mocc(folder.path(), arguments);
        format!("$ mocc {}\n{}[{}]\n", arguments.join(" "), ended.err, ended.status)
    };
    let all = [
        said(&["simulate", "shpo.mo"]),
        said(&["simulate", "elsewhere/valve.mo"]),
        said(&["simulate", "latin.mo"]),
        said(&["simulate", "empty.mo"]),
        said(&["simulate", "shop.mo", "--show", "part[1].z"]),
        said(&["simulate", "shop.mo", "--plot", "a.jpg"]),
    ];
    for text in &all {
        assert!(text.contains("error"), "{text}");
    }
    insta::assert_snapshot!("requests", all.join("\n"));
}

#[test]
fn a_failed_run_leaves_an_existing_result_as_it_was() {
    let folder = Scratch::new();
    folder.file("late.mo", "model L\n  Real x = sqrt(0.5 - time);\nend L;\n");
    folder.file("old.csv", "time,x\n0,1\n");
    folder.file("old.svg", "<svg/>");
    let arguments = ["simulate", "late.mo", "--output", "old.csv", "--plot", "old.svg"];
    assert_eq!(mocc(folder.path(), &arguments).status, 3);
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
    assert_eq!((text("old.csv").as_str(), text("old.svg").as_str()), ("time,x\n0,1\n", "<svg/>"));
    assert_eq!(files(folder.path()), ["late.mo", "old.csv", "old.svg"]);
    // What cannot be drawn is refused before the table is written.
    folder.file("fine.mo", "model F\n  Real x = time;\nend F;\n");
    let arguments =
        ["simulate", "fine.mo", "--output", "old.csv", "--plot", "p.svg", "--show", "y"];
    assert_eq!(mocc(folder.path(), &arguments).status, 2);
    assert_eq!(text("old.csv"), "time,x\n0,1\n");
}

#[test]
fn structural_settings_of_the_valve_act_before_flattening() {
    let folder = Scratch::new();
    let path = example("valve52.mol");
    let free = "seal_45.contact=Seals.Contact.CloseOnly";
    let ended = mocc(folder.path(), &["simulate", &path, "--set", free, "--output", "o.csv"]);
    // The library asks for a control edge where a seal opens a flow path.
    assert_eq!(ended.status, 1, "{}", ended.err);
    assert!(
        ended.err.contains("a seal that opens a flow path has a control edge"),
        "{}",
        ended.err
    );
    let rod = "seal_a.contact=Seals.Contact.Free";
    let ended = mocc(folder.path(), &["simulate", &path, "--set", rod, "--output", "o.csv"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let table = read_csv(folder.path().join("o.csv")).expect("a table");
    assert_eq!(table.at("s", 0.05), 3.5e-3);
    let usual = Case::file("examples/valve52.mol").run();
    let (free, usual) = (table.of("spool.f_static")[0], usual.first("spool.f_static"));
    assert!(free < usual, "a seal that never touches holds {free} N instead of {usual} N");
}

#[test]
fn the_structure_is_drawn_on_demand() {
    let folder = Scratch::new();
    let model = example("valve52.mol");
    let arguments = ["structure", &model, "--svg", "v.svg", "--dot", "v.dot"];
    let ended = mocc(folder.path(), &arguments);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert_eq!(ended.out, "wrote v.dot\nwrote v.svg\n");
    let svg = std::fs::read_to_string(folder.path().join("v.svg")).expect("a picture");
    let dot = std::fs::read_to_string(folder.path().join("v.dot")).expect("a graph");
    // The same blocks as in the text: each is a node of the graph.
    let text = mocc(folder.path(), &["structure", &model]).out;
    let (_, between) = text.split_once("between events: ").expect("a sequence");
    let blocks: usize = between.split(' ').next().and_then(|n| n.parse().ok()).expect("a number");
    assert_eq!(dot.matches("fillcolor").count(), blocks);
    assert!(svg.contains(&format!(" in {blocks} blocks<")));
    for torn in ["p12", "p14"] {
        assert!(between.contains(&format!("torn to 1: {torn}")) && svg.contains(torn), "{torn}");
    }
    let ended = mocc(folder.path(), &["structure", &model, "--svg", "none/v.svg"]);
    assert_eq!((ended.status, ended.out.as_str()), (2, ""));
}

/// Nobody reads the messages, but the status tells.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_the_messages_is_no_bug() {
    let scratch = Scratch::new();
    let file = scratch.file("model.mo", "model M\n  Real x = y;\nend M;\n");
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
    for (arguments, status) in [(["check"], 1), (["flatten"], 1)] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_mocc"));
        command.current_dir(scratch.path()).args(arguments).arg(&file).stderr(full());
        assert_eq!(command.status().expect("mocc starts").code(), Some(status), "{arguments:?}");
    }
    let fine = scratch.file("fine.mo", "model M\n  Real x = time;\nend M;\n");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_mocc"));
    command.current_dir(scratch.path()).arg("flatten").arg(&fine).stdout(full());
    assert_eq!(command.output().expect("mocc starts").status.code(), Some(2));
}

/// A large flat model is printed by two threads; a sum is nested as deeply as it has terms.
#[test]
fn a_long_sum_of_a_large_model_is_printed() {
    let scratch = Scratch::new();
    let model = "model Large\n  Real x[25000] = fill(time, 25000);\n  Real s;\nequation\n  s = sum(x);\nend Large;\n";
    scratch.file("large.mo", model);
    let ended = mocc(scratch.path(), &["flatten", "large.mo"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.out.ends_with("end Large;\n"));
}
