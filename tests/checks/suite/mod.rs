//! The suite: models with their expectations in `tests/suite/<stage>/<topic>.mo`.
//!
//! `MOCC_CASE=flatten/arrays cargo test --test all suite` runs only the cases whose
//! `stage/topic/case` contains that.

pub mod case;
mod directive;
mod formula;
mod judge;

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use self::case::{TestCase, cases, root, stages};
use self::judge::judge;

/// One test for each folder of the suite: they run side by side.
macro_rules! stages {
    ($($stage:ident)*) => {
        $(
            #[test]
            fn $stage() {
                run(stringify!($stage));
            }
        )*
        const TESTED: &[&str] = &[$(stringify!($stage)),*];
    };
}

stages! {
    calibrate check classes clocks diagnose driver evaluate external flatten format instantiate io library lower measure
    parse report rules runtime sensitivity simulate structure sweep
}

/// Bytes of the stack that the cases of a folder have: the command has more, a thread of the test harness too few for
/// functions that call themselves.
const STACK: usize = 64 << 20;

/// Runs a folder on a thread of its own.
fn run(stage: &'static str) {
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(move || run_cases(stage));
    if let Err(panic) = thread.expect("a thread").join() {
        resume_unwind(panic);
    }
}

fn run_cases(stage: &str) {
    let filter = std::env::var("MOCC_CASE").unwrap_or_default();
    let cases = cases(stage).unwrap_or_else(|why| panic!("{why}"));
    let mut wrong = Vec::new();
    let mut expectations = 0;
    let mut snapshots = BTreeSet::new();
    for case in cases.iter().filter(|c| c.is_run()) {
        let name = format!("{}__{}.snap", case.topic, case.name);
        if !case.full_name().contains(&filter) {
            snapshots.insert(name);
            continue;
        }
        expectations += case.expectations();
        match catch_unwind(AssertUnwindSafe(|| judge(case))) {
            Ok(verdict) => {
                wrong.extend(verdict.wrong);
                if !verdict.snapshot.is_empty() {
                    snapshots.insert(name);
                    if catch_unwind(|| compare(case, &verdict.snapshot)).is_err() {
                        let (file, line, name) = (&case.file, case.line, &case.name);
                        wrong.push(format!("{file}:{line}: {name}: the snapshot differs"));
                    }
                }
            }
            Err(_) => wrong.push(format!("{}:{}: {}: panicked", case.file, case.line, case.name)),
        }
    }
    println!("{stage}: {} cases, {expectations} expectations", cases.len());
    for stale in stored(stage).iter().filter(|name| !snapshots.contains(*name)) {
        wrong.push(format!("tests/suite/{stage}/snapshots/{stale}: no case has this snapshot"));
    }
    assert!(wrong.is_empty(), "{} of {stage} failed:\n{}", wrong.len(), wrong.join("\n"));
}

fn compare(case: &TestCase, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(format!("../../suite/{}/snapshots", case.stage));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let name = format!("{}__{}", case.topic, case.name);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// The files of snapshots of a stage.
fn stored(stage: &str) -> Vec<String> {
    let folder = root().join("tests/suite").join(stage).join("snapshots");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".snap"))
        .collect()
}

#[test]
fn every_folder_of_the_suite_is_tested() {
    assert_eq!(stages(), TESTED, "name each folder of tests/suite in `stages!`");
}

/// A case that only other tests read is read by them.
#[test]
fn readers_of_models_are_there() {
    for stage in stages() {
        for case in cases(&stage).unwrap_or_else(|why| panic!("{why}")) {
            for reader in &case.readers {
                let file = root().join("tests/checks").join(reader);
                let text = std::fs::read_to_string(&file).unwrap_or_default();
                let (file, line, name) = (&case.file, case.line, &case.name);
                assert!(
                    text.contains(&format!("{name}\"")),
                    "{file}:{line}: {reader} has no {name}"
                );
            }
        }
    }
}
