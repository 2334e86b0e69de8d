//! Functions as values, loops that are left, and texts that a run chooses.

use super::door::{Case, Reading, assert_close};

#[test]
fn functions_are_arguments_with_some_of_theirs_given() {
    // Simpson's rule is exact for cubics: 2/3 * x^3 + 1 from 0 to 3 has the integral 16.5.
    let run = Case::text(
        "package P
           partial function Integrand
             input Real u;
             output Real y;
           end Integrand;
           function simpson
             input Integrand f;
             input Real a;
             input Real b;
             output Real integral;
           algorithm
             integral := (b - a)/6*(f(a) + 4*f((a + b)/2) + f(u = b));
           end simpson;
           function cubic
             extends Integrand;
             input Real factor;
             input Real offset = 0;
           algorithm
             y := factor*u^3 + offset;
           end cubic;
           function twice
             input Integrand f;
             input Real x;
             output Real y = simpson(f, 0, x);
           algorithm
             y := 2*y;
           end twice;
           model Top
             Real whole = simpson(function cubic(factor = 2/3, offset = 1), 0, 3);
             Real passed = twice(function cubic(factor = 2/3, offset = 1), 3*time);
           end Top;
         end P;",
    )
    .run();
    assert_close(run.last("whole"), 16.5, 1e-12);
    assert_close(run.last("passed"), 33.0, 1e-12);
}

#[test]
fn a_loop_in_a_model_is_left_where_a_run_says_so() {
    let text = "model First
           Real x[3] = {time, 2*time, 5*time};
           Integer first;
           Integer seen;
         algorithm
           first := 0;
           seen := 0;
           for k in 1:3 loop
             if x[k] > 1.5 then
               first := k;
               break;
             else
               seen := seen + 1;
             end if;
           end for;
         end First;";
    let found = |stop: f64| {
        let run = Case::text(text).stop(stop).run();
        (run.last("first"), run.last("seen"))
    };
    assert_eq!(found(0.2), (0.0, 3.0));
    assert_eq!(found(0.5), (3.0, 2.0));
    assert_eq!(found(1.0), (2.0, 1.0));
    assert_eq!(found(2.0), (1.0, 0.0));
}

#[test]
fn leaving_in_one_branch_does_not_concern_the_other() {
    let run = Case::text(
        "model Branches
           function f
             input Real x;
             output Real y = 0;
           algorithm
             for k in 1:4 loop
               if x > 0 then
                 if k > 2 then
                   break;
                 end if;
                 y := y + 1;
               else
                 y := y + 10;
               end if;
             end for;
             if x > 5 then
               if y > 1 then
                 return;
               end if;
             end if;
             y := y + 100;
           end f;
           Real below = f(-1 - time);
           Real above = f(1 + time);
           Real far = f(6 + time);
         end Branches;",
    )
    .run();
    assert_eq!((run.last("below"), run.last("above"), run.last("far")), (140.0, 102.0, 2.0));
}

#[test]
fn texts_follow_what_a_run_chooses() {
    let text = "model Texts
           type Colour = enumeration(red, green, blue);
           Colour colour = if time < 1 then Colour.red else Colour.blue;
           parameter String wanted = \"blue\";
           parameter String kind = if wanted == \"blue\" then \"cold\" else \"warm\";
           Boolean is_blue = String(colour) == wanted;
           Boolean is_late = String(time > 1.5) == \"true\";
           Boolean cold = kind == \"cold\";
           discrete String last(start = \"none\");
           Boolean changed = last == \"second\";
         equation
           when time > 1.2 then
             last = if is_blue then \"second\" else \"first\";
           end when;
         end Texts;";
    let early = Case::text(text).stop(0.5).run();
    assert_eq!((early.last("is_blue"), early.last("cold"), early.last("changed")), (0.0, 1.0, 0.0));
    let late = Case::text(text).stop(2.0).run();
    assert_eq!((late.last("is_blue"), late.last("is_late"), late.last("changed")), (1.0, 1.0, 1.0));
}

#[test]
fn only_initial_itself_is_a_condition_at_the_start() {
    let run = Case::text(
        "model Start
           function same
             input Boolean b;
             output Boolean y;
           algorithm
             y := b;
           end same;
           Real x(start = 1, fixed = true);
           Real y(start = 1, fixed = true);
         equation
           when same(initial()) then
             x = 2;
           end when;
           when initial() then
             y = 2;
           end when;
         end Start;",
    )
    .run();
    assert_eq!((run.last("x"), run.last("y")), (1.0, 2.0));
}

#[test]
fn truth_values_are_found_at_the_start() {
    let run = Case::text(
        "model Found
           parameter Real limit(fixed = false);
           parameter Boolean exceeded(fixed = false);
           Real y = if exceeded then limit else -limit;
         initial algorithm
           limit := 3;
           exceeded := false;
           if limit > 2 then
             exceeded := true;
             limit := 2;
           end if;
         end Found;",
    )
    .run();
    assert_eq!((run.last("exceeded"), run.last("y")), (1.0, 2.0));
}
