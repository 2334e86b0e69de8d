//! The outcomes of tests for people, as JUnit XML and as JSON.

use std::fmt::Write;

use super::run::{Finding, Outcome};
use super::test_file::Test;
use crate::io::json::Json;
use crate::report::markup::escaped;

/// A test with its outcome.
pub type Done<'a> = (&'a Test, &'a Outcome);

/// One test: a line, and the expectations that do not hold.
pub fn line(test: &Test, outcome: &Outcome) -> String {
    let result = if outcome.findings.is_empty() { "pass" } else { "FAIL" };
    let (file, seconds) = (test.file.display(), outcome.elapsed.as_secs_f64());
    let mut out = format!("{result}  {file}: {} ({seconds:.2} s)\n", test.name);
    for finding in &outcome.findings {
        for (k, line) in finding.message.lines().enumerate() {
            let head = if k == 0 { format!("{}: ", finding.expectation) } else { String::new() };
            out.push_str(format!("      {head}{line}").trim_end());
            out.push('\n');
        }
    }
    out
}

/// The number of tests that passed and of those that failed.
pub fn counts(done: &[Done<'_>]) -> (usize, usize) {
    let failed = done.iter().filter(|(_, outcome)| !outcome.findings.is_empty()).count();
    (done.len() - failed, failed)
}

/// JUnit XML, a test suite for each file.
pub fn junit(done: &[Done<'_>]) -> String {
    let seconds = |done: &[Done<'_>]| -> f64 {
        done.iter().map(|(_, outcome)| outcome.elapsed.as_secs_f64()).sum()
    };
    let head = |name: &str, attribute: &str, done: &[Done<'_>]| {
        let (tests, failures, time) = (done.len(), counts(done).1, seconds(done));
        format!(
            "<{name}{attribute} tests=\"{tests}\" failures=\"{failures}\" errors=\"0\" time=\"{time:.3}\">\n"
        )
    };
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    out += &head("testsuites", " name=\"mocc\"", done);
    for suite in done.chunk_by(|a, b| a.0.file == b.0.file) {
        let file = suite[0].0.file.display().to_string().replace('\\', "/");
        out += " ";
        out += &head("testsuite", &format!(" name=\"{}\"", escaped(&file)), suite);
        let class = file.trim_end_matches(super::files::EXTENSION).replace('/', ".");
        for (test, outcome) in suite {
            let (class, name) = (escaped(&class), escaped(&test.name));
            let time = outcome.elapsed.as_secs_f64();
            let _ =
                write!(out, "  <testcase classname=\"{class}\" name=\"{name}\" time=\"{time:.3}\"");
            out += if outcome.findings.is_empty() { "/>\n" } else { ">\n" };
            for Finding { expectation, message, .. } in &outcome.findings {
                let first = escaped(message.lines().next().unwrap_or_default());
                let all = escaped(message);
                let _ = writeln!(
                    out,
                    "   <failure type=\"{expectation}\" message=\"{first}\">{all}</failure>"
                );
            }
            if !outcome.findings.is_empty() {
                out += "  </testcase>\n";
            }
        }
        out += " </testsuite>\n";
    }
    out + "</testsuites>\n"
}

/// A JSON object with all tests.
pub fn json(done: &[Done<'_>], updated: &[String]) -> Json {
    let finding = |f: &Finding| {
        Json::object([
            ("expectation", Json::text(f.expectation)),
            ("message", Json::text(f.message.as_str())),
        ])
    };
    let test = |(test, outcome): &Done<'_>| {
        Json::object([
            ("file", Json::text(test.file.display().to_string())),
            ("name", Json::text(test.name.as_str())),
            ("passed", Json::flag(outcome.findings.is_empty())),
            ("seconds", Json::number(outcome.elapsed.as_secs_f64())),
            ("failures", Json::list(outcome.findings.iter().map(finding))),
        ])
    };
    let (passed, failed) = counts(done);
    Json::object([
        ("passed", Json::count(passed)),
        ("failed", Json::count(failed)),
        ("updated", Json::list(updated.iter().map(|path| Json::text(path.as_str())))),
        ("tests", Json::list(done.iter().map(test))),
    ])
}
