//! Models of strangers: what they may read and write, and that their strings command nothing.

use std::fs;

use super::door::{Scratch, suite_model};
use super::program::{Ended, mocc};

/// A folder with the model in `models/`, and a file that is not the model's.
fn with_model(case: &str, from: &str, to: &str) -> Scratch {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path().join("models")).unwrap();
    fs::create_dir(scratch.path().join("mine")).unwrap();
    scratch.file("mine/secret.txt", "treasure\n");
    scratch.file("models/model.mo", &suite_model(case).replace(from, to));
    scratch
}

fn says(ended: &Ended, text: &str) -> bool {
    ended.err.contains(text) || ended.out.contains(text)
}

#[test]
fn a_model_reads_only_below_its_own_folder() {
    let case = "external/files/a_file_of_somebody_else";
    for name in ["mine/secret.txt", "models/../mine/secret.txt", "models/link.txt"] {
        let scratch = with_model(case, "FILE", name);
        #[cfg(unix)]
        std::os::unix::fs::symlink("../mine/secret.txt", scratch.path().join("models/link.txt"))
            .unwrap();
        #[cfg(not(unix))]
        if name.contains("link") {
            continue;
        }
        let refused = mocc(scratch.path(), &["simulate", "models/model.mo"]);
        assert_eq!(refused.status, 1, "{name}: {}", refused.err);
        assert!(says(&refused, "--allow-read") && !says(&refused, "treasure"), "{}", refused.err);
        let checked = mocc(scratch.path(), &["check", "models/model.mo"]);
        assert!(!says(&checked, "treasure"), "{}", checked.err);
        let allowed =
            mocc(scratch.path(), &["simulate", "models/model.mo", "--allow-read", "mine"]);
        assert!(says(&allowed, "found treasure"), "{name}: {}", allowed.err);
    }
    let scratch = with_model(case, "FILE", "models/.hidden");
    scratch.file("models/.hidden", "treasure\n");
    let hidden = mocc(scratch.path(), &["simulate", "models/model.mo"]);
    assert!(hidden.status == 1 && !says(&hidden, "treasure"), "{}", hidden.err);
}

#[test]
fn a_model_reads_files_beside_it() {
    let case = "external/files/a_file_of_somebody_else";
    let scratch = with_model(case, "FILE", "models/data.txt");
    scratch.file("models/data.txt", "its own\n");
    let read = mocc(scratch.path(), &["simulate", "models/model.mo"]);
    assert!(says(&read, "found its own"), "{}", read.err);
}

#[test]
fn a_model_writes_only_new_files_beside_the_results() {
    let case = "external/print/into_a_file_of_somebody_else";
    let outside = |scratch: &Scratch| fs::read_to_string(scratch.path().join("mine/secret.txt"));
    for name in ["mine/secret.txt", "../mine/secret.txt", ".profile"] {
        let scratch = with_model(case, "FILE", name);
        fs::create_dir(scratch.path().join("out")).unwrap();
        let run = ["simulate", "models/model.mo", "--output", "out/x.csv"];
        let refused = mocc(scratch.path(), &run);
        assert_eq!(refused.status, 0, "{}", refused.err);
        assert!(says(&refused, "is not written"), "{name}: {}", refused.err);
        assert_eq!(outside(&scratch).unwrap(), "treasure\n");
        let notes = fs::read_to_string(scratch.path().join("out/notes.txt"));
        assert_eq!(notes.unwrap(), "noted\n");
        assert!(!scratch.path().join("out/.profile").exists());
    }
    let scratch = with_model(case, "FILE", "mine/secret.txt");
    let run = ["simulate", "models/model.mo", "--allow-write", "mine"];
    let allowed = mocc(scratch.path(), &run);
    assert!(!says(&allowed, "is not written"), "{}", allowed.err);
    assert_eq!(outside(&scratch).unwrap(), "treasure\nmeddled\n");
}

#[test]
fn strings_of_a_model_are_shown_and_never_obeyed() {
    let scratch =
        with_model("external/print/strings_that_command", "COMMAND", "\u{1b}]0;title\u{7}");
    let folder = scratch.path();
    let ran =
        mocc(folder, &["simulate", "models/model.mo", "--output", "x.csv", "--plot", "x.svg"]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    assert!(!says(&ran, "\u{1b}") && !says(&ran, "\u{7}"), "{:?}", ran.err);
    assert!(says(&ran, "late"), "{}", ran.err);
    let reported = mocc(folder, &["report", "models/model.mo", "--output", "x.html"]);
    assert_eq!(reported.status, 0, "{}", reported.err);
    for file in ["x.svg", "x.html"] {
        let text = fs::read_to_string(folder.join(file)).unwrap();
        for command in ["<script>alert", "<b>p", "<i>m", "<img", "\u{1b}", "\"><script"] {
            assert!(!text.contains(command), "{file} contains {command}");
        }
    }
    // A spreadsheet takes a cell for a formula that begins with one of these.
    let table = fs::read_to_string(folder.join("x.csv")).unwrap();
    let head = table.lines().next().unwrap();
    for cell in head.split(',') {
        let cell = cell.trim_start_matches('"');
        assert!(!cell.starts_with(['=', '+', '-', '@']), "{head}");
    }
}
