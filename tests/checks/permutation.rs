//! The order of declarations and equations never changes a result.

use super::door::{Case, Reading};
use super::suite::case::{self, cases};

/// Topics whose models have a declaration or an equation in each line.
const TOPICS: [(&str, &str); 2] = [("structure", "initialization"), ("structure", "matching")];

#[test]
fn results_do_not_depend_on_the_order_of_lines() {
    let mut compared = 0;
    for case in TOPICS.iter().flat_map(|(stage, topic)| models(stage, topic)) {
        let expected = outcome(&case.model);
        for order in [reversed, rotated, interleaved] {
            let Some(permuted) = permuted(&case.model, order) else { continue };
            same(&expected, &outcome(&permuted), &permuted);
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared} orders were compared");
}

fn models(stage: &str, topic: &str) -> Vec<case::TestCase> {
    let all = cases(stage).unwrap_or_else(|why| panic!("{why}"));
    all.into_iter().filter(|c| c.topic == topic).collect()
}

/// The last row by column, or the codes of errors.
type Outcome = Result<Vec<(String, f64)>, Vec<&'static str>>;

fn outcome(model: &str) -> Outcome {
    let trajectory = Case::text(model).outcome()?;
    let names = trajectory.columns.iter().map(|c| c.name.clone());
    let mut last: Vec<(String, f64)> = names.map(|n| (n.clone(), trajectory.last(&n))).collect();
    last.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(last)
}

fn same(expected: &Outcome, found: &Outcome, model: &str) {
    let (Ok(expected), Ok(found)) = (expected, found) else {
        assert_eq!(expected, found, "{model}");
        return;
    };
    assert_eq!(expected.len(), found.len(), "{model}");
    for ((name, a), (_, b)) in expected.iter().zip(found) {
        let near = (a - b).abs() <= 1e-4 * (1.0 + a.abs());
        assert!(near, "{name} is {b} instead of {a} in\n{model}");
    }
}

/// The model with the lines of each section in another order; `None` if it is not written line by
/// line.
pub fn permuted(model: &str, order: fn(Vec<&str>) -> Vec<&str>) -> Option<String> {
    let mut lines = model.lines().filter(|line| !line.trim().is_empty());
    let mut out: Vec<&str> = lines.by_ref().take_while(|l| l.starts_with("//")).collect();
    // `take_while` has consumed the head of the model.
    let head = model.lines().find(|l| !l.trim().is_empty() && !l.starts_with("//"))?;
    head.starts_with("model ").then_some(())?;
    out.push(head);
    let mut section = Vec::new();
    for line in lines {
        if line.starts_with("  ") {
            let whole = line.ends_with(';') && !line.trim_start().starts_with("end ");
            whole.then_some(())?;
            section.push(line);
        } else {
            out.extend(order(std::mem::take(&mut section)));
            out.push(line);
        }
    }
    (out.iter().filter(|line| line.starts_with("end ")).count() == 1).then(|| out.join("\n"))
}

pub fn reversed(lines: Vec<&str>) -> Vec<&str> {
    lines.into_iter().rev().collect()
}

fn rotated(mut lines: Vec<&str>) -> Vec<&str> {
    if !lines.is_empty() {
        lines.rotate_left(1);
    }
    lines
}

fn interleaved(lines: Vec<&str>) -> Vec<&str> {
    let (even, odd): (Vec<_>, Vec<_>) =
        lines.into_iter().enumerate().partition(|(k, _)| k % 2 == 0);
    odd.into_iter().chain(even).map(|(_, line)| line).collect()
}
