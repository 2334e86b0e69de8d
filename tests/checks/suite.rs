//! What the stages make of the models in `suite/<stage>/`, and what must hold whatever the model.

use mocc::ir::trajectory::Trajectory;

use super::door::{Case, Reading, Scratch, assert_close, text_of};
use super::program::mocc;

/// A snapshot beside the model; it holds the model and what was made of it.
fn snapshot(stage: &str, name: &str, made: &str) {
    let text = text_of(&format!("tests/suite/{stage}/{name}.mo"));
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(format!("../suite/{stage}"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, format!("{text}----\n{made}")));
}

fn flat(name: &str) -> String {
    let flat = Case::file(format!("tests/suite/flatten/{name}.mo")).flat();
    snapshot("flatten", name, &flat);
    flat
}

fn structure(name: &str) -> String {
    let text = Case::file(format!("tests/suite/structure/{name}.mo")).structure();
    // The blocks at events are those between events where nothing is discrete.
    let (head, tail) = text.split_once("at events:").expect("three sequences of blocks");
    let (_, between) = tail.split_once("between events:").expect("three sequences of blocks");
    snapshot("structure", name, &format!("{head}between events:{between}"));
    text
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

#[test]
fn flat_connections() {
    let flat = flat("connections");
    // One node and one open end.
    assert_eq!(count(&flat, " = 0.0;"), 3);
    let run = Case::file("tests/suite/flatten/connections.mo").run();
    assert_eq!((run.last("a.p.i"), run.last("source.p.i")), (2.0, -2.0));
}

#[test]
fn flat_expandable_connectors() {
    let flat = flat("expandable");
    assert_eq!((count(&flat, "unused"), count(&flat, ".list[1]")), (0, 0));
    let run = Case::file("tests/suite/flatten/expandable.mo").run();
    for k in 1..=2 {
        assert_eq!(run.last(&format!("sinks[{k}].u[1]")), 3.0);
        assert_eq!(run.last(&format!("sinks[{k}].u[2]")), 7.0);
        assert_eq!(run.last(&format!("sinks[{k}].deep")), 3.0);
    }
    // Ohm's law and Kirchhoff's, across the bus.
    assert_eq!((run.last("left.p.i"), run.last("right.p.i")), (5.0, -5.0));
}

#[test]
fn flat_arrays() {
    let flat = flat("arrays");
    assert_eq!(count(&flat, "der("), 3);
    assert_eq!(count(&flat, "fixed = true"), 3);
}

#[test]
fn flat_inheritance() {
    let flat = flat("inheritance");
    assert_eq!(count(&flat, "wetness"), 0);
    let run = Case::file("tests/suite/flatten/inheritance.mo").tolerance(1e-9).run();
    assert!((run.last("v") - f64::exp(-2.0)).abs() < 1e-8);
}

#[test]
fn flat_rules() {
    let flat = flat("rules");
    // A flow outside of connectors has no second equation.
    assert_eq!(count(&flat, "q = 0"), 0);
    let run = Case::file("tests/suite/flatten/rules.mo").stop(1.0).run();
    let value = |name: &str| run.last(name);
    assert_eq!((value("body.mass"), value("body.weight")), (2.0, 6.0));
    assert_eq!(value("n"), 3.0);
    let seen = [1, 2, 3, 4, 5, 6, 7].map(|k| value(&format!("seen[{k}]")));
    assert_eq!(seen, [6.0, 7.0, 8.0, 9.0, 5.0, 2.0, 4.0]);
    assert_eq!((value("t"), value("around.user.y")), (14.0, 9.0));
    assert_eq!((value("data.x"), value("data.y")), (1.0, 2.0));
    assert_eq!((value("short.x"), value("short.y")), (5.0, 11.0));
    assert_eq!((value("first"), value("v")), (5.0, 2.0));
    assert_eq!((value("q"), value("right")), (3.0, 1.0));
    assert!((value("limited") - 1.0).abs() < 1e-9);
}

#[test]
fn flat_events() {
    let flat = flat("events");
    assert_eq!((count(&flat, "when "), count(&flat, "reinit(")), (2, 1));
}

#[test]
fn flat_tables() {
    let flat = flat("tables");
    // The value of the curve, that of the course, and its next event.
    assert_eq!((count(&flat, "table("), count(&flat, "nextTimeEvent(")), (2, 1));
    let run = Case::file("tests/suite/flatten/tables.mo").stop(3.0).tolerance(1e-9).run();
    // Between the points -1 and 1 the spring is linear with stiffness 2; the course rises from 0.5 s
    // to 1 in 1 s, jumps to 3 and stays: 0.5 + 1.5 * 3.
    assert!((run.last("x") - 0.5 * f64::cos(2.0_f64.sqrt() * 3.0)).abs() < 1e-7);
    assert!((run.last("sum") - 5.0).abs() < 1e-7);
}

#[test]
fn flat_delays() {
    let flat = flat("delay");
    assert_eq!(count(&flat, "delay("), 3);
    let run = Case::file("tests/suite/flatten/delay.mo").stop(2.0).tolerance(1e-9).run();
    assert!((run.last("late") - f64::sin(1.7)).abs() < 1e-6);
    // The method of steps: t^2/2 - 2 t + 3/2 from 1 to 2. The jump to 2 comes out at 1.3.
    assert!((run.last("x") + 0.5).abs() < 1e-8);
    assert!((run.last("sum") - 1.4).abs() < 1e-8);
}

#[test]
fn flat_lines_along_which_something_is_carried() {
    let text = flat("carried");
    assert_eq!((count(&text, "delay("), count(&text, "spatialDistribution(")), (2, 2));
    let value = |t: f64, name: &str| {
        let run = |case: Case| case.stop(t).tolerance(1e-9).run().last(name);
        let found = run(Case::file("tests/suite/flatten/carried.mo"));
        assert!((found - run(Case::text(&text))).abs() < 1e-6, "{name}");
        found
    };
    let close =
        |found: f64, wanted: f64| assert!((found - wanted).abs() < 2e-6, "{found} {wanted}");
    // By characteristics: what began on the line; what came in by the same end at pi - t; what began
    // there again; what came in by this end at 3 pi - t.
    let pi = std::f64::consts::PI;
    close(value(1.0, "at_right"), 4.0 - 0.8 * f64::sin(1.0));
    close(value(3.0, "at_left"), 10.0 + pi - 3.0);
    close(value(4.0, "at_left"), -0.8 * f64::sin(4.0));
    close(value(6.0, "at_right"), 6.0 - 3.0 * pi);
    let then = 2.0 - 0.5 - 0.25 * f64::sin(4.0);
    close(value(2.0, "late"), 1.0 + then);
    close(value(2.0, "slow"), f64::sin(5.0 * then));
    // Before the jump has come.
    assert_eq!(value(1.5, "late"), 0.0);
}

#[test]
fn flat_operator_records() {
    let flat = flat("operators");
    assert_eq!(count(&flat, "Dual"), 0);
    let run = Case::file("tests/suite/flatten/operators.mo").stop(2.0).run();
    // x^2 + 2 x - 5 and 2 x + 2 at 3; -x + x^2 + t and 2 x - 1.
    assert_eq!((run.last("y.value"), run.last("y.slope")), (10.0, 8.0));
    assert_eq!((run.last("z.value"), run.last("z.slope")), (8.0, 5.0));
}

#[test]
fn flat_loops_that_a_run_counts() {
    let flat = flat("loops");
    // What only a run can count stands in a function, and the model calls it.
    assert_eq!(
        (count(&flat, "while"), count(&flat, "end while"), count(&flat, "function0_1")),
        (2, 1, 3)
    );
    let run = Case::file("tests/suite/flatten/loops.mo").stop(1.0).run();
    assert!((run.last("r") - 3.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!((run.last("rods[1].m"), run.last("rods[2].m")), (23400.0, 23400.0));
    assert_eq!((run.last("plain.m"), run.last("last")), (9.0, 1.0));
}

#[test]
fn structure_without_what_vanishes() {
    let text = structure("vanishing");
    // v and u are one node, and so one state.
    assert_eq!(count(&text, "states (1): v"), 1);
    assert_eq!(count(&text, "core"), 0);
    let run = Case::file("tests/suite/structure/vanishing.mo").stop(1.0).tolerance(1e-9).run();
    assert!((run.last("u") - f64::exp(-1.0)).abs() < 1e-7);
    assert_eq!((run.last("core"), run.last("speed")), (0.0, 2.0));
    // With its resistance the node is two: u' = -u - (v - u) = -v, v' = (v - u) - v = -u.
    let whole = Case::file("tests/suite/structure/vanishing.mo").set("R=1").stop(1.0);
    let run = whole.tolerance(1e-9).run();
    assert!((run.last("v") - f64::cosh(1.0)).abs() < 1e-7);
}

#[test]
fn structure_of_a_chain_of_flows() {
    let text = structure("chains");
    assert_eq!(count(&text, "3 explicit"), 1);
    let run = Case::file("tests/suite/structure/chains.mo").stop(3.0).run();
    assert_eq!((run.last("port"), run.last("a"), run.last("later")), (1.0, 0.5, 1.0));
}

#[test]
fn structure_of_a_closed_end() {
    let text = structure("resting");
    assert_eq!(count(&text, "boundary.port.h := boundary.h * time"), 3);
    let run = Case::file("tests/suite/structure/resting.mo").stop(2.0).run();
    assert_eq!((run.last("boundary.port.h"), run.last("boundary.port.H_flow")), (6.0, 0.0));
}

#[test]
fn structure_of_the_pendulum() {
    let text = structure("pendulum");
    // One position and one velocity (Mattsson, Olsson & Elmqvist 2000), whichever the angle allows.
    assert_eq!(count(&text, "selected while running, 1 of (2): x, y"), 1);
    assert_eq!(count(&text, "selected while running, 1 of (2): v, w"), 1);
    assert_eq!(count(&text, "differentiated twice"), 1);
}

#[test]
fn structure_of_a_bridge() {
    // Potentials of the closed form: the bridge is a 2 by 2 system.
    let text = structure("loop");
    assert_eq!(count(&text, "linear system of 7, torn to 1: a"), 3);
    let run = Case::file("tests/suite/structure/loop.mo").run();
    let u = f64::sin(1.0);
    let (g_1, g_2, g_3, g_4, g_5) = (0.1, 1.0 / 20.0, 1.0 / 30.0, 1.0 / 40.0, 1.0 / 50.0);
    let (aa, ab, bb) = (g_1 + g_3 + g_5, -g_5, g_2 + g_4 + g_5);
    let det = aa * bb - ab * ab;
    let a = (bb * g_1 - ab * g_2) * u / det;
    assert!((run.last("a") - a).abs() < 1e-12);
}

#[test]
fn structure_of_a_sorted_system() {
    let text = structure("explicit");
    assert_eq!(count(&text, "(3 explicit)"), 2);
}

/// Models whose results the properties below compare.
const MODELS: [&str; 15] = [
    "examples/bouncing_ball.mol",
    "examples/equalisation.mol",
    "examples/filling.mol",
    "examples/oscillator.mol",
    "examples/stick_slip.mol",
    "examples/valve32.mol",
    "examples/valve52.mol",
    "tests/suite/flatten/arrays.mo",
    "tests/suite/flatten/connections.mo",
    "tests/suite/flatten/events.mo",
    "tests/suite/flatten/expandable.mo",
    "tests/suite/flatten/inheritance.mo",
    "tests/suite/structure/explicit.mo",
    "tests/suite/structure/loop.mo",
    "tests/suite/structure/pendulum.mo",
];

#[test]
fn the_flat_text_is_the_same_model() {
    for model in MODELS {
        let original = Case::file(model);
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
    let original = Case::text(
        "model Shared
           function mixed
             input Real x;
             output Real y;
           algorithm
             y := x;
             for k in 1:30 loop
               y := (sin(y) + y/(2 + cos(y)))/1.5;
             end for;
           end mixed;
           Real x(start = 1, fixed = true);
           Real root;
           discrete Real held(start = 0, fixed = true);
           discrete Real kept(start = 0.5, fixed = true);
         equation
           der(x) = -mixed(x) - x;
           // No root where its branch is not taken.
           root = if x > 0.5 then mixed(sqrt(x - 0.5))
                  elseif x > 0.3 then 1 else mixed(sqrt(0.5 - x));
           when sample(0.1, 0.1) then
             held = mixed(pre(held) + x);
             kept = if x > 0.6 then mixed(sqrt(x - 0.6)) + pre(kept) else pre(kept);
           end when;
         end Shared;",
    );
    let text = original.flat();
    assert!(text.contains("'$shared") && text.len() < 100_000, "{}", text.len());
    let (a, b) = (original.stop(1.0).run(), Case::text(&text).stop(1.0).run());
    for name in ["x", "root", "held", "kept"] {
        for t in [0.0, 0.25, 0.5, 1.0] {
            assert_close(b.at(name, t), a.at(name, t), 1e-6);
        }
    }
}

/// A value in one branch that a condition needs in another: a variable for it would need itself. There it is
/// written out, which stays short or is told.
#[test]
fn conditions_of_functions_as_text() {
    let model = |steps: usize| {
        format!(
            "model Settled
               function settled
                 input Real x;
                 output Real y;
               protected
                 Boolean high;
                 Integer phase;
               algorithm
                 y := x;
                 high := x > 0.2;
                 phase := 1;
                 for k in 1:{steps} loop
                   high := if high then y*y + sin(y) > 0.1*k - 2 else y*y + cos(y) > 0.9;
                   phase := if high and phase < 3 then phase + 1
                            elseif y > phase/4 then 2 else 1;
                   if high then
                     // No logarithm where its branch is not taken.
                     y := log(1 + y*y)/phase + y/2;
                   elseif y < 0.3 then
                     y := sqrt(0.3 - y) + y/(2 + phase);
                   end if;
                 end for;
               end settled;
               Real x(start = 1, fixed = true);
               Real y;
             equation
               der(x) = -x;
               y = settled(x);
             end Settled;"
        )
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
    assert!(ended.err.contains("settled.mo:1:7"), "{}", ended.err);
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
    let file = "tests/suite/flatten/siblings.mo";
    flat("siblings");
    let lines = |model: &str, holder: &str| -> Vec<String> {
        let text = Case::file(file).model(model).flat();
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
        let (a, b) = (Case::file(model), Case::file(model));
        assert_eq!(a.structure(), b.structure(), "{model}");
        assert!(a.run() == b.run(), "{model}");
        let compiled = a.compile();
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
        let text = Case::file(model).flat();
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
