//! Properties that hold whatever the model: of what the stages make of it, and of its results.

use mocc::ir::trajectory::Trajectory;

use super::door::{Case, Reading, Scratch, assert_close, suite_model, text_of};
use super::program::mocc;

/// Models whose results the properties below compare.
const MODELS: [&str; 15] = [
    "examples/bouncing_ball.mol",
    "examples/equalisation.mol",
    "examples/filling.mol",
    "examples/oscillator.mol",
    "examples/stick_slip.mol",
    "examples/valve32.mol",
    "examples/valve52.mol",
    "flatten/arrays/loops_and_slices",
    "flatten/connections/one_node_and_one_open_end",
    "flatten/when/clauses",
    "flatten/expandable/buses",
    "flatten/inheritance/base_classes",
    "structure/sorting/explicit",
    "structure/tearing/bridge_of_resistors",
    "structure/index_reduction/pendulum",
];

#[test]
fn the_flat_text_is_the_same_model() {
    for model in MODELS {
        let original = Case::named(model);
        let text = original.flat();
        let again = Case::text(&text);
        // Types declared in the flat model have its name before theirs.
        let title = text.split_whitespace().nth(1).expect("the name of the model");
        let title = title.replace('\'', "\\'");
        let flat = again.flat().replace(&format!("'{title}.\\'"), "'").replace("\\''", "'");
        assert_eq!(flat, text, "{model}: the flat text of the flat text");
        let (a, b) = (original.run(), again.run());
        same(&a, &b, 1e-9, model);
    }
}

/// What is shared in expressions many times over is written once: as a tree, each of these functions has
/// more than 3^30 leaves.
#[test]
fn what_expressions_share_stays_short_as_text() {
    let original = Case::suite("flatten/print/shared_expressions");
    let text = original.flat();
    assert!(text.contains("'$shared") && text.len() < 100_000, "{}", text.len());
    let (a, b) = (original.stop(1.0).run(), Case::text(&text).stop(1.0).run());
    for name in ["x", "root", "held", "kept"] {
        for t in [0.0, 0.25, 0.5, 1.0] {
            assert_close(b.at(name, t), a.at(name, t), 1e-6);
        }
    }
}

/// A large function that is called often is one function of the flat model; one that is called twice, or that an
/// annotation says to inline, is part of the equations.
#[test]
fn large_functions_stay_calls_where_copies_would_be_many() {
    let functions = |case: &str| {
        let flat = Case::suite(&format!("evaluate/calls/{case}")).flat();
        flat.matches("  function function").count()
    };
    assert_eq!(functions("large_function_called_often"), 1);
    assert_eq!(functions("large_function_called_twice"), 0);
    assert_eq!(functions("large_function_annotated"), 0);
}

/// A value in one branch that a condition needs in another: a variable for it would depend on itself. There it is
/// written out, which stays short or is reported.
#[test]
fn conditions_of_functions_as_text() {
    let model = |steps: usize| {
        let text = suite_model("flatten/print/conditions_of_functions");
        text.replace("steps = 3", &format!("steps = {steps}"))
    };
    let original = Case::text(&model(3));
    let text = original.flat();
    assert!(text.len() > 100_000, "{}", text.len());
    let run = |case: Case| case.stop(3.0).interval(0.1).run();
    let (a, b) = (run(original), run(Case::text(&text)));
    let mut seen = Vec::new();
    for t in (0..=30).map(|k| 0.1 * f64::from(k)) {
        assert_close(a.at("x", t), (-t).exp(), 1e-4);
        let wanted = settled(a.at("x", t), 3);
        assert_close(a.at("y", t), wanted, 1e-9);
        assert_close(b.at("y", t), settled(b.at("x", t), 3), 1e-9);
        seen.push(wanted);
    }
    assert!(seen.iter().any(|y| (y - seen[0]).abs() > 0.1));
    // As a tree it has more than 2^40 leaves.
    let scratch = Scratch::new();
    scratch.file("settled.mo", &model(40));
    let ended = mocc(scratch.path(), &["flatten", "settled.mo"]);
    assert_eq!((ended.status, ended.out.as_str()), (1, ""));
    assert!(ended.err.contains("error[MO0275]: the flat text of this model"), "{}", ended.err);
    assert!(ended.err.contains("settled.mo:3:7"), "{}", ended.err);
}

/// The function of the model above.
fn settled(x: f64, steps: u32) -> f64 {
    let (mut y, mut high, mut phase) = (x, x > 0.2, 1);
    for k in 1..=steps {
        high = match high {
            true => y * y + y.sin() > 0.1 * f64::from(k) - 2.0,
            false => y * y + y.cos() > 0.9,
        };
        phase = match () {
            () if high && phase < 3 => phase + 1,
            () if y > f64::from(phase) / 4.0 => 2,
            () => 1,
        };
        if high {
            y = (1.0 + y * y).ln() / f64::from(phase) + y / 2.0;
        } else if y < 0.3 {
            y = (0.3 - y).sqrt() + y / f64::from(2 + phase);
        }
    }
    y
}

/// What a declaration says of one component may hold for all of them, or not: classes that are redeclared,
/// types that are modified, conditions and sizes of each component are its own.
#[test]
fn components_of_a_model_are_what_they_are_by_themselves() {
    let file = "flatten/siblings/components_of_one_class";
    let lines = |model: &str, holder: &str| -> Vec<String> {
        let text = Case::named(file).model(model).flat();
        let lines = text.lines().filter(|l| l.starts_with("  ")).map(str::trim);
        let own = lines.filter(|l| l.contains(&format!("'{holder}")));
        let mut own: Vec<String> = own.map(|l| l.replace(&format!("'{holder}"), "'")).collect();
        own.sort();
        own
    };
    let alone = lines("Siblings.Wrapped", "");
    for line in [
        "Real 'plain.d'(unit = \"kg/m3\", start = 1000.0);",
        "Real 'airy.d'(unit = \"kg/m3\", start = 1.2);",
        "Real 'airy.h'(unit = \"m\", min = 0.0, start = 2.0, fixed = true);",
        "Real 'square.layers[3]'(unit = \"m\", min = 0.0, max = 9.0);",
        "parameter Real 'square.loss.k' = 3.0;",
    ] {
        assert!(alone.iter().any(|l| l == line), "{line} is not in\n{}", alone.join("\n"));
    }
    assert!(!alone.iter().any(|l| l.contains("'airy.vent.")));
    for holder in ["w[1].", "w[3].", "one."] {
        assert_eq!(lines("Siblings.Many", holder), alone, "{holder}");
    }
    let other = lines("Siblings.Many", "other.");
    assert!(other.iter().any(|l| l.starts_with("Real 'airy.h'") && l.contains("start = 5.0")));
    assert!(other.iter().any(|l| l == "parameter Real 'square.loss.k' = 1.0;"));
}

#[test]
fn runs_are_the_same_to_the_bit() {
    for model in MODELS {
        let case = Case::named(model);
        assert_eq!(case.structure(), case.structure(), "{model}");
        assert!(case.run() == case.run(), "{model}");
        let compiled = case.compile();
        assert!(compiled.run() == compiled.run(), "{model}: the second run of one program");
    }
}

#[test]
fn the_order_of_connections_does_not_matter() {
    for model in ["oscillator", "filling", "equalisation", "stick_slip", "valve32", "valve52"] {
        let text = text_of(&format!("examples/{model}.mol"));
        let connection = |l: &&str| l.trim_start().starts_with("connect(");
        let mut reversed: Vec<String> = text.lines().filter(connection).map(swapped).collect();
        let count = reversed.len();
        assert!(count >= 2);
        let new: Vec<String> = text
            .lines()
            .map(|l| if connection(&l) { reversed.pop().expect("as many") } else { l.to_string() })
            .collect();
        let (a, b) = (Case::text(&text).run(), Case::text(&new.join("\n")).run());
        same(&a, &b, 1e-4, model);
    }
}

/// `connect(a, b)` as `connect(b, a)`, each one of a line.
fn swapped(line: &str) -> String {
    let mut out = String::new();
    let mut rest = line;
    while let Some((before, after)) = rest.split_once("connect(") {
        let (a, tail) = after.split_once(',').expect("two connectors");
        let (b, tail) = tail.split_once(");").expect("the end");
        out.push_str(&format!("{before}connect({}, {a});", b.trim()));
        rest = tail;
    }
    out + rest
}

#[test]
fn the_order_of_equations_does_not_matter() {
    for model in MODELS {
        let text = Case::named(model).flat();
        let (head, tail) = text.rsplit_once("\nequation\n").expect("equations");
        // Clauses of several lines stay together.
        let mut equations: Vec<String> = Vec::new();
        let mut depth = 0;
        let mut end = String::new();
        for line in tail.lines() {
            let word = line.trim_start();
            if word.starts_with("annotation(") || !end.is_empty() {
                end += &format!("{line}\n");
                continue;
            }
            match equations.last_mut() {
                Some(last) if depth > 0 => *last += &format!("{line}\n"),
                _ if word.starts_with("end ") => end += &format!("{line}\n"),
                _ => equations.push(format!("{line}\n")),
            }
            if word.starts_with("when ") {
                depth += 1;
            } else if word.starts_with("end when") {
                depth -= 1;
            }
        }
        equations.reverse();
        let reversed = format!("{head}\nequation\n{}{end}", equations.concat());
        let (a, b) = (Case::text(&text).run(), Case::text(&reversed).run());
        same(&a, &b, 1e-4, model);
    }
}

/// Two runs agree: the same events, and every column that both have within a part of its range, away from events.
fn same(a: &Trajectory, b: &Trajectory, part: f64, context: &str) {
    let what = |t: &Trajectory| t.events.iter().map(|e| plain(&e.what)).collect::<Vec<_>>();
    let close = |x: f64, y: f64| (x - y).abs() <= part * 1e-3 * x.abs().max(1e-6);
    assert_eq!(what(a), what(b), "{context}");
    for (x, y) in a.events.iter().zip(&b.events) {
        assert!(close(x.time, y.time), "{context}: {x:?} and {y:?}");
    }
    assert_eq!(a.rows(), b.rows(), "{context}");
    let mut compared = 0;
    for column in &b.columns {
        let Some(at) = a.columns.iter().position(|c| plain(&c.name) == plain(&column.name)) else {
            continue;
        };
        let (x, y) = (&a.data[at], b.of(&column.name));
        let range = x.iter().fold(0.0, |r: f64, v| r.max(v.abs())).max(1e-12);
        for k in 0..a.rows() {
            let near = |e: &mocc::ir::trajectory::Event| (e.time - a.time[k]).abs() < 1e-9;
            let off = (x[k] - y[k]).abs();
            assert!(
                off <= part * range || a.events.iter().any(near),
                "{context}: `{}` is {} and {} at {} s",
                column.name,
                x[k],
                y[k],
                a.time[k]
            );
        }
        compared += 1;
    }
    assert!(compared >= 2, "{context}: {compared} columns compared");
}

/// Without the quotes of names in flat models.
fn plain(text: &str) -> String {
    text.replace('\'', "")
}
