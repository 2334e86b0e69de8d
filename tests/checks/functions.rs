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
fn texts_are_put_together_while_the_model_runs() {
    let text = "model Texts
           function list
             input Integer n;
             output String s = \"\";
           algorithm
             for i in 1:n loop
               s := s + String(i) + \";\";
             end for;
           end list;
           type Size = enumeration(small, large);
           discrete Integer n(start = 0, fixed = true);
           parameter Integer p = 4;
           String s = \"n = \" + String(n);
           String last(start = \"none\");
           String form = String(n/3.0, significantDigits = 3) + String(n/3.0, format = \".1f\");
           Size size = if n > 2 then Size.large else Size.small;
           Boolean is_four = s == \"n = \" + String(p);
           Boolean before = s < \"n = 2\" and not s > \"n = 2\";
           Boolean after = s >= \"n = 2\" and not s <= \"n = 2\";
           Boolean listed = list(n) == \"1;2;3;4;\";
           Boolean formed = form == \"1.331.3\";
           Boolean padded = String(size, minimumLength = 7, leftJustified = false) == \"  large\";
           Boolean was_three = last == \"n = 3\";
           discrete Integer changes(start = 0, fixed = true);
         equation
           when sample(0.1, 0.1) then
             n = pre(n) + 1;
             last = pre(s);
           end when;
           when change(s) then
             changes = pre(changes) + 1;
           end when;
         end Texts;";
    let names = ["is_four", "before", "after", "listed", "formed", "padded", "was_three"];
    let after = |n: u32| {
        let run = Case::text(text).stop(0.1 * f64::from(n) + 0.05).run();
        assert_eq!(run.last("changes"), f64::from(n));
        names.map(|name| run.last(name))
    };
    assert_eq!(after(1), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(after(2), [0.0; 7]);
    assert_eq!(after(4), [1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    // \"n = 10\" stands before \"n = 2\".
    assert_eq!(after(10), [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    // The text of `flatten` says the same.
    let flat = Case::text(text).flat();
    let run = Case::text(&flat).stop(0.45).run();
    assert_eq!(names.map(|name| run.last(name)), after(4), "{flat}");
}

#[test]
fn what_a_for_loop_runs_over_a_run_may_say() {
    let case = Case::text(
        "model Loops
           function total
             input Integer n;
             input Real x;
             output Real s = 0;
             output Integer squares = 0;
           protected
             Real v[5] = {1, 2, 3, 4, 5};
           algorithm
             for i in 1:n, j in 1:i loop
               s := s + x*i*j;
               if i == j then
                 squares := squares + 1;
                 v[i] := 0;
               end if;
             end for;
             for k in 5:-1:n loop
               if v[k] < 0.5 then
                 break;
               end if;
               s := s + v[k];
             end for;
             for r in 0:0.1*x:0.3*x loop
               s := s + r;
             end for;
           end total;
           function first
             input Real x[:];
             input Real limit;
             input Integer n;
             output Integer at = 0;
           algorithm
             for i in 1:n loop
               if x[i] > limit then
                 at := i;
                 return;
               end if;
             end for;
             at := -1;
           end first;
           discrete Integer n(start = 1, fixed = true);
           Real s;
           Real squares;
           Real at;
           Integer m;
           Integer w[4];
         equation
           (s, squares) = total(n, 2*time);
           at = first({1, 2, 3, 4}, 2.5, n);
           when sample(0.5, 0.5) then
             n = pre(n) + 1;
           end when;
         algorithm
           m := 0;
           for i in 2:2:n loop
             m := m + i;
             w[i] := i;
           end for;
         end Loops;",
    )
    .stop(1.5)
    .interval(0.25);
    // The text of the flat model has the loops as functions.
    let again = Case::text(&case.flat()).stop(1.5).interval(0.25).run();
    let run = case.run();
    for name in ["s", "squares", "at", "m"] {
        assert_eq!(run.last(name), again.last(name), "{name}");
    }
    let at = |t| ["s", "squares", "at", "m", "w[2]", "w[4]"].map(|name| run.at(name, t));
    // With x = 2 t: x (1 + 2 + 4) for two rows, 5 + 4 + 3 behind them, and 0.6 x.
    for (found, expected) in at(0.75).into_iter().zip([23.4, 2.0, -1.0, 2.0, 2.0, 0.0]) {
        assert_close(found, expected, 1e-12);
    }
    for (found, expected) in at(1.25).into_iter().zip([73.0, 3.0, 3.0, 2.0, 2.0, 0.0]) {
        assert_close(found, expected, 1e-12);
    }
    assert_eq!((run.last("m"), run.last("w[4]")), (6.0, 4.0));
}

/// Elements of what is known are looked up, not chosen one by one: a straight line between squares.
#[test]
fn elements_of_tables_are_looked_up() {
    let case = Case::text(
        "model Lookup
             function lookup
               input Real x;
               output Real y;
             protected
               constant Real nodes[:] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
               constant Real values[:, 2] = [0, 10; 1, 11; 4, 14; 9, 19; 16, 26; 25, 35; 36, 46; 49, 59; 64, 74; 81, 91];
               constant Integer places[10] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
               Integer low;
               Integer high;
               Integer mid;
             algorithm
               low := 1;
               high := 10;
               while high - low > 1 loop
                 mid := div(low + high, 2);
                 if nodes[mid] > x then
                   high := mid;
                 else
                   low := mid;
                 end if;
               end while;
               y := values[places[low], 1] + (values[high, 1] - values[low, 1])*(x - nodes[low]);
             end lookup;
             parameter Real p[9] = {3, 1, 4, 1, 5, 9, 2, 6, 5};
             constant Real c[9] = {3, 1, 4, 1, 5, 9, 2, 6, 5};
             Integer i = integer(4*time) + 1;
             Real y = lookup(9*time);
             Real z = c[i];
             Real w = p[i];
           parameter Real many[1000] = {k^2 for k in 1:1000};
           Real square = many[100*i + 51];
           end Lookup;",
    )
    .stop(1.0)
    .interval(0.125);
    let flat = case.flat();
    assert!(flat.contains("'$table3'['$table2'[") && flat.contains("z = '$table4'[i]"), "{flat}");
    let (run, again) = (case.run(), Case::text(&flat).stop(1.0).interval(0.125).run());
    for k in 0..=8 {
        let t = 0.125 * f64::from(k);
        let low = (9.0 * t).floor().min(8.0);
        let line = low * low + (2.0 * low + 1.0) * (9.0 * t - low);
        assert_close(run.at("y", t), line, 1e-12);
        assert_close(again.at("y", t), line, 1e-12);
    }
    assert_eq!((run.at("z", 0.6), run.at("w", 0.6), run.at("z", 0.8)), (4.0, 4.0, 1.0));
    assert_eq!((run.first("square"), run.at("square", 0.6)), (151.0 * 151.0, 351.0 * 351.0));
}

/// A loop that would never end is not run where its branch is not taken: in an equation, in an assertion, and
/// in the loop of another function.
#[test]
fn loops_of_branches_that_are_not_taken_do_not_run() {
    let run = Case::text(
        "model Doublings
           function doublings
             input Real x;
             output Real n = 0;
           protected
             Real z = x;
           algorithm
             while z < 1 loop
               z := 2*z;
               n := n + 1;
             end while;
           end doublings;
           function total
             input Real x[2];
             input Integer turns;
             output Real sum = 0;
           protected
             Integer k = 0;
           algorithm
             while k < turns loop
               sum := sum + (if x[1] > 0 then doublings(x[1]) else 100) + (if x[2] > 0 then doublings(x[2]) else 10);
               k := k + 1;
             end while;
           end total;
           Real x = time - 0.5;
           Real s(start = 0, fixed = true);
           Integer turns = if time > 2 then 4 else 3;
           Real n = if x > 0 then doublings(x) else -1;
           Real sums = total({x, 0.25}, turns);
         equation
           der(s) = if noEvent(x > 0) then 1 + 0*doublings(x) else 0;
           assert(noEvent(x <= 0 or doublings(x) < 1000), \"too small\");
         end Doublings;",
    )
    .stop(0.9)
    .interval(0.1)
    .run();
    assert_eq!((run.at("n", 0.2), run.at("sums", 0.2)), (-1.0, 306.0));
    // 0.4 is doubled twice, 0.25 too.
    assert_eq!((run.last("n"), run.last("sums")), (2.0, 12.0));
    assert_close(run.last("s"), 0.4, 1e-6);
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

#[test]
fn elements_are_assigned_where_a_run_says() {
    let text = "package P
           record Cell
             Real value;
             Integer writes;
           end Cell;
           function put
             input Real row[:];
             input Integer at;
             input Real value;
             output Real changed[size(row, 1)] = row;
           algorithm
             changed[at] := value;
           end put;
           model Memory
             Integer at(start = 0, fixed = true);
             Real table[2, 3](each start = 0, each fixed = true);
             Cell cells[3](each value(start = -1, fixed = true), each writes(start = 0, fixed = true));
             Real read;
             Real second = cells[if time > 0.55 then 2 else 3].value;
             Real moved[3] = put({1, 2, 3}, if time > 0.5 then 2 else 3, 10*time);
           algorithm
             when sample(0.1, 0.1) then
               at := mod(pre(at), 3) + 1;
               table[2, at] := time;
               table[1, :] := {at, 0, -at};
               cells[at].value := 10*time;
               cells[at].writes := pre(cells[at].writes) + 1;
             end when;
             read := table[2, if time > 0.35 then 3 else 1];
           end Memory;
         end P;";
    // Written at 0.1 (first), 0.2 (second), 0.3 (third), and so on.
    let run = Case::text(text).stop(0.58).run();
    assert_close(run.last("table[2,1]"), 0.4, 1e-12);
    assert_close(run.last("table[2,2]"), 0.5, 1e-12);
    assert_close(run.last("table[2,3]"), 0.3, 1e-12);
    assert_eq!([run.last("table[1,1]"), run.last("table[1,3]")], [2.0, -2.0]);
    assert_close(run.last("read"), 0.3, 1e-12);
    assert_close(run.last("cells[2].value"), 5.0, 1e-12);
    assert_close(run.last("second"), 5.0, 1e-12);
    assert_eq!([1, 2, 3].map(|k| run.last(&format!("cells[{k}].writes"))), [2.0, 2.0, 1.0]);
    assert_eq!([run.last("moved[1]"), run.last("moved[3]")], [1.0, 3.0]);
    assert_close(run.last("moved[2]"), 5.8, 1e-12);
}

/// How often a number can be halved, the next one that is made of twos and threes, and the first square
/// above it: loops in loops, left by `break` and `return`, whose length only a run knows.
#[test]
fn loops_of_functions_are_left_where_a_run_says_so() {
    let text = "package P
           function evened
             input Integer from;
             output Integer n;
           protected
             Integer rest;
           algorithm
             n := from;
             while true loop
               rest := n;
               while mod(rest, 2) == 0 loop
                 rest := div(rest, 2);
               end while;
               while mod(rest, 3) == 0 loop
                 rest := div(rest, 3);
               end while;
               if rest <= 1 then
                 break;
               end if;
               n := n + 1;
             end while;
           end evened;
           function square
             input Integer above;
             output Integer root;
           algorithm
             root := 0;
             if above < 0 then
               return;
             end if;
             while root < 1000 loop
               root := root + 1;
               if root*root > above then
                 return;
               end if;
             end while;
             root := -1;
           end square;
           model Top
             Integer k = 37 + integer(10*time);
             Integer n = evened(k);
             Integer r = square(k);
             Integer none = square(-k);
             Integer beyond = square(2000000 + k);
           end Top;
         end P;";
    let run = Case::text(text).stop(0.5).run();
    assert_eq!([run.first("k"), run.first("n"), run.first("r")], [37.0, 48.0, 7.0]);
    assert_eq!([run.first("none"), run.first("beyond")], [0.0, -1.0]);
    let later = Case::text(text).stop(1.25).run();
    assert_eq!([later.last("k"), later.last("n"), later.last("r")], [49.0, 54.0, 8.0]);
}

/// How often a function calls itself is known before the run, if it depends on parameters alone.
#[test]
fn a_function_calls_itself_as_often_as_a_parameter_says() {
    let text = "model Halves
           function parts
             input Real x;
             input Real least;
             output Integer n = 0;
           algorithm
             if x >= least then
               n := parts(x/2, least) + parts(x/2, least) + 1;
             end if;
           end parts;
           parameter Real least = 0.01;
           final parameter Integer n = parts(1, least);
           Real y = n*time;
         end Halves;";
    // 1, 1/2, ... 1/64 are not below: a full tree of seven levels.
    assert_close(Case::text(text).run().last("y"), 127.0, 1e-12);
}

/// What a branch does not need is not computed: its function has no value there.
#[test]
fn a_long_function_is_called_where_its_branch_is_taken() {
    let text = "model Sampled
           function root
             input Real x;
             output Real y = 1;
           algorithm
             assert(x >= 0, \"no root\");
             while abs(y*y - x) > 1e-14 loop
               y := (y + x/y)/2;
             end while;
           end root;
           Real x = 0.55 - time;
           discrete Real y(start = 0, fixed = true);
           discrete Integer calls(start = 0, fixed = true);
         equation
           when sample(0.1, 0.1) then
             y = if x > 0 then root(x) else -1;
             calls = pre(calls) + 1;
           end when;
         end Sampled;";
    for (stop, expected) in [(0.15, 0.45_f64.sqrt()), (0.35, 0.25_f64.sqrt()), (0.95, -1.0)] {
        let run = Case::text(text).stop(stop).run();
        assert_close(run.last("y"), expected, 1e-12);
        assert_close(run.last("calls"), (10.0 * stop).floor(), 0.0);
    }
}

/// Real numbers are equal in functions only, so a function of the flat text compares them.
#[test]
fn equalities_of_functions_are_read_again() {
    let flat = Case::text(
        "model Sinc
           function sinc
             input Real x;
             output Real y;
           algorithm
             y := if x == 0 then 1 elseif x <> 1 then sin(x)/x else 2;
           end sinc;
           Real y = sinc(time - 1);
         end Sinc;",
    )
    .flat();
    assert!(flat.contains("'$equal'(time - 1.0, 0.0)") && flat.contains("not '$equal'"), "{flat}");
    let run = Case::text(&flat).stop(2.0).interval(0.25).run();
    assert_eq!((run.at("y", 1.0), run.at("y", 2.0)), (1.0, 2.0));
    assert_close(run.at("y", 1.5), 0.5_f64.sin() / 0.5, 1e-12);
}

/// What is called behind a `return` does not count where that was taken: nor does what it asserts.
#[test]
fn what_is_behind_a_return_asserts_nothing() {
    let run = Case::text(
        "model Left
           function small
             input Real x;
             output Real y;
           algorithm
             assert(x <= 0.5, \"too large\");
             y := 2*x;
           end small;
           function held
             input Real x;
             output Real y;
           algorithm
             if x > 0.5 then
               y := 1;
               return;
             end if;
             y := small(x);
           end held;
           Real y = held(time);
         end Left;",
    )
    .stop(1.0)
    .interval(0.125)
    .run();
    assert_eq!((run.at("y", 0.25), run.at("y", 0.5), run.at("y", 1.0)), (0.5, 1.0, 1.0));
}
