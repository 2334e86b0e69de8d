//! The figures of `examples/figures` can be made again, all of them and no others.

use std::path::Path;
use std::process::Command;

use super::door::Scratch;
use super::program::mocc;

fn pictures(folder: &Path) -> Vec<String> {
    let list = std::fs::read_dir(folder).expect("a folder").flatten();
    let names = list.map(|e| e.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".svg")).collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn the_script_makes_the_pictures_that_the_readme_names() {
    let folder = Scratch::new();
    let figures = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/figures");
    let mut command = Command::new("sh");
    command.arg(figures.join("make")).arg(folder.path());
    command.env("MOCC", env!("CARGO_BIN_EXE_mocc")).env_remove("MODELICAPATH");
    let output = command.output().expect("a shell");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let made = pictures(folder.path());
    let mut committed = pictures(&figures);
    committed.retain(|name| name != "valve52.svg");
    assert_eq!(made, committed);
    let readme = std::fs::read_to_string(figures.join("README.md")).expect("a text");
    assert!(made.iter().all(|name| readme.contains(name.as_str())), "{made:?}");
    for name in &made {
        let svg = std::fs::read_to_string(folder.path().join(name)).expect("a picture");
        assert!(svg.starts_with("<svg ") && svg.contains("<polyline"), "{name}");
    }
}

/// Units are those of the file, or those that the user wants; a table of a spreadsheet has semicolons.
#[test]
fn axes_have_the_units_of_the_file() {
    let folder = Scratch::new();
    folder.file(
        "fall.mo",
        "model Fall\n  Real h(unit = \"m\", start = 2, fixed = true);\nequation\n  der(h) = -1;\nend Fall;\n",
    );
    let run = |arguments: &[&str]| {
        let ended = mocc(folder.path(), arguments);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{arguments:?}");
        ended.out
    };
    for format in ["parquet", "mat"] {
        let file = format!("run.{format}");
        run(&["simulate", "fall.mo", "--output", &file, "--quiet"]);
        let svg = run(&["plot", &file, "--output", "-"]);
        assert!(svg.contains("h in m") && svg.contains("time in s"), "{format}: {svg}");
        let svg = run(&["plot", &file, "--unit", "h=mm", "--output", "-"]);
        assert!(svg.contains("h in mm") && svg.contains("2000"), "{format}: {svg}");
    }
    folder.file("excel.csv", "t;x\n0,5;1\n1,5;2,25\n");
    assert!(run(&["plot", "excel.csv", "--output", "-"]).contains("2.2"));
    let ended = mocc(folder.path(), &["plot", "excel.csv", "--unit", "x=mm"]);
    assert!(ended.status == 2 && ended.err.contains("does not say in which unit `x` is"));
}

#[test]
fn missing_columns_are_reported() {
    let folder = Scratch::new();
    folder.file("run.csv", "time,a.x[1],note\n0,1,\n1,2,late\n");
    let plot = |more: &[&str]| {
        let mut all = vec!["plot", "run.csv=run", "--output", "out.svg"];
        all.extend(more);
        mocc(folder.path(), &all)
    };
    let drawn = plot(&["--x", "time in s: t_s | time", "--y", "twice x: 2*a.x[1]"]);
    assert_eq!((drawn.status, drawn.err.as_str()), (0, ""));
    let said = |more: &[&str]| {
        let ended = plot(more);
        assert_eq!(ended.status, 2, "{}", ended.err);
        ended.err
    };
    assert!(said(&["--x", "t: t_s", "--y", "x: time"]).contains("no columns for `t`"));
    assert!(said(&["--x", "t: time", "--y", "x: b"]).contains("no columns for `x`"));
    assert!(said(&["--y", "a.x[2]"]).contains("did you mean `a.x[1]`?"));
    assert!(said(&["--range", "5:6"]).contains("no row is within the range 5:6"));
    assert!(said(&["--x", "t: time", "--y", "x: atan2(time, time)"]).contains("are supported"));
    // Without a label, a column or a formula is its own label.
    assert_eq!(plot(&["--x", "time", "--y", "a.x[1]", "--y", "2*time"]).status, 0);
    assert!(said(&["--x", "t: time", "--y", "x: 1 +"]).contains("is not a formula"));
}
