//! A page with the changes of snapshots: differences of text, and traces before and now.

use super::run::Finding;
use super::snapshot::TRACES;
use super::test_file::Test;
use crate::report::chart::svg;
use crate::report::markup::escaped;
use crate::report::page::diff::unified;
use crate::report::page::frame::Page;

/// The page of all expectations that do not hold, each with its test.
pub fn page(all: &[(&Test, &Finding)]) -> String {
    let mut page = Page::new("mocc test");
    page.add("<h1>Changes</h1>\n");
    for (k, (test, finding)) in all.iter().enumerate() {
        let heading = format!("{}: {}, {}", test.file.display(), test.name, finding.expectation);
        page.section(&format!("change-{k}"), &heading, &markup(finding));
    }
    page.finish()
}

fn markup(finding: &Finding) -> String {
    let line = |line: &str| format!("<p>{}</p>\n", escaped(line));
    let mut out: String = finding.message.lines().map(line).collect();
    if let Some(Ok(picture)) = finding.picture.as_ref().map(svg) {
        // As wide as the page at most.
        let fluid = "<svg style=\"max-width: 100%; height: auto\" ";
        out += &format!("<figure>{}</figure>\n", picture.replacen("<svg ", fluid, 1));
    }
    if let Some(snapshot) = &finding.snapshot {
        // The numbers of traces say less than their picture.
        let is_trace = snapshot.path.to_string_lossy().ends_with(TRACES);
        if let Some(before) = snapshot.before.as_ref().filter(|_| !is_trace) {
            out += &unified(before, &snapshot.after);
        }
    }
    out
}
