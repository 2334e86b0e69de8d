//! Consistent initial values: what decides between solutions, and how the iteration gets there.

use super::door::{Case, Reading, assert_close};

#[test]
fn values_beyond_their_bounds_are_warned_of_once() {
    let text = "model Tank
           type Level = Real(min = 0);
           parameter Real area(min = 0.1, max = 10) = 1;
           parameter Real outlet(max = area) = 2*area;
           Level h(start = 1, fixed = true);
           Real empty(max = 0.5) = 1 - h;
           Real depth(min = -0.75, max = 1) = -h;
           Real other(min = -1) = sin(10*time);
         equation
           area*der(h) = -0.4;
         end Tank;";
    let said = |case: Case| -> Vec<String> {
        let warnings = case.compile().run_with_warnings().1;
        assert!(warnings.iter().all(|w| w.code == "MO0919"));
        warnings.into_iter().map(|w| w.message).collect()
    };
    let late = Case::text(text).stop(3.0).interval(0.5);
    let late = said(late);
    let wanted = [
        "parameter `outlet` is 2, above its `max` of 1",
        "at time 0 s `depth` is -1, below its `min` of -0.75",
        "at time 1.5 s `empty` is 0.6",
    ];
    assert_eq!(late.len(), wanted.len(), "{late:?}");
    assert!(late.iter().zip(wanted).all(|(found, begin)| found.starts_with(begin)), "{late:?}");
    let wide = Case::text(text).stop(3.0).interval(0.5).set("area=20").set("outlet=1");
    assert_eq!(said(wide)[0], "parameter `area` is 20, above its `max` of 10");
}
