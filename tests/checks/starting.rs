//! The first hour: `mocc new`, `mocc plan`, `mocc lib`, pipes, units, completions.

use std::fs;
use std::path::Path;
use std::process::Command;

use mocc::io::csv::read_csv;

use super::door::Scratch;
use super::program::{Ended, fmu_runtime, mocc, piped};

fn done(folder: &Path, arguments: &[&str]) -> Ended {
    let ended = mocc(folder, arguments);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{arguments:?}\n{}", ended.out);
    ended
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let ended = mocc(folder, arguments);
    assert_eq!(ended.status, 2, "{arguments:?}\n{}{}", ended.out, ended.err);
    ended.err
}

#[test]
fn every_template_is_a_project_that_runs() {
    let folder = Scratch::new();
    for kind in ["valve", "motor", "thermal"] {
        let name = format!("my_{kind}");
        let ended = done(folder.path(), &["new", &name, "--template", kind]);
        assert!(ended.out.contains("mocc.toml"), "{}", ended.out);
        let project = folder.path().join(&name);
        let model = format!("{name}.mol");
        done(&project, &["check", &model]);
        done(&project, &["fmt", "--check", &model]);
        done(&project, &["simulate", &model]);
        let ended = done(&project, &["test"]);
        assert!(ended.out.contains("3 passed, 0 failed"), "{}", ended.out);
        let text = fs::read_to_string(project.join(&model)).expect("the model");
        let title = format!("model My{}{} ", kind[..1].to_uppercase(), &kind[1..]);
        assert!(text.starts_with(&title), "{}", &text[..40]);
        // Each file of the README exists.
        let readme = fs::read_to_string(project.join("README.md")).expect("a README");
        for file in readme.lines().filter_map(|l| l.strip_prefix("| `")?.split('`').next()) {
            assert!(project.join(file).exists(), "{name}/{file}");
        }
    }
    let project = folder.path().join("my_motor");
    let ended = mocc(&project, &["calibrate", "my_motor.toml"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.out.contains("converged"), "{}", ended.out);
    assert!(refused(folder.path(), &["new", "my_motor"]).contains("exists already"));
    assert!(refused(folder.path(), &["new", "7up"]).contains("a letter first"));
    assert!(
        refused(folder.path(), &["new", "x", "--template", "boat"])
            .contains("valve, motor, thermal")
    );
}

#[test]
fn a_plan_is_guessed_and_calibrates() {
    let folder = Scratch::new();
    for kind in ["motor", "thermal"] {
        done(folder.path(), &["new", kind, "--template", kind]);
        let project = folder.path().join(kind);
        let model = format!("{kind}.mol");
        done(&project, &["plan", &model, "recordings", "--output", "guess.toml"]);
        let plan = fs::read_to_string(project.join("guess.toml")).expect("a plan");
        assert!(!plan.contains('?'), "everything is recognised:\n{plan}");
        for part in ["table = \"experiments.csv\"", "split = \"split\"", "[conditions]", "[free]"] {
            assert!(plan.contains(part), "no `{part}` in\n{plan}");
        }
        let ended = mocc(&project, &["calibrate", "guess.toml", "--no-profiles"]);
        assert_eq!(ended.status, 0, "{}\n{plan}", ended.err);
    }
    let motor = folder.path().join("motor");
    assert!(refused(&motor, &["plan", "motor.mol", "none"]).contains("cannot read none"));
    assert!(refused(&motor, &["plan", "motor.mol", "."]).contains("there is no recording"));
    let err = refused(&motor, &["plan", "motor.mol", "recordings", "--output", "motor.toml"]);
    assert!(err.contains("exists already"), "{err}");
}

#[test]
fn the_library_can_be_listed_read_and_copied() {
    let folder = Scratch::new();
    let path = folder.path();
    let ended = done(path, &["lib", "list"]);
    assert!(
        ended.out.lines().any(|l| l.starts_with("Seals ") && l.contains("package")),
        "{}",
        ended.out
    );
    let ended = done(path, &["lib", "list", "Seals"]);
    assert!(
        ended.out.contains("Seals.FlowSeal") && ended.out.contains("Seal at a control edge"),
        "{}",
        ended.out
    );
    let ended = done(path, &["lib", "show", "Seals.FlowSeal"]);
    assert!(
        ended.out.starts_with("// lib/Seals/FlowSeal.mo:1\nwithin Seals;\nmodel FlowSeal"),
        "{}",
        ended.out
    );
    let ended = done(path, &["lib", "show", "Units.Temperature"]);
    assert!(ended.out.lines().count() < 5 && ended.out.contains("unit = \"K\""), "{}", ended.out);
    done(path, &["lib", "copy", "copied"]);
    let copied = fs::read_to_string(path.join("copied/Seals/FlowSeal.mo")).expect("a copy");
    let own =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("lib/Seals/FlowSeal.mo"));
    assert_eq!(Some(copied), own.ok());
    assert!(refused(path, &["lib", "copy", "copied"]).contains("exists already"));
    assert!(
        refused(path, &["lib", "show", "Seals.FlowSea"]).contains("did you mean `Seals.FlowSeal`?")
    );
    assert!(refused(path, &["lib", "list", "--lib", "none"]).contains("there is no folder `none`"));
}

#[test]
fn settings_of_a_project_name_libraries() {
    let folder = Scratch::new();
    folder.file("lib/Own/package.mo", "package Own\n  constant Real two = 2;\nend Own;\n");
    folder.file("models/m.mo", "model M\n  Real x = Own.two*time;\nend M;\n");
    assert_eq!(mocc(folder.path(), &["check", "models/m.mo"]).status, 1);
    folder.file("mocc.toml", "libraries = [\"lib\"]\n");
    done(folder.path(), &["check", "models/m.mo"]);
    folder.file("mocc.toml", "librarie = [\"lib\"]\n");
    let err = refused(folder.path(), &["check", "models/m.mo"]);
    assert!(err.contains("error[MO1402]") && err.contains("did you mean `libraries`?"), "{err}");
}

const DECAY: &str = "model Decay
  parameter Real p(unit = \"Pa\") = 2e5;
  constant Real tau(unit = \"s\") = 1;
  Real q(unit = \"Pa\", start = p, fixed = true);
equation
  der(q) = -q/tau;
end Decay;
";

#[test]
fn models_and_results_go_through_pipes() {
    let folder = Scratch::new();
    let path = folder.path();
    let ended = piped(path, &["simulate", "-", "--output", "-", "--quiet"], DECAY);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let mut lines = ended.out.lines();
    assert_eq!(lines.next(), Some("time,q,der(q)"));
    assert_eq!(lines.next(), Some("0.0,200000.0,-200000.0"));
    let mat = piped(path, &["simulate", "-", "--output", "-", "--format", "csv"], DECAY);
    assert!(mat.err.starts_with("Decay: 1 states"), "the summary is no result: {}", mat.err);
    assert_eq!(piped(path, &["check", "-"], DECAY).status, 0);
    assert!(piped(path, &["flatten", "-"], DECAY).out.starts_with("model Decay"));
    let ended = piped(path, &["check", "-"], &DECAY.replace("-q/", "-r/"));
    assert!(ended.status == 1 && ended.err.contains("stdin.mo:6"), "{}", ended.err);
    let ended = piped(path, &["fmt", "-"], "model A\nReal x=1;\nend A;\n");
    assert_eq!((ended.status, ended.out.as_str()), (0, "model A\n  Real x = 1;\nend A;\n"));
    let ended = piped(path, &["fmt", "-", "--quiet"], "model A\nReal x=1;\nend A;\n");
    assert_eq!((ended.status, ended.out.as_str()), (0, "model A\n  Real x = 1;\nend A;\n"));
    assert!(piped(path, &["flatten", "-", "-q"], DECAY).out.starts_with("model Decay"));
    let warned = DECAY
        .replace("equation", "  Real unused = 2*z;\n  Real z(unit=\"furlong\") = 1;\nequation");
    assert!(piped(path, &["check", "-"], &warned).err.contains("warning"));
    assert_eq!(piped(path, &["check", "-", "-q"], &warned).err, "");
    assert_eq!(piped(path, &["report", "-", "-q", "-o", "r.html"], &warned).err, "");
    fs::remove_file(path.join("r.html")).expect("the page");
    let drawn = piped(path, &["plot", "-", "--output", "p.svg"], "t,a,b\n0,1,2\n1,2,5\n");
    assert_eq!(drawn.status, 0, "{}", drawn.err);
    assert!(path.join("p.svg").exists());
    let err = piped(path, &["simulate", "-", "--output", "-", "--format", "xls"], DECAY).err;
    assert!(err.contains(".csv, .parquet or .mat"), "{err}");
    assert_eq!(fs::read_dir(path).expect("a folder").count(), 1, "pipes leave no files");
}

#[test]
fn a_table_alone_is_drawn() {
    let folder = Scratch::new();
    folder.file("run.csv", "time,part.z,a,constant,b\n0,1,1,7,2\n1,2,2,7,5\n");
    let ended = done(folder.path(), &["plot", "run.csv"]);
    assert_eq!(ended.out, "wrote run.svg\n");
    let svg = fs::read_to_string(folder.path().join("run.svg")).expect("a picture");
    let has = |label: &str| svg.lines().any(|l| l.trim() == label);
    assert!(has("a") && has("b") && has("time"), "{svg}");
    assert!(!has("constant") && !has("part.z"), "{svg}");
    done(folder.path(), &["plot", "run.csv", "--x", "a", "--y", "part.z", "--output", "over.svg"]);
    assert!(
        refused(folder.path(), &["plot", "run.csv", "--output", "x.pdf"]).contains(".svg or .png")
    );
}

#[test]
fn values_have_units() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file("decay.mo", DECAY);
    done(
        path,
        &["simulate", "decay.mo", "--set", "p=3 bar", "--unit", "q=mbar", "--output", "r.csv"],
    );
    let table = fs::read_to_string(path.join("r.csv")).expect("a table");
    assert!(table.lines().nth(1).expect("a row").starts_with("0.0,3000.0,-300000.0"), "{table}");
    let run = |more: &[&str]| {
        let mut all = vec!["simulate", "decay.mo", "--output", "r.csv"];
        all.extend(more);
        refused(path, &all)
    };
    assert!(run(&["--set", "p=3 baar"]).contains("error[MO1410]: unknown unit `baar`"));
    assert!(run(&["--set", "p=3 mm"]).contains("error[MO1411]: cannot convert `mm` to `Pa`"));
    assert!(run(&["--unit", "q=mm"]).contains("`q` is in `Pa`, which `mm` does not measure"));
    let twice = run(&["--unit", "q=bar", "--unit", "q=kPa"]);
    assert!(twice.contains("`q` is wanted in `bar` and in `kPa`"), "{twice}");
    assert!(run(&["--unit", "qq=bar"]).contains("no variable `qq`"));
    assert!(run(&["--unit", "q"]).contains("NAME=UNIT"));
}

#[test]
fn a_run_is_summarised_for_programs() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file("decay.mo", DECAY);
    let ended = done(path, &["simulate", "decay.mo", "--json", "--measure", "t = when(q < 1e5)"]);
    let json: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!(
        (&json["model"], &json["end"], &json["states"]),
        (&"Decay".into(), &1.0.into(), &1.into())
    );
    let t = json["measures"]["t"]["value"].as_f64().expect("a time");
    assert!((t - f64::ln(2.0)).abs() < 1e-5, "{t}");
    assert_eq!(json["files"][0], "decay.csv");
    assert!(json["statistics"]["steps"].as_u64().is_some_and(|n| n > 3), "{json}");
    let quiet = done(path, &["simulate", "decay.mo", "-q", "--measure", "e = final(q)"]);
    assert!(quiet.out.starts_with("  e = ") && quiet.out.lines().count() == 1, "{}", quiet.out);
    let verbose = done(path, &["simulate", "decay.mo", "-v"]);
    assert!(
        verbose.out.contains("  flatten: ") && verbose.out.contains("  codegen: "),
        "{}",
        verbose.out
    );
    assert!(refused(path, &["simulate", "decay.mo", "-q", "-v"]).contains("cannot be used with"));
    for (flag, name) in [("--plot", "a.pdf"), ("--output", "a.xls")] {
        refused(path, &["simulate", "decay.mo", flag, name]);
    }
    assert!(refused(path, &["report", "decay.mo", "--output", "page.txt"]).contains(".html"));
}

#[test]
fn shells_and_man_know_the_commands() {
    let folder = Scratch::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let ended = done(folder.path(), &["completions", shell]);
        assert!(ended.out.contains("simulate") && ended.out.contains("linearize"), "{shell}");
    }
    refused(folder.path(), &["completions", "cmd"]);
    done(folder.path(), &["man", "man1"]);
    let page = fs::read_to_string(folder.path().join("man1/mocc-simulate.1")).expect("a page");
    assert!(page.contains("tolerance") && page.contains(".TH mocc"), "{page}");
    assert!(folder.path().join("man1/mocc-lib-show.1").exists());
}

#[test]
fn a_project_has_a_method_and_a_tolerance() {
    let folder = Scratch::new();
    let path = folder.path();
    let model = "model D Real q(start = 1, fixed = true); equation der(q) = -q; end D;";
    folder.file("d.mo", model);
    folder.file("mocc.toml", "method = \"bdf\"\ntolerance = 1e-3\n");
    let steps = |arguments: &[&str]| -> (String, u64) {
        let ended = done(path, &[&["simulate", "d.mo", "--json"], arguments].concat());
        let json: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
        let of = &json["statistics"];
        (of["method"].as_str().expect("a method").to_owned(), of["steps"].as_u64().expect("steps"))
    };
    let (method, coarse) = steps(&[]);
    assert!(method.starts_with("bdf"), "{method}");
    assert!(steps(&["--tolerance", "1e-9"]).1 * 2 > 3 * coarse, "the flag precedes");
    assert!(steps(&["--method", "dopri"]).0.starts_with("dopri"));
    // The tolerance of the model precedes that of the project.
    folder.file("d.mo", &model.replace("end D", "annotation(experiment(Tolerance = 1e-9)); end D"));
    assert!(steps(&[]).1 * 2 > 3 * coarse);
    folder.file("mocc.toml", "method = \"euler\"\n");
    assert!(refused(path, &["simulate", "d.mo"]).contains("MO1403"));
}

#[test]
fn rows_of_a_sweep_are_grouped_by_any_column() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file("t.csv", "run,p,law,t\n1,1,soft,3\n2,2,soft,4\n3,1,hard,5\n4,2,hard,7\n");
    done(path, &["plot", "t.csv", "--x", "p", "--y", "t", "--by", "law", "--output", "law.svg"]);
    let text = fs::read_to_string(path.join("law.svg")).expect("a picture");
    assert!(text.contains("law = soft") && text.contains("law = hard"), "a curve for each");
    done(path, &["plot", "t.csv", "--x", "run", "--y", "t", "--by", "p", "--output", "p.svg"]);
    let arguments = ["plot", "t.csv", "--x", "p", "--y", "t", "--by", "q", "--output", "q.svg"];
    assert!(refused(path, &arguments).contains("t.csv has no column `q`"));
    let rows: String = (0..40).map(|k| format!("{k},{k}\n")).collect();
    folder.file("many.csv", &format!("a,b\n{rows}"));
    assert!(
        refused(path, &["plot", "many.csv", "--by", "a", "--output", "a.svg"])
            .contains("more than 30")
    );
}

#[test]
fn quiet_commands_print_nothing() {
    let folder = Scratch::new();
    let path = folder.path();
    let ended = done(path, &["new", "pump", "--quiet"]);
    assert_eq!((ended.out.as_str(), ended.err.as_str()), ("", ""));
    for arguments in [
        &["test", "pump", "--quiet"][..],
        &["report", "pump/pump.mol", "--output", "r.html", "--quiet"],
        &["simulate", "pump/pump.mol", "--output", "a.csv", "--quiet"],
        &["compare", "a.csv", "a.csv", "--quiet"],
        &["plot", "a.csv", "--quiet"],
        &["sweep", "pump/pump.mol", "--vary", "p_supply=5e5,6e5", "--output", "s.csv", "--quiet"],
        &["calibrate", "pump/pump.toml", "--no-profiles", "--out", "fit", "--quiet"],
        &["doc", "pump/pump.mol", "-o", "pages", "--quiet"],
    ] {
        let ended = done(path, arguments);
        assert_eq!((ended.out.as_str(), ended.err.as_str()), ("", ""), "{arguments:?}");
    }
}

/// Files next to the model that are called like a function and a type of the language are not looked at.
#[test]
fn files_do_not_replace_what_the_language_defines() {
    let folder = Scratch::new();
    folder.file("main.mo", "model Main\n  Real x = sin(time) + delay(1, 1);\nend Main;\n");
    folder.file(
        "sin.mo",
        "function sin\n  input Real u;\n  output Real y = 7;\nalgorithm\n  y := 7;\nend sin;\n",
    );
    folder.file("delay.mo", "model Delay\nend Delay;\n");
    folder.file("Real.mo", "model Real\nend Real;\n");
    let words = ["simulate", "main.mo", "--stop", "1", "-o", "run.csv", "--quiet"];
    let ended = mocc(folder.path(), &words);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let run = fs::read_to_string(folder.path().join("run.csv")).expect("a table");
    let last = run.lines().last().and_then(|row| row.split(',').nth(1)).expect("a row");
    let x: f64 = last.parse().expect("a number");
    assert!((x - (1.0_f64.sin() + 1.0)).abs() < 1e-12, "{x}");
}

/// `Pump` is in `Pump.mo`, and `Parts` in a folder, next to the model.
#[test]
fn classes_next_to_the_model_are_found() {
    let folder = Scratch::new();
    let path = folder.path();
    let part = |name: &str, value: f64| {
        format!("model {name} \"Something\"\n  Real x = {value};\nend {name};\n")
    };
    folder.file("main.mo", "model Main\n  Pump pump;\n  Parts.Valve valve;\nend Main;\n");
    folder.file("Pump.mo", &part("Pump", 1.0));
    fs::create_dir_all(path.join("Parts")).expect("a folder");
    folder.file("Parts/package.mo", "package Parts\nend Parts;\n");
    folder.file("Parts/Valve.mo", &format!("within Parts;\n{}", part("Valve", 2.0)));
    // A file of another model may have the name of a class by chance, and folders are no packages.
    folder.file("pump.mo", &part("Other", 3.0));
    fs::create_dir_all(path.join("data")).expect("a folder");
    let flat = done(path, &["flatten", "main.mo"]).out;
    assert!(flat.contains("'pump.x' = 1") && flat.contains("'valve.x' = 2"), "{flat}");
    let parent = path.parent().expect("a folder");
    let name = format!("{}/main.mo", path.file_name().expect("a name").to_string_lossy());
    assert_eq!(done(parent, &["flatten", &name]).out, flat);
    // The standard input is in the working directory.
    let main = fs::read_to_string(path.join("main.mo")).expect("the model");
    assert_eq!(piped(path, &["flatten", "-"], &main).out, flat);
    // A library that is named comes first.
    fs::create_dir_all(path.join("lib")).expect("a folder");
    folder.file("lib/Pump.mo", &part("Pump", 4.0));
    assert!(done(path, &["flatten", "main.mo", "--lib", "lib"]).out.contains("'pump.x' = 4"));
    // Errors in them are shown with their place.
    folder.file("Pump.mo", "model Pump\n  Real x = y;\nend Pump;\n");
    let ended = mocc(path, &["check", "main.mo"]);
    assert!(ended.status == 1 && ended.err.contains("Pump.mo:2:12"), "{}", ended.err);
    folder.file("Pump.mo", "");
    assert!(mocc(path, &["check", "main.mo"]).err.contains("error[MO0201]"));
}

#[test]
fn every_output_can_be_the_standard_output() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file(
        "tank.mo",
        "model Tank\n  parameter Real k = 1;\n  Real x(start = 1, fixed = true);\nequation\n  der(x) = -k*x;\nend Tank;\n",
    );
    fn with<'a>(first: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
        [first, more].concat()
    }
    let plot = ["simulate", "tank.mo", "--plot", "-"];
    let ended = mocc(path, &plot);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.out.starts_with("<svg") && ended.err.contains("Tank: 1 states"), "{}", ended.err);
    assert!(done(path, &with(&plot, &["--quiet", "--output", "tank.csv"])).out.starts_with("<svg"));
    assert!(path.join("tank.csv").is_file());
    let both = "error: --output - and --plot - both write to the standard output\n";
    assert_eq!(refused(path, &with(&plot, &["--output", "-"])), both);
    assert!(refused(path, &with(&plot, &["--json"])).contains("--json and --plot - both"));

    let valve = root().join("examples/valve52.mol").display().to_string();
    let diagram = ["report", &valve, "--diagram", "-"];
    let ended = done(path, &with(&diagram, &["--quiet"]));
    assert!(ended.out.starts_with("<svg"), "{}", ended.out);
    assert!(refused(path, &with(&diagram, &["--output", "-"])).contains("both write"));

    done(path, &["simulate", "tank.mo", "--set", "k=2", "--output", "other.csv", "--quiet"]);
    let ended = mocc(path, &["compare", "tank.csv", "other.csv", "--plot", "-"]);
    assert_eq!(ended.status, 1, "{}", ended.err);
    assert!(ended.out.starts_with("<svg") && ended.err.contains("compared, "), "{}", ended.err);

    folder.file("tank.test.toml", "[[test]]\nname = \"all\"\nflat = true\n");
    assert_eq!(mocc(path, &["test", "--update"]).status, 0);
    let changed =
        fs::read_to_string(path.join("tank.mo")).expect("the model").replace("-k*x", "-2*k*x");
    folder.file("tank.mo", &changed);
    let ended = mocc(path, &["test", "--review", "-"]);
    assert_eq!(ended.status, 1, "{}", ended.err);
    assert!(ended.out.starts_with("<!DOCTYPE html>"), "{}", ended.out);
    assert!(refused(path, &["test", "--review", "-", "--json"]).contains("both write"));

    let Some(runtime) = fmu_runtime() else { return };
    let archive = Command::new(env!("CARGO_BIN_EXE_mocc"))
        .current_dir(path)
        .args(["export", "fmu", "tank.mo", "--output", "-", "--runtime"])
        .arg(runtime)
        .output()
        .expect("mocc starts");
    assert_eq!(archive.status.code(), Some(0));
    assert!(archive.stdout.starts_with(b"PK"), "a ZIP archive");
    fs::write(path.join("tank.fmu"), &archive.stdout).expect("an FMU");
    let block = done(path, &["import", "tank.fmu", "--output", "-", "--quiet"]).out;
    assert!(block.contains("block tank") && !path.join("-").exists(), "{block}");
    // The model from which the FMU was exported is not replaced by the block, which has the same name.
    let before = fs::read_to_string(path.join("tank.mo")).expect("the model");
    assert!(refused(path, &["import", "tank.fmu"]).contains("`tank.mo` exists"));
    assert_eq!(fs::read_to_string(path.join("tank.mo")).ok(), Some(before));
    done(path, &["import", "tank.fmu", "--name", "Block"]);
    done(path, &["import", "tank.fmu", "--name", "Block"]);
}

#[test]
fn a_differentiated_input_has_no_state_space_form() {
    let folder = Scratch::new();
    folder.file(
        "d.mo",
        "model D\n  input Real u(start = 0);\n  output Real i;\nequation\n  i = 2*der(u);\nend D;\n",
    );
    let ended = mocc(folder.path(), &["linearize", "d.mo"]);
    assert!(ended.status == 3 && ended.err.contains("differentiates an input"), "{}", ended.err);
}

/// Until the first argument of the sine is past its start, the value is that at the start, 0.
#[test]
fn a_delay_time_varies_in_model_exchange() {
    let folder = Scratch::new();
    folder.file(
        "d.mo",
        "model D\n  Real d = delay(sin(3*time), 0.1 + 0.05*time, 0.3);\n  Real c = delay(sin(3*time), 0.3);\n\
         Real x(start = 0, fixed = true);\nequation\n  der(x) = d - x;\n\
         annotation(experiment(StopTime = 2));\nend D;\n",
    );
    let Some(runtime) = fmu_runtime() else { return };
    let runtime = runtime.display().to_string();
    for version in ["2", "3"] {
        let export =
            ["export", "fmu", "d.mo", "--runtime", &runtime, "--type", "me", "--fmi", version];
        let ended = mocc(folder.path(), &export);
        assert!(ended.status == 0 && ended.err.is_empty(), "{}", ended.err);
        done(folder.path(), &["simulate", "d.fmu", "-o", "d.csv", "--quiet"]);
        let rows = read_csv(folder.path().join("d.csv")).expect("a table");
        let column = |name: &str| &rows.data[rows.position(name).expect(name)];
        for ((t, d), c) in rows.time.iter().zip(column("d").iter()).zip(column("c").iter()) {
            let expected = |then: f64| if then > 0.0 { (3.0 * then).sin() } else { 0.0 };
            assert!((d - expected(t - 0.1 - 0.05 * t)).abs() < 1e-4, "{version}: {t} {d}");
            assert!((c - expected(t - 0.3)).abs() < 1e-4, "{version}: {t} {c}");
        }
    }
}

/// Straight lines whose size is that of nothing else in the plan, from zero: least squares has a closed form.
#[test]
fn lines_of_any_size_are_calibrated_without_bounds() {
    for size in [1e-8, 1.0, 1e8] {
        let folder = Scratch::new();
        // A start of 1 says that 1e-8 is little.
        let start = if size < 1.0 { 0 } else { 1 };
        folder.file(
            "l.mo",
            &format!(
                "model L\n  parameter Real a = 0;\n  parameter Real b = {start};\n  output Real y = a + b*time;\nend L;\n"
            ),
        );
        let rows: Vec<(f64, f64)> = (0..21)
            .map(|k| {
                let t = 0.5 * f64::from(k);
                (t, size * (2.0 - 0.5 * t + 0.01 * f64::from((7 * k) % 5 - 2)))
            })
            .collect();
        let text: String = rows.iter().map(|(t, y)| format!("{t},{y:e}\n")).collect();
        folder.file("r.csv", &format!("t,y\n{text}"));
        folder.file(
            "plan.toml",
            &format!(
                "model = \"l.mo\"\n[data]\nfolder = \".\"\n[[recordings]]\nfile = \"r.csv\"\n[time]\ncolumn = \"t\"\nunit = \"s\"\n\
                 [signals]\ny = {{ variable = \"y\", unit = \"1\", sigma = {:e} }}\n[free]\na = {{}}\nb = {{}}\n",
                0.015 * size
            ),
        );
        let ended = mocc(folder.path(), &["calibrate", "plan.toml", "--out", "out"]);
        assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
        let text = fs::read_to_string(folder.path().join("out/calibration.json")).expect("a file");
        let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let n = rows.len() as f64;
        let sum = |f: &dyn Fn(f64, f64) -> f64| rows.iter().map(|(t, y)| f(*t, *y)).sum::<f64>();
        let (st, sy) = (sum(&|t, _| t), sum(&|_, y| y));
        let (stt, sty) = (sum(&|t, _| t * t), sum(&|t, y| t * y));
        let b = (n * sty - st * sy) / (n * stt - st * st);
        let a = (sy - b * st) / n;
        for (name, expected) in [("a", a), ("b", b)] {
            let all = found["parameters"].as_array().expect("a list");
            let p = all.iter().find(|p| p["name"] == name).expect("the parameter");
            let value = p["value"].as_f64().expect("a number");
            assert!((value - expected).abs() < 1e-3 * size, "{size}: {name} {value} {expected}");
            assert_eq!(p["at_bound"], false);
            assert!(p["standard_error"].as_f64().is_some_and(f64::is_finite), "{p}");
        }
    }
}

#[test]
fn recordings_are_numbered_for_a_model_that_wears() {
    let folder = Scratch::new();
    folder.file(
        "w.mo",
        "model W\n  parameter Real recording_number = 1;\n  output Real y = 10*recording_number + time;\nend W;\n",
    );
    folder.file(
        "plan.toml",
        "model = \"w.mo\"\n[data]\nfolder = \".\"\ntable = \"table.csv\"\nfile = \"file\"\nsplit = \"split\"\n\
         [time]\ncolumn = \"t\"\nunit = \"s\"\n[signals]\ny = { variable = \"y\", unit = \"1\", sigma = 0.1 }\n",
    );
    folder.file("table.csv", "file,split\na.csv,train\nb.csv,train\nc.csv,test\n");
    for (k, file) in ["a.csv", "b.csv", "c.csv"].into_iter().enumerate() {
        let y = 10 * (k + 1);
        folder.file(file, &format!("t,y\n0,{y}\n1,{}\n2,{}\n", y + 1, y + 2));
    }
    let ended = done(folder.path(), &["evaluate", "plan.toml", "--json"]);
    let found: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let recordings = found["recordings"].as_array().expect("a list");
    let chi2: Vec<_> = recordings.iter().map(|r| r["reduced_chi_square"].as_f64()).collect();
    assert_eq!(chi2, [Some(0.0); 3], "{found:#}");
}

#[test]
fn results_and_plans_go_through_pipes() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file(
        "tank.mo",
        "model Tank\n  parameter Real k = 1;\n  Real x(start = 1, fixed = true);\n  output Real y = 2*x;\n\
         equation\n  der(x) = -k*x;\nend Tank;\n",
    );
    let plan = "model = \"tank.mo\"\ngoal = { minimize = \"x_1 = at(x, 1)\" }\nfree = { k = { min = 0.5, max = 2 } }\n";
    let ended = piped(path, &["optimize", "-"], plan);
    assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
    assert!(path.join("stdin-design/design.json").is_file());
    let ended = piped(path, &["optimize", "-"], "model = 1");
    assert!(ended.status == 2 && ended.err.contains("stdin.toml:1:9"), "{}", ended.err);
    for command in ["calibrate", "diagnose", "evaluate"] {
        let ended = piped(path, &[command, "-"], "model = 1");
        assert!(ended.status == 2 && ended.err.contains("stdin.toml:1:9"), "{}", ended.err);
    }
    done(path, &["simulate", "tank.mo", "--output", "run.csv", "--quiet"]);
    let run = fs::read_to_string(path.join("run.csv")).expect("the run");
    let ended = piped(path, &["compare", "-", "run.csv"], &run);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    assert!(refused(path, &["compare", "-", "-"]).contains("only one"));
    assert!(piped(path, &["compare", "run.csv", "-"], "a").status == 2);
    assert!(done(path, &["plot", "run.csv", "--output", "-"]).out.starts_with("<svg"));
    let page = done(path, &["report", "tank.mo", "--output", "-", "--quiet"]).out;
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(done(path, &["structure", "tank.mo", "--dot", "-"]).out.starts_with("digraph"));
    assert!(done(path, &["structure", "tank.mo", "--svg", "-"]).out.starts_with("<svg"));
    for command in ["steady", "linearize"] {
        let json = done(path, &[command, "tank.mo", "--json", "-"]).out;
        serde_json::from_str::<serde_json::Value>(&json)
            .unwrap_or_else(|why| panic!("{why}: {json}"));
    }
    let vary = ["--vary", "k=1,2", "--measure", "x_1 = at(x, 1)"];
    let sweep = |file: &str, output: &str, input: &str| {
        piped(path, &[&["sweep", file, "--output", output][..], &vary].concat(), input)
    };
    let tank = fs::read_to_string(path.join("tank.mo")).expect("the model");
    let printed = sweep("-", "-", &tank);
    assert_eq!((printed.status, printed.err.as_str()), (0, ""));
    assert_eq!(sweep("tank.mo", "table.csv", "").status, 0);
    assert_eq!(printed.out, fs::read_to_string(path.join("table.csv")).expect("the table"));
    assert_eq!(sweep("tank.mo", "table.xlsx", "").status, 2);
    assert!(refused(path, &["plan", "-", "."]).contains("save the model"));
    assert!(!path.join("-").exists());
}

#[test]
fn quiet_commands_print_nothing_but_errors() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file(
        "a.mo",
        "model A\n  Real x(start = 1, fixed = true);\nequation\n  der(x) = -x;\nend A;\n",
    );
    for arguments in [
        &["check", "a.mo"][..],
        &["fmt", "--check", "a.mo"],
        &["steady", "a.mo"],
        &["linearize", "a.mo"],
        &["man", "pages"],
        &["report", "a.mo"],
        &["simulate", "a.mo"],
    ] {
        let all: Vec<&str> = arguments.iter().copied().chain(["--quiet"]).collect();
        assert_eq!(done(path, &all).out, "", "{arguments:?}");
    }
    // What a command is asked for is no message.
    for arguments in [&["flatten", "a.mo"][..], &["structure", "a.mo"], &["lib", "list"]] {
        let all: Vec<&str> = arguments.iter().copied().chain(["--quiet"]).collect();
        assert_eq!(done(path, &all).out, done(path, arguments).out, "{arguments:?}");
    }
    folder.file("b.mo", "model B\n  Real x = y;\nend B;\n");
    let ended = mocc(path, &["check", "b.mo", "-q"]);
    assert_eq!((ended.status, ended.out.as_str()), (1, ""));
    assert!(ended.err.contains("error[MO0202]"));
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

const WARM: &str = "model Warm
  parameter Real T_0(unit = \"degC\") = 20;
  parameter Real p_0(unit = \"bar\") = 2;
  parameter Real n(unit = \"rpm\") = 60;
  parameter Integer count = integer(p_0);
  Real T(unit = \"degC\", start = T_0, fixed = true);
  Real p[count](each unit = \"bar\") = fill(p_0, count);
  Real w(unit = \"rad/s\") = n*0.1;
equation
  der(T) = 1;
end Warm;
";

/// A parameter that is not declared in an SI unit takes a value in its own unit, whatever unit the user writes.
#[test]
fn values_are_converted_to_the_units_of_declarations() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file("warm.mo", WARM);
    let first = |more: &[&str]| -> Vec<String> {
        let mut all = vec!["simulate", "warm.mo", "--variables", "^(T|p.*|w)$"];
        all.extend(["--output", "-", "--quiet", "--stop", "1", "--interval", "1"]);
        all.extend(more);
        let ended = mocc(path, &all);
        assert_eq!(ended.status, 0, "{more:?}: {}", ended.err);
        ended.out.lines().nth(1).expect("a row").split(',').map(str::to_owned).collect()
    };
    assert_eq!(first(&["--set", "T_0=30 degC"])[1], "30.0");
    assert_eq!(first(&["--set", "T_0=300 K"])[1], "26.85");
    assert_eq!(first(&["--set", "T.start=300 K"])[1], "26.85");
    assert_eq!(first(&["--set", "n=120 rpm"]).last().map(String::as_str), Some("12.0"));
    // The value is that of a size, too.
    assert_eq!(first(&["--set", "p_0=3e5 Pa"])[2..5], ["3.0", "3.0", "3.0"]);
    assert_eq!(first(&["--unit", "T=K"])[1], "293.15");
    assert_eq!(first(&["--unit", "p[1]=kPa"])[2], "200.0");
    for (wrong, said) in [
        (["--set", "n=2 Hz"], "cannot convert `Hz` to `rpm`"),
        (["--set", "T_0=2 bar"], "cannot convert `bar` to `degC`"),
        (["--set", "T.start=2 bar"], "cannot convert `bar` to `degC`, the unit of `T.start`"),
        (["--unit", "w=Hz"], "`w` is in `rad/s`, which `Hz` does not measure"),
    ] {
        let ended = mocc(path, &[&["simulate", "warm.mo"][..], &wrong].concat());
        assert!(ended.status == 2 && ended.err.contains(said), "{wrong:?}: {}", ended.err);
    }
    let table = done(
        path,
        &[
            "sweep",
            "warm.mo",
            "--vary",
            "T_0=20 degC,300 K",
            "--measure",
            "T_e = final(T)",
            "--output",
            "-",
        ],
    );
    let ends: Vec<f64> = table
        .out
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(2).expect("T_e").parse().expect("a number"))
        .collect();
    assert!((ends[0] - 21.0).abs() < 1e-9 && (ends[1] - 27.85).abs() < 1e-9, "{}", table.out);
}

#[test]
fn names_in_quotes_are_set() {
    let folder = Scratch::new();
    folder.file(
        "odd.mo",
        "model Odd\n  parameter Real 'a.b = c'[2] = {1, 2};\n  Real x = 'a.b = c'[1] + 'a.b = c'[2];\nend Odd;\n",
    );
    let all = ["simulate", "odd.mo", "--set", "'a.b = c'[2]=5", "--output", "-", "--quiet"];
    let ended = done(folder.path(), &all);
    assert!(
        ended.out.lines().nth(1).is_some_and(|row| row.starts_with("0.0,6.0")),
        "{}",
        ended.out
    );
}

/// An element is set alone: the others keep the values of their declaration, or of a record around them.
#[test]
fn elements_of_arrays_are_set_alone() {
    let folder = Scratch::new();
    folder.file(
        "array.mo",
        "model Array\n  record R\n    parameter Real a[2] = {7, 8};\n  end R;\n  parameter Real m[2, 2] = {{1, 2}, {3, 4}};\n  parameter Integer n[:] = {1, 2};\n  parameter R r(a = {5, 6});\n  parameter R s[2];\n  Real x = m[1, 1] + 10*m[1, 2] + 100*m[2, 1] + 1000*m[2, 2];\n  Real y = n[1] + 10*n[2] + 100*r.a[1] + 1000*r.a[2];\n  Real z = s[1].a[1] + 10*s[1].a[2] + 100*s[2].a[1] + 1000*s[2].a[2];\nend Array;\n",
    );
    let first = |settings: &[&str]| -> Vec<f64> {
        let mut all = vec!["simulate", "array.mo", "--output", "-", "--quiet"];
        settings.iter().for_each(|s| all.extend(["--set", s]));
        let ended = done(folder.path(), &all);
        let row = ended.out.lines().nth(1).expect("a row").split(',').skip(1);
        row.map(|x| x.parse().expect("a number")).collect()
    };
    assert_eq!(first(&[]), [4321.0, 6521.0, 8787.0]);
    assert_eq!(first(&["m[1,2]=9"])[0], 4391.0);
    assert_eq!(first(&["m[2]={8,9}"])[0], 9821.0);
    assert_eq!(first(&["m[1,1]=0", "m[2,2]=0", "n[2]=5"])[..2], [320.0, 6551.0]);
    assert_eq!(first(&["r.a[1]=0", "s[2].a[2]=1"])[1..], [6021.0, 1787.0]);
    let err = refused(folder.path(), &["simulate", "array.mo", "--set", "m[3,1]=1"]);
    assert!(err.contains("the model has no parameter `m[3,1]`"), "{err}");
}

#[test]
fn files_of_the_wrong_kind_are_refused() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file("decay.mo", DECAY);
    folder.file("plan.toml", "model = 1\n");
    let err = refused(path, &["simulate", "plan.toml"]);
    assert!(err.contains("error[MO0111]") && err.contains("mocc calibrate"), "{err}");
    for (arguments, wanted) in [
        (&["export", "fmu", "decay.mo", "--output", "decay.zip"][..], ".fmu"),
        (&["import", "a.fmu", "--output", "a.txt"], ".mo or .mol"),
        (&["plan", "decay.mo", ".", "--output", "plan.txt"], ".toml"),
        (&["test", "--junit", "out.txt"], ".xml"),
        (&["structure", "decay.mo", "--dot", "out.svg"], ".dot or .gv"),
        (&["steady", "decay.mo", "--json", "out.txt"], ".json"),
        (&["linearize", "decay.mo", "--bode", "out.pdf"], ".svg or .png"),
    ] {
        let err = refused(path, arguments);
        assert!(err.contains(&format!("its name must end in {wanted}")), "{arguments:?}: {err}");
    }
    let err = refused(path, &["simulate", "decay.mo", "--format", "mat", "--output", "a.csv"]);
    assert!(err.contains("`--format` is for the standard output"), "{err}");
    let err = refused(path, &["simulate", "decay.mo", "--set", "p=hello"]);
    assert!(err.contains("a text is written in quotes: `\"hello\"`"), "{err}");
    let err = refused(path, &["simulate", "decay.mo", "--measure", "q = final(q)"]);
    assert!(err.contains("error[MO1106]") && err.matches("error").count() == 1, "{err}");
    assert!(refused(path, &["import", "-"]).contains("save the FMU"));
}

/// Names with brackets, components' parameters, a time in minutes.
#[test]
fn plans_are_guessed_for_components() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file(
        "plant.mo",
        "model Plant\n  model Tank\n    parameter Real k(unit = \"1/s\") = 0.01;\n    parameter Real h_0(unit = \"m\") = 1;\n    Real h(unit = \"m\", start = h_0, fixed = true);\n  equation\n    der(h) = -k*h;\n  end Tank;\n  Tank tanks[2];\nend Plant;\n",
    );
    folder.file("data/a.csv", "Time [min],tanks[1].h [cm]\n0,100\n1,55\n2,30\n3,16\n");
    folder.file("data/table.csv", "file,tanks[2].h_0 [cm]\na.csv,100\n");
    let plan = done(path, &["plan", "plant.mo", "data"]).out;
    for part in [
        "unit = \"min\"",
        "\"tanks[1].h [cm]\" = { variable = \"tanks[1].h\", unit = \"cm\" }",
        "\"tanks[2].h_0 [cm]\" = { parameter = \"tanks[2].h_0\", unit = \"cm\" }",
        "\"tanks[1].k\" = { min = 0.002, max = 0.05 }",
    ] {
        assert!(plan.contains(part), "no {part} in\n{plan}");
    }
    folder.file("plan.toml", &plan);
    done(path, &["check", "plan.toml"]);
}

#[test]
fn plans_of_designs_tests_and_settings_are_checked() {
    let folder = Scratch::new();
    let path = folder.path();
    folder.file("decay.mo", DECAY);
    let design = "model = \"decay.mo\"\n[goal]\nminimize = \"q_e = final(q)\"\n[free]\np = { min = 1, max = \"2 bar\" }\n";
    folder.file("design.toml", design);
    done(path, &["check", "design.toml"]);
    folder.file("design.toml", &design.replace("p = {", "pp = {"));
    assert!(refused(path, &["check", "design.toml"]).contains("no parameter `pp`"));
    folder.file("decay.test.toml", "[[test]]\nname = \"a\"\ntraces = true\n");
    done(path, &["check", "decay.test.toml"]);
    folder.file("decay.test.toml", "[[test]]\nname = \"a\"\ntrace = true\n");
    assert!(refused(path, &["check", "decay.test.toml"]).contains("unknown key `trace`"));
}
