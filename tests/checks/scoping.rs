//! Names and what they stand for: imports, `inner` and `outer`, inheritance, redeclaration.

use super::door::{Case, Reading, assert_close};

#[test]
fn what_an_import_names_comes_before_what_it_takes_along() {
    let run = Case::text(
        "package P
           package A
             constant Real k = 2;
             constant Real only = 7;
           end A;
           package B
             constant Real k = 4;
           end B;
           model Named
             import P.A.*;
             import P.B.k;
             Real y = k + only;
           end Named;
           model Own
             import P.A.*;
             Real k = 10;
             Real y = k;
           end Own;
           model Top
             Named named;
             Own own;
           end Top;
         end P;",
    )
    .run();
    assert_eq!((run.last("named.y"), run.last("own.y")), (11.0, 10.0));
}

#[test]
fn an_inner_outer_component_is_two() {
    // The gain of each level is that of the level above times its own.
    let run = Case::text(
        "package P
           model Leaf
             outer Real gain;
             Real y = gain;
           end Leaf;
           model Level
             parameter Real own = 3;
             inner outer Real gain = own*gain;
             Leaf leaf;
             Real seen = gain;
           end Level;
           model Top
             inner Real gain = 5;
             Level level;
             Leaf leaf;
           end Top;
         end P;",
    )
    .run();
    assert_eq!(
        (run.last("level.leaf.y"), run.last("level.seen"), run.last("leaf.y")),
        (15.0, 5.0, 5.0)
    );
}

#[test]
fn a_missing_inner_component_is_as_its_class_makes_it() {
    let run = Case::text(
        "package P
           model World
             parameter Real g = 9.81;
             Real weight = 2*g;
           end World;
           model Body
             outer World world;
             Real f = world.weight;
           end Body;
           model Top
             Body one;
             Body two;
           end Top;
         end P;",
    )
    .run();
    assert_eq!((run.last("one.f"), run.last("two.f")), (2.0 * 9.81, 2.0 * 9.81));
    assert_eq!(run.last("world.weight"), 2.0 * 9.81);
}

#[test]
fn an_outer_constant_stands_in_a_package_of_a_component() {
    let run = Case::text(
        "model Top
           model Part
             package Data
               outer constant Integer n;
             end Data;
             Integer y = 2*Data.n;
           end Part;
           inner constant Integer n = 21;
           Part part;
         end Top;",
    )
    .run();
    assert_eq!(run.last("part.y"), 42.0);
}

#[test]
fn a_redeclared_component_keeps_inner_and_its_condition() {
    let run = Case::text(
        "package P
           connector Port
             Real e;
             flow Real f;
           end Port;
           model Load
             parameter Real r = 1;
             Port p;
           equation
             p.e = r*p.f;
           end Load;
           model Other
             extends Load(r = 5);
           end Other;
           model Source
             Port p;
           equation
             p.e = 10;
           end Source;
           model Reader
             outer Real level;
             Real y = level;
           end Reader;
           model Machine
             parameter Boolean loaded = false;
             replaceable Load load if loaded;
             inner replaceable Real level;
             Reader reader;
             Source source;
           equation
             connect(source.p, load.p);
             level = 3;
           end Machine;
           model Top
             Machine idle(redeclare Other load, redeclare Real level);
             Machine busy(loaded = true, redeclare Other load);
           end Top;
         end P;",
    )
    .run();
    // 10 on 5, where there is a load.
    assert_eq!((run.last("idle.source.p.f"), run.last("busy.source.p.f")), (0.0, -2.0));
    assert_eq!(run.last("idle.reader.y"), 3.0);
}

#[test]
fn the_name_of_an_instance_begins_with_its_model() {
    let run = Case::text(
        "package P
           model Part
             Boolean here = getInstanceName() == \"Top.parts[2].inside\";
           end Part;
           model Holder
             Part inside;
           end Holder;
           model Top
             Holder parts[2];
           end Top;
         end P;",
    )
    .run();
    assert_eq!((run.last("parts[1].inside.here"), run.last("parts[2].inside.here")), (0.0, 1.0));
}

#[test]
fn sizes_are_taken_from_start_values() {
    let run = Case::text(
        "model Sized
           parameter Real a[:] = {1, 2, 3};
           Real x[:](each fixed = true, start = 2*a);
         equation
           der(x) = -x;
           annotation(experiment(StopTime = 1, Tolerance = 1e-9));
         end Sized;",
    )
    .run();
    assert_close(run.last("x[3]"), 6.0 * f64::exp(-1.0), 1e-7);
}

#[test]
fn any_enumeration_takes_the_place_of_an_open_one() {
    let run = Case::text(
        "package P
           model Chooser
             replaceable type Kind = enumeration(:);
             parameter Kind kind;
             Integer number = Integer(kind);
           end Chooser;
           model Top
             type Colour = enumeration(red, green, blue);
             Chooser c(redeclare type Kind = Colour, kind = Colour.blue);
           end Top;
         end P;",
    )
    .run();
    assert_eq!(run.last("c.number"), 3.0);
}
