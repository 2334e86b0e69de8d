//! `mocc optimize`: designs against closed forms, limits, failures and wrong plans.

use serde_json::Value;

use super::door::Scratch;
use super::program::mocc;

/// A stone thrown from a height; the ground and the vertex are events and an extremum.
const THROW: &str = "
model Throw
  parameter Real v0(unit = \"m/s\") = 20 \"Speed\";
  parameter Real angle(unit = \"rad\") = 0.3 \"Above the horizon\";
  parameter Real h(unit = \"m\") = 5 \"Height of the hand\";
  constant Real g = 9.81;
  Real x(start = 0, fixed = true, unit = \"m\");
  Real y(start = h, fixed = true, unit = \"m\");
  Real vy(start = v0*sin(angle), fixed = true, unit = \"m/s\");
equation
  der(x) = v0*cos(angle);
  der(y) = vy;
  der(vy) = -g;
  annotation(experiment(StopTime = 6, Tolerance = 1e-9));
end Throw;
";

fn json(folder: &Scratch, plan: &str, status: i32) -> Value {
    let ended = mocc(folder.path(), &["optimize", plan, "--json", "--jobs", "2"]);
    assert_eq!(ended.status, status, "{}{}", ended.out, ended.err);
    serde_json::from_str(&ended.out).unwrap_or_else(|why| panic!("{why}: {}", ended.out))
}

/// A file of the examples.
fn example(name: &str) -> String {
    format!("{}/examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn number(json: &Value, pointer: &str) -> f64 {
    json.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {json:#}"))
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found}, not {expected}");
}

/// The farthest throw from a height: `sin(angle)^2 = v0^2 / (2 v0^2 + 2 g h)`.
#[test]
fn the_farthest_throw_has_the_angle_of_the_closed_form() {
    let folder = Scratch::new();
    folder.file("throw.mo", THROW);
    folder.file(
        "plan.toml",
        "model = \"throw.mo\"\nstarts = 2\n[goal]\nmaximize = \"range = at(x, when(y < 0))\"\n\
         [free]\nangle = { min = \"5 deg\", max = \"85 deg\" }\n",
    );
    let found = json(&folder, "plan.toml", 0);
    let (v, g, h) = (20.0_f64, 9.81_f64, 5.0_f64);
    let sine = (v * v / (2.0 * v * v + 2.0 * g * h)).sqrt();
    near(number(&found, "/parameters/0/after"), sine.asin(), 2e-4);
    near(number(&found, "/goal/after"), v / g * (v * v + 2.0 * g * h).sqrt(), 1e-6);
    assert_eq!(found["converged"], true);
    assert_eq!(found["difference_gradients"], 0, "the landing has exact derivatives");
    assert!(number(&found, "/exact_gradients") >= 2.0);
    for file in ["design.json", "design.html", "Throw_optimized.mol"] {
        assert!(folder.path().join("plan-design").join(file).exists(), "{file}");
    }
    // The amended model is the design.
    let run = ["simulate", "plan-design/Throw_optimized.mol", "--quiet", "--output", "run.csv"];
    let measure = ["--measure", "range = at(x, when(y < 0))"];
    let ended = mocc(folder.path(), &[&run[..], &measure[..]].concat());
    assert_eq!(ended.status, 0, "{}", ended.err);
    let range: f64 =
        ended.out.split_whitespace().nth(2).expect("a value").parse().expect("a number");
    near(range, number(&found, "/goal/after"), 1e-9);
}

/// Below a ceiling `H` over the hand the best angle is that whose vertex touches it: `sin(angle) = sqrt(2 g (H - h))/v0`.
#[test]
fn a_limit_on_an_extreme_value_holds_the_design() {
    let folder = Scratch::new();
    folder.file("throw.mo", THROW);
    folder.file(
        "plan.toml",
        "model = \"throw.mo\"\nstarts = 1\n[goal]\nmaximize = \"range = at(x, when(y < 0))\"\n\
         [limits]\nvertex = { is = \"max(y)\", max = \"9 m\" }\nt = { is = \"when(y < 0)\" }\n\
         [free]\nangle = { min = 0.1, max = 1.4 }\n",
    );
    let found = json(&folder, "plan.toml", 0);
    let sine = (2.0 * 9.81 * 4.0_f64).sqrt() / 20.0;
    near(number(&found, "/parameters/0/after"), sine.asin(), 1e-5);
    near(number(&found, "/limits/0/after"), 9.0, 1e-6);
    assert_eq!(found["difference_gradients"], 0, "the vertex is no event");
    // The price of the ceiling: d range/d H = (d range/d angle)/(d H/d angle), by differences of the closed form.
    let range = |angle: f64| {
        let (s, c) = angle.sin_cos();
        20.0 * c * (20.0 * s + (400.0 * s * s + 2.0 * 9.81 * 5.0).sqrt()) / 9.81
    };
    let height = |angle: f64| 5.0 + (20.0 * angle.sin()).powi(2) / (2.0 * 9.81);
    let (a, b) = (sine.asin() - 1e-6, sine.asin() + 1e-6);
    let price = (range(b) - range(a)) / (height(b) - height(a));
    near(number(&found, "/limits/0/goal_per_unit"), price, 1e-3);
}

/// An extreme value at an event has no exact derivative here; differences find the same design.
#[test]
fn extreme_values_at_events_are_left_to_differences() {
    let folder = Scratch::new();
    folder.file(
        "ramp.mo",
        "model Ramp parameter Real k = 0.5; Real x(start = 0, fixed = true); \
         equation der(x) = if x < k then 1 else -0.5; annotation(experiment(StopTime = 3, Tolerance = 1e-8)); end Ramp;",
    );
    folder.file(
        "plan.toml",
        "model = \"ramp.mo\"\nstarts = 1\n[goal]\nminimize = \"e = (max(x) - 1)^2\"\n[free]\nk = { min = 0.2, max = 1.8 }\n",
    );
    let found = json(&folder, "plan.toml", 0);
    assert!((number(&found, "/parameters/0/after") - 1.0).abs() < 2e-3, "{found:#}");
}

/// The goal of a search in a valley with two minima depends on its start: several starts find the deeper one.
#[test]
fn several_starts_find_the_deeper_minimum() {
    let folder = Scratch::new();
    folder.file(
        "well.mo",
        "model Well parameter Real p = 1; Real x(start = 0, fixed = true); \
         equation der(x) = (p^2 - 1)^2 + 0.3*p; annotation(experiment(StopTime = 1)); end Well;",
    );
    let plan = |starts: usize| {
        format!(
            "model = \"well.mo\"\nstarts = {starts}\n[goal]\nminimize = \"e = final(x)\"\n[free]\np = {{ min = -2, max = 2 }}\n"
        )
    };
    folder.file("one.toml", &plan(1));
    folder.file("all.toml", &plan(5));
    // Minima of (p^2 - 1)^2 + 0.3 p are roots of 4 p^3 - 4 p + 0.3.
    let (one, all) = (json(&folder, "one.toml", 0), json(&folder, "all.toml", 0));
    assert!(number(&one, "/parameters/0/after") > 0.9);
    let p = number(&all, "/parameters/0/after");
    assert!((4.0 * p.powi(3) - 4.0 * p + 0.3).abs() < 1e-3 && p < -1.0, "{p}");
}

/// Limits that contradict each other: status 1, and the table says which is violated.
#[test]
fn a_design_outside_of_its_limits_is_no_success() {
    let folder = Scratch::new();
    folder.file("throw.mo", THROW);
    folder.file(
        "plan.toml",
        "model = \"throw.mo\"\nstarts = 1\n[goal]\nmaximize = \"range = at(x, when(y < 0))\"\n\
         [limits]\nvertex = { is = \"max(y)\", max = 4 }\n[free]\nangle = { min = 0.1, max = 1.4 }\n",
    );
    let ended = mocc(folder.path(), &["optimize", "plan.toml"]);
    assert_eq!(ended.status, 1, "{}{}", ended.out, ended.err);
    assert!(ended.err.contains("No design keeps all limits"), "{}", ended.err);
    let line = ended.out.lines().find(|l| l.contains("limit vertex")).expect("the limit");
    assert!(line.ends_with("violated"), "{line}");
}

#[test]
fn wrong_plans_are_reported() {
    let folder = Scratch::new();
    folder.file("throw.mo", THROW);
    let head = "model = \"throw.mo\"\n[goal]\nmaximize = \"r = at(x, when(y < 0))\"\n";
    let free = "[free]\nangle = { min = 0.1, max = 1.4 }\n";
    let cases = [
        (format!("model = \"throw.mo\"\n{free}"), "MO1412"),
        (format!("{head}[free]\nangle = {{ min = 0.1 }}\n"), "MO1413"),
        (head.to_owned(), "MO1414"),
        (format!("{head}[free]\nangle = {{ min = 2, max = 1 }}\n"), "MO1415"),
        (format!("{head}[free]\nangle = {{ min = \"low\", max = 1 }}\n"), "MO1416"),
        (format!("{head}[free]\nangle = {{ min = \"1 m\", max = \"2 m\" }}\n"), "MO1417"),
        (format!("{head}[free]\nangel = {{ min = 0.1, max = 1.4 }}\n"), "MO1015"),
        (format!("{head}{free}[limits]\nt = {{ is = \"when(q < 0)\" }}\n"), "q"),
    ];
    for (text, expected) in cases {
        folder.file("plan.toml", &text);
        let ended = mocc(folder.path(), &["optimize", "plan.toml"]);
        assert!(ended.status == 2 || expected == "q" && ended.status == 1, "{text}{}", ended.err);
        assert!(ended.err.contains(expected), "{expected}: {}", ended.err);
        assert!(!folder.path().join("plan-design").exists(), "nothing is written");
    }
    let never = format!(
        "model = \"throw.mo\"\nstop = 0.1\nstarts = 2\n[goal]\nmaximize = \"r = at(x, when(y < 0))\"\n{free}"
    );
    folder.file("plan.toml", &never);
    let ended = mocc(folder.path(), &["optimize", "plan.toml"]);
    assert_eq!(ended.status, 2, "{}", ended.err);
    assert!(ended.err.contains("its condition never becomes true"), "{}", ended.err);
    let ended = mocc(folder.path(), &["optimize", "none.toml"]);
    assert_eq!(ended.status, 2);
    assert!(ended.err.contains("cannot read none.toml"), "{}", ended.err);
}

/// The example: a faster stroke, and an impact within its limit.
#[test]
fn the_valve_becomes_faster() {
    let folder = Scratch::new();
    let plan = example("valve52_design.toml");
    let ended = mocc(folder.path(), &["optimize", &plan, "--json", "--out", "design"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let found: Value = serde_json::from_str(&ended.out).expect("JSON");
    let (before, after) = (number(&found, "/goal/before"), number(&found, "/goal/after"));
    assert!(after < 0.9 * before, "{before} s to {after} s");
    let limits = found["limits"].as_array().expect("limits");
    let impact = limits.iter().find(|l| l["name"] == "v_impact").expect("a limit");
    let (bound, reached) = (number(impact, "/max"), number(impact, "/after"));
    assert!(reached <= bound * (1.0 + 1e-5), "{reached} over {bound}");
}
