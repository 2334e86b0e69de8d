//! The language: what declarations, modifications and algorithms mean.

use super::door::{Case, Reading, assert_close};

#[test]
fn enumerations_compare_in_order_and_index_arrays() {
    let run = Case::text(
        "model Gears
           type Gear = enumeration(First, Second, Third);
           parameter Gear gear = Gear.Second;
           parameter Real ratio[Gear] = {3.5, 2.1, 1.4};
           Real i = ratio[gear];
           Boolean low = gear < Gear.Third;
           Integer number = Integer(gear);
         end Gears;",
    );
    let second = run.run();
    assert_eq!((second.last("i"), second.last("low"), second.last("number")), (2.1, 1.0, 2.0));
    let third = run.set("gear=Gear.Third").run();
    assert_eq!((third.last("i"), third.last("low"), third.last("number")), (1.4, 0.0, 3.0));
}

#[test]
fn a_subscript_out_of_range_counts_only_where_it_is_read() {
    let model = "model Guarded
           parameter Real x[3] = {1, 2, 4};
           parameter Real on[Boolean] = {10, 20};
           function largest_below
             input Real x[:];
             input Integer n;
             output Real y = 0;
           algorithm
             for k in 1:size(x, 1) loop
               if k < size(x, 1) and x[k + 1] > x[k] then
                 y := x[k + 1];
               end if;
             end for;
             if n >= 1 and n <= size(x, 1) and x[n] > 1 then
               y := x[n];
             elseif n > size(x, 1) then
               return;
             else
               y := 0;
             end if;
             y := y + x[n]/100;
           end largest_below;
           discrete Integer i(start = 1, fixed = true);
           Real chosen = if i <= 3 then x[i] else -1;
           Boolean large = i <= 3 and x[i] > 3;
           Boolean beyond = i > 3 or x[i] > 3;
           Real y = largest_below(x, i);
           Real z;
           Real o = on[i > 3];
           discrete Real last(start = 0, fixed = true);
         equation
           if i <= 3 then
             z = x[i];
           else
             z = 0;
           end if;
           assert(i < 9, \"never read: \" + (if x[i] > 0 then \"a\" else \"b\"));
           when sample(1, 1) then
             i = pre(i) + 1;
             if pre(i) < 3 then
               last = x[pre(i) + 1];
             end if;
           end when;
         end Guarded;";
    let inside = Case::text(model).stop(1.5).run();
    let values = ["i", "chosen", "y", "z", "o", "last"].map(|name| inside.last(name));
    assert_eq!(values, [2.0, 2.0, 2.02, 2.0, 10.0, 2.0]);
    let beyond = Case::text(model).stop(3.5).run();
    let values = ["i", "chosen", "large", "beyond", "y", "z", "o", "last"];
    let values = values.map(|name| beyond.last(name));
    assert_eq!(values, [4.0, -1.0, 0.0, 1.0, 4.0, 0.0, 20.0, 4.0]);
}

#[test]
fn functions_with_loops_arrays_and_several_outputs() {
    let run = Case::text(
        "model Call
           function statistics
             input Real x[:];
             output Real mean = 0;
             output Real largest = x[1];
           protected
             Integer n = size(x, 1);
           algorithm
             for k in 1:n loop
               mean := mean + x[k]/n;
               if x[k] > largest then
                 largest := x[k];
               end if;
             end for;
           end statistics;
           function newton_root
             input Real a;
             output Real r = 1;
           algorithm
             for k in 1:8 loop
               r := (r + a/r)/2;
             end for;
           end newton_root;
           Real m;
           Real l;
           Real r = newton_root(2 + time);
         equation
           (m, l) = statistics({time, 2*time, 6});
         end Call;",
    )
    .run();
    assert_close(run.last("m"), 3.0, 1e-14);
    assert_eq!(run.last("l"), 6.0);
    assert_close(run.last("r"), f64::sqrt(3.0), 1e-13);
}

#[test]
fn what_arguments_compare_makes_events_and_what_functions_compare_makes_none() {
    let run = Case::text(
        "model Arguments
           record Three
             Integer k;
             Boolean positive = k > 0;
           end Three;
           function doubled
             input Integer i;
             output Integer o;
           algorithm
             o := if i > 0 then 2*i else i;
           end doubled;
           function three
             input Integer i;
             output Three t;
           algorithm
             t := Three(doubled(i));
           end three;
           function above
             input Real u;
             input Real limit;
             output Real y;
           algorithm
             y := if u > limit then sqrt(u - limit) else 0;
           end above;
           function of_both
             input Real u;
             input Boolean b;
             output Real y;
           algorithm
             y := (if b and u > 0.3 then 2 else 1) + above(2*u, u) + floor(u);
           end of_both;
           Three made = Three(if time > 0.5 then 1 else -1);
           Three returned = three(if time > 0.5 then 1 else -1);
           Integer once = doubled(if time > 0.5 then 1 else -1);
           Integer twice = doubled(doubled(if time > 0.5 then 1 else -1));
           Real jump = above(if time > 0.5 then 2 + time else -time, 0.25);
           Real both = of_both(time, time > 0.5);
           Real chosen = above(time, 0.25);
           Integer k(start = 0, fixed = true);
         equation
           when time > 0.75 then
             assert(made.k == 1 and made.positive, \"a record\");
             assert(returned.k == 2 and returned.positive, \"a function with a record\");
             assert(once == 2 and twice == 4, \"whole numbers\");
             assert(jump > 1 and both > 2, \"numbers\");
             k = pre(k) + once;
           end when;
         end Arguments;",
    )
    .run();
    for (name, value) in [("made.k", 1.0), ("returned.k", 2.0), ("once", 2.0), ("twice", 4.0)] {
        assert_eq!((run.first(name), run.last(name)), (-1.0, value));
    }
    assert_close(run.last("jump"), f64::sqrt(2.75), 1e-12);
    assert_close(run.last("both"), 4.0, 1e-12);
    assert_close(run.last("chosen"), f64::sqrt(0.75), 1e-12);
    // One for each instant that equations name: those of the functions' own relations are none.
    assert_eq!(run.events.len(), 2);
}

#[test]
fn functions_of_the_user_hide_those_that_are_predefined() {
    let run = Case::text(
        "package Hiding
           function sum
             input Real u[:];
             output Real y = 42;
           algorithm
           end sum;
           function abs
             input Real u;
             output Real y;
           algorithm
             y := 10 + .abs(u);
           end abs;
           package Deeper
             function matrix
               input Real u;
               output Real y;
             algorithm
               y := abs(u) + 1;
             end matrix;
           end Deeper;
           model Test
             function max
               input Real a;
               input Real b;
               output Real y;
             algorithm
               y := a;
             end max;
             function scalar = Deeper.matrix;
             import Hiding.Deeper.matrix;
             Real s = sum({1, 2});
             Real m = matrix(-1);
             Real a = max(1, 2);
             Real f = scalar(-2);
             Real p = .sum({1, 2}) + min(1, 2) + product({2, 3});
           end Test;
         end Hiding;",
    )
    .model("Hiding.Test")
    .run();
    let found = ["s", "m", "a", "f", "p"].map(|name| run.last(name));
    assert_eq!(found, [42.0, 12.0, 1.0, 13.0, 10.0]);
}

#[test]
fn the_outermost_modification_wins() {
    let run = Case::text(
        "package P
           model Base
             parameter Real a = 1;
             parameter Real b = 10*a;
             Real x = a + b;
           end Base;
           model Middle
             extends Base(a = 2);
           end Middle;
           model Holder
             Middle one(b = 5);
             Middle two;
             Middle many[2](a = {7, 8}, each b = 1);
           end Holder;
           model Top
             Holder h(one(a = 3));
           end Top;
         end P;",
    );
    let found = run.run();
    let x = |name: &str| found.last(name);
    assert_eq!((x("h.one.x"), x("h.two.x")), (8.0, 22.0));
    assert_eq!((x("h.many[1].x"), x("h.many[2].x")), (8.0, 9.0));
    let set = run.set("h.one.a=4").set("h.many[2].b=2").run();
    assert_eq!((set.last("h.one.x"), set.last("h.many[2].x")), (9.0, 10.0));
}

#[test]
fn replaceable_models_are_exchanged() {
    let text = "package P
           partial model Law
             input Real v;
             Real f;
           end Law;
           model Linear
             extends Law;
             parameter Real d = 1;
           equation
             f = d*v;
           end Linear;
           model Square
             extends Law;
           equation
             f = v*abs(v);
           end Square;
           model Body
             replaceable model Drag = Linear constrainedby Law;
             Drag drag(v = v);
             Real v(start = 1, fixed = true);
           equation
             der(v) = -drag.f;
             annotation(experiment(StopTime = 1, Tolerance = 1e-9));
           end Body;";
    let linear = Case::text(&format!("{text} model A = Body; end P;")).run();
    assert_close(linear.last("v"), f64::exp(-1.0), 1e-7);
    let square =
        Case::text(&format!("{text} model A = Body(redeclare model Drag = Square); end P;")).run();
    assert_close(square.last("v"), 0.5, 1e-7);
    let tuned =
        Case::text(&format!("{text} model A = Body(redeclare model Drag = Linear(d = 2)); end P;"))
            .run();
    assert_close(tuned.last("v"), f64::exp(-2.0), 1e-7);
}

#[test]
fn matrices_and_vectors() {
    let run = Case::text(
        "model Linear
           parameter Real A[2, 2] = [0, 1; -4, 0];
           parameter Real x_0[2] = {1, 0};
           Real x[2](start = x_0, each fixed = true);
           Real y = {3, 4}*{1, 2} + sum(A) + max(x_0);
           Real z[2] = transpose(A)*x_0;
           Real w[3] = cat(1, {1}, 2*ones(2));
         equation
           der(x) = A*x;
           annotation(experiment(StopTime = 1, Tolerance = 1e-9));
         end Linear;",
    )
    .run();
    assert_close(run.last("x[1]"), f64::cos(2.0), 1e-7);
    assert_close(run.last("x[2]"), -2.0 * f64::sin(2.0), 1e-7);
    assert_eq!(run.last("y"), 11.0 - 3.0 + 1.0);
    assert_eq!((run.last("z[1]"), run.last("z[2]")), (0.0, 1.0));
    assert_eq!((run.last("w[1]"), run.last("w[3]")), (1.0, 2.0));
}

/// Kleene's logic of three values.
#[test]
fn truth_values_and_texts_of_records_are_overloaded() {
    let run = Case::text(
        "package Logic
           operator record Three \"True, false or unknown: 1, -1 or 0\"
             Integer v;
             encapsulated operator 'constructor'
               function of
                 import Logic.Three;
                 input Integer v;
                 output Three t(v = v);
               algorithm
               end of;
             end 'constructor';
             encapsulated operator function 'and'
               import Logic.Three;
               input Three a;
               input Three b;
               output Three c = Three(min(a.v, b.v));
             algorithm
             end 'and';
             encapsulated operator function 'or'
               import Logic.Three;
               input Three a;
               input Three b;
               output Three c = Three(max(a.v, b.v));
             algorithm
             end 'or';
             encapsulated operator function 'not'
               import Logic.Three;
               input Three a;
               output Three c = Three(-a.v);
             algorithm
             end 'not';
             encapsulated operator 'String'
               function short
                 import Logic.Three;
                 input Three a;
                 output String s = if a.v > 0 then \"yes\" elseif a.v < 0 then \"no\" else \"unknown\";
               algorithm
               end short;
               function spelt
                 import Logic.Three;
                 input Three a;
                 input String before;
                 output String s = before + (if a.v > 0 then \"yes\" else \"no\");
               algorithm
               end spelt;
             end 'String';
           end Three;
           model Tables
             Integer n(start = -1, fixed = true);
             Three a = Three(n);
             Three b = Three(0);
             Three both = a and b;
             Three one = a or not b;
             Three mixed = not a or a and b;
             Boolean known = String(both) <> \"unknown\";
             Boolean said = String(a, \"it is \") == \"it is yes\";
           equation
             when time > 0.5 then
               n = 1;
             end when;
           end Tables;
         end Logic;",
    )
    .stop(1.0)
    .run();
    let at = |name: &str| (run.first(name), run.last(name));
    assert_eq!((at("both.v"), at("one.v"), at("mixed.v")), ((-1.0, 0.0), (0.0, 1.0), (1.0, 0.0)));
    assert_eq!((at("known"), at("said")), ((1.0, 0.0), (0.0, 1.0)));
}

#[test]
fn conditional_components_vanish_with_their_connections() {
    let text = "model Optional
           parameter Boolean damped = true;
           Translational.Mass mass(m = 1, s_start = 1);
           Translational.Spring spring(c = 4);
           Translational.Damper damper(d = 4) if damped;
           Translational.Fixed wall;
         equation
           connect(wall.flange, spring.flange_a);
           connect(spring.flange_b, mass.flange);
           connect(wall.flange, damper.flange_a);
           connect(damper.flange_b, mass.flange);
           annotation(experiment(StopTime = 1, Tolerance = 1e-9));
         end Optional;";
    let damped = Case::text(text).run();
    // Critical damping with 2 rad/s.
    assert_close(damped.last("mass.s"), 3.0 * f64::exp(-2.0), 1e-7);
    let free = Case::text(text).set("damped=false").run();
    assert_close(free.last("mass.s"), f64::cos(2.0), 1e-7);
    assert!(free.values("damper.f").is_none());
}

#[test]
fn records_inner_outer_and_constants_of_packages() {
    let run = Case::text(
        "package P
           constant Real g = 9.81;
           record Point
             Real x;
             Real y;
           end Point;
           model World
             parameter Real scale = 2;
           end World;
           model Part
             outer World world;
             Real weight = world.scale*g;
           end Part;
           model Top
             inner World world(scale = 3);
             Part part[2];
             Point p = Point(time, 2*time);
             Real r = p.x + p.y;
           end Top;
         end P;",
    )
    .run();
    assert_close(run.last("part[2].weight"), 29.43, 1e-15);
    assert_close(run.last("r"), 3.0, 1e-15);
}

#[test]
fn iterators_without_a_range_run_over_what_they_index() {
    let run = Case::text(
        "model Deduced
           type Gear = enumeration(First, Second, Third);
           parameter Real a[3] = {1, 2, 4};
           Real b[3];
           Real c[2, 3];
           Real d[Gear];
           Real e[Boolean];
           Real s = sum(a[i]*b[i] for i);
           Real f[3] = {a[i]^2 for i};
           Real g;
         equation
           for i loop
             b[i] = 10*a[i];
           end for;
           for i, j loop
             c[i, j] = 10*i + j;
           end for;
           for i loop
             d[i] = if i == Gear.Third then 30 else Integer(i);
           end for;
           for i loop
             e[i] = if i then 1 else 2;
           end for;
         algorithm
           g := 0;
           for i loop
             g := g + a[i];
           end for;
         end Deduced;",
    )
    .run();
    assert_eq!((run.last("s"), run.last("g")), (10.0 * (1.0 + 4.0 + 16.0), 7.0));
    assert_eq!((run.last("b[3]"), run.last("f[3]"), run.last("c[2,3]")), (40.0, 16.0, 23.0));
    assert_eq!((run.last("d[2]"), run.last("d[3]")), (2.0, 30.0));
    assert_eq!((run.last("e[1]"), run.last("e[2]")), (2.0, 1.0));
}

#[test]
fn cardinality_counts_connections_from_both_sides() {
    let run = Case::text(
        "model Count
           connector Pin
             Real v;
             flow Real i;
           end Pin;
           model Inside
             Pin p;
           equation
             p.v = 1 + p.i;
           end Inside;
           model Part
             Pin p, q;
             Integer n = cardinality(p);
             Integer none = cardinality(q);
             Inside x;
           equation
             connect(x.p, p);
             if cardinality(q) == 0 then
               q.v = 5;
             end if;
           end Part;
           Part a, b, c;
         equation
           connect(a.p, b.p);
           connect(c.p, b.p);
         end Count;",
    )
    .run();
    assert_eq!(["a.n", "b.n", "c.n"].map(|n| run.last(n)), [2.0, 3.0, 2.0]);
    assert_eq!((run.last("a.none"), run.last("b.q.v")), (0.0, 5.0));
}

#[test]
fn the_experiment_of_a_base_is_that_of_the_model() {
    let run = Case::text(
        "model Base
           Real x = time;
           annotation(experiment(StopTime = 3, Interval = 0.5));
         end Base;
         model Between
           extends Base;
         end Between;
         model Derived
           extends Between;
         end Derived;",
    )
    .run();
    assert_eq!((run.last("x"), run.rows()), (3.0, 7));
}

/// Gibbs' function gives entropy and volume as its partial derivatives.
#[test]
fn partial_derivatives_of_functions_are_functions() {
    let run = Case::text(
        "model Derived
           function f
             input Real x;
             input Real y;
             input Integer n = 2;
             output Real a;
             output Real b;
           protected
             Real h;
           algorithm
             h := x * y;
             for i in 1:n loop
               h := h * sin(x);
             end for;
             if x > 0.55 then
               a := h + x ^ 2;
             else
               a := exp(x * y);
             end if;
             b := sqrt(x ^ 2 + y ^ 2);
           end f;
           function f_x = der(f, x);
           function f_xy = der(f_x, y);
           function f_xx = der(f, x, x);
           Real x = 0.1 + time;
           Real a_x, b_x, a_xy, b_xy, b_xx;
           Real by_hand[3];
         equation
           (a_x, b_x) = f_x(x, 3 * x);
           (a_xy, b_xy) = f_xy(x, y = 3 * x);
           (, b_xx) = f_xx(x, y = 3 * x);
           by_hand[1] = if x > 0.55 then 3 * x * sin(x) ^ 2 + 6 * x ^ 2 * sin(x) * cos(x) + 2 * x
             else 3 * x * exp(3 * x ^ 2);
           by_hand[2] = if x > 0.55 then sin(x) ^ 2 + 2 * x * sin(x) * cos(x)
             else (1 + 3 * x ^ 2) * exp(3 * x ^ 2);
           by_hand[3] = 0.9 / (sqrt(10) * x);
         end Derived;",
    )
    .interval(0.1)
    .run();
    // A relation in a function is no event: it may switch a row earlier.
    let at_border: Vec<bool> =
        run.values("x").unwrap().iter().map(|x| (x - 0.55).abs() < 1e-9).collect();
    for (name, by_hand) in [("a_x", "by_hand[1]"), ("a_xy", "by_hand[2]"), ("b_xx", "by_hand[3]")] {
        let pairs = run.values(name).unwrap().iter().zip(run.values(by_hand).unwrap());
        for ((found, expected), _) in pairs.zip(&at_border).filter(|(_, border)| !**border) {
            assert_close(*found, *expected, 1e-12);
        }
    }
}

/// A vector of subscripts may hold variables, where elements are read and where they are assigned.
#[test]
fn vectors_of_subscripts_may_change_at_events() {
    let run = Case::text(
        "model Vectors
           Integer k(start = 1, fixed = true);
           Integer idx[2] = {k, 2};
           Real v[3] = {time, 2 * time, 3 * time};
           Real w[2] = v[idx];
           Real m[3, 3] = {{10 * i + j for j in 1:3} for i in 1:3};
           Real p[2, 2] = m[idx, {3, 1}];
           Real q[3, 2] = m[:, idx];
           Real a[3];
           function swap
             input Real u[3];
             input Integer i[2];
             output Real y[3] = u;
           algorithm
             y[i] := y[{i[2], i[1]}];
           end swap;
           Real s[3] = swap({1, 2, 3}, {k, 4 - k});
         algorithm
           a := zeros(3);
           a[idx] := {7, 8};
         equation
           when sample(0.25, 0.25) then
             k = if pre(k) < 3 then pre(k) + 1 else 1;
           end when;
         end Vectors;",
    )
    .stop(0.6)
    .run();
    let last = |name: &str| run.last(name);
    assert_eq!([last("k"), last("w[1]"), last("w[2]")], [3.0, 3.0 * 0.6, 2.0 * 0.6]);
    assert_eq!(["p[1,1]", "p[1,2]", "p[2,1]", "p[2,2]"].map(last), [33.0, 31.0, 23.0, 21.0]);
    assert_eq!(["q[1,1]", "q[1,2]", "q[3,1]", "q[3,2]"].map(last), [13.0, 12.0, 33.0, 32.0]);
    assert_eq!(["a[1]", "a[2]", "a[3]"].map(last), [0.0, 8.0, 7.0]);
    // First and last change places at the beginning and at the end.
    assert_eq!(["s[1]", "s[2]", "s[3]"].map(last), [3.0, 2.0, 1.0]);
    assert_eq!(["s[1]", "s[2]", "s[3]"].map(|n| run.values(n).unwrap()[0]), [3.0, 2.0, 1.0]);
}

/// A size may be that of another dimension of the same component, as of a matrix that is square.
#[test]
fn sizes_of_a_component_may_depend_on_each_other() {
    let run = Case::text(
        "model Squares
           block StateSpace
             parameter Real A[:, size(A, 1)] = [1, 0; 0, 1];
             parameter Real B[size(A, 1), :] = [1; 1];
             parameter Real C[size(C, 2) - 1, :] = [1, 2];
             input Real u[size(B, 2)];
             output Real x[size(A, 1)](each start = 0, each fixed = true);
           equation
             der(x) = A * x + B * u;
           end StateSpace;
           StateSpace one(u = {1});
           StateSpace three(
             A = -identity(3), B = {{1, 0}, {0, 1}, {1, 1}}, u = {1, 2}, C = zeros(2, 3));
           Integer sizes[4] = {size(one.A, 2), size(one.C, 1), size(three.A, 2), size(three.C, 1)};
         end Squares;",
    )
    .run();
    let e = std::f64::consts::E;
    assert_close(run.last("one.x[2]"), e - 1.0, 1e-5);
    assert_close(run.last("three.x[3]"), 3.0 * (1.0 - 1.0 / e), 1e-5);
    let sizes: Vec<f64> = (1..=4).map(|k| run.last(&format!("sizes[{k}]"))).collect();
    assert_eq!(sizes, [2.0, 1.0, 3.0, 2.0]);
}

/// The variables of a function get their values in the order of what they read, not of their declarations.
#[test]
fn variables_of_functions_may_be_declared_in_any_order() {
    let run = Case::text(
        "model Ordered
           function padded
             input Real b[:];
             input Integer wanted = twice;
             output Real x[size(b, 1) + more] = cat(1, b, zeros(more));
           protected
             Integer more = wanted - count;
             Integer twice = 2 * count;
             Integer count = size(b, 1);
           algorithm
             x[1] := x[1] + more;
           end padded;
           Real x[3] = padded({1, 2}, 3);
           Real y[4] = padded({time, 2});
         end Ordered;",
    )
    .run();
    assert_eq!(["x[1]", "x[2]", "x[3]"].map(|n| run.last(n)), [2.0, 2.0, 0.0]);
    assert_eq!(["y[1]", "y[2]", "y[4]"].map(|n| run.last(n)), [3.0, 2.0, 0.0]);
}

/// The least of truth values and of enumerations: they have an order (section 10.3.4).
#[test]
fn truth_values_and_enumerations_have_a_least_and_a_greatest() {
    let run = Case::text(
        "model Least
           type E = enumeration(a, b, c);
           Boolean b[3] = {time > 0.25, time > 0.75, true};
           Boolean all = min(b), any = max(b), both = min(b[1], b[2]), none = max({false, false});
           E e[2] = {if time > 0.5 then E.c else E.a, E.b};
           E low = min(e), high = max(e), other = max(e[1], E.a);
         end Least;",
    )
    .interval(0.1)
    .run();
    let at = |name: &str, time: f64| {
        let k = run.time.iter().position(|t| *t > time).unwrap();
        run.values(name).unwrap()[k]
    };
    for (name, expected) in [
        ("all", [0.0, 0.0, 0.0, 1.0]),
        ("any", [1.0; 4]),
        ("both", [0.0, 0.0, 0.0, 1.0]),
        ("none", [0.0; 4]),
        ("low", [1.0, 1.0, 2.0, 2.0]),
        ("high", [2.0, 2.0, 3.0, 3.0]),
        ("other", [1.0, 1.0, 3.0, 3.0]),
    ] {
        assert_eq!([0.15, 0.45, 0.55, 0.85].map(|t| at(name, t)), expected, "{name}");
    }
}

/// What a package inherits sees the constants and classes of that package, not those of its base.
#[test]
fn inherited_classes_see_the_constants_of_the_package_that_extends() {
    let package = "package Media
             partial package PM
               constant String mediumName = \"unusable\";
               constant String names[:] = {mediumName};
               constant Real refX[nX] = fill(1/nX, nX);
               final constant Integer nS = size(names, 1);
               constant Integer nX = nS;
               constant Boolean fixedX = false;
               constant Boolean explicit;
               constant Integer nXi = if fixedX then 0 else nS - 1;
               replaceable record State
                 Real p;
                 Real X[nX](start = refX);
               end State;
               replaceable partial function setState
                 input Real p;
                 input Real X[:] = refX;
                 output State s;
               end setState;
               replaceable partial function density
                 input State s;
                 output Real d;
               end density;
               replaceable partial model Base
                 Real p; 
                 Real Xi[nXi];
                 Real X[nX](start = refX);
                 State state;
               equation
                 Xi = X[1:nXi];
                 X[nX] = 1 - sum(Xi);
               end Base;
             end PM;
             package Air
               extends PM(names = {\"N2\", \"O2\", \"Ar\"}, refX = {0.7,0.2,0.1}, explicit = true, mediumName=\"air\");
               redeclare function extends setState
               algorithm
                 s := State(p = p, X = X);
               end setState;
               redeclare function extends density
               algorithm
                 d := if explicit then s.p*sum(s.X) else 0;
               end density;
               redeclare model extends Base
               equation
                 state = setState(p, X);
               end Base;
             end Air;
             package Water
               extends PM(explicit = false);
               redeclare function extends setState
               algorithm
                 s := State(p = p, X = X);
               end setState;
               redeclare function extends density
               algorithm
                 d := if explicit then 0 else s.p*2;
               end density;
             end Water;
             partial model Test
               replaceable package Medium = PM;
               Real d = Medium.density(Medium.setState(3));
               Medium.State state = Medium.setState(2 + time);
             end Test;
             model T1
               extends Test(redeclare package Medium = Air);
               Medium.Base medium(p = 1, Xi = Medium.refX[1:Medium.nXi], X(start=Medium.refX));
             end T1;
             model T2
               extends Test(redeclare package Medium = Water);
             end T2;
           end Media;";
    let air = Case::text(package).model("Media.T1").run();
    let mixture =
        |name: &str| (1..=3).map(|k| air.last(&format!("{name}[{k}]"))).collect::<Vec<_>>();
    assert_eq!(mixture("state.X"), [0.7, 0.2, 0.1]);
    assert_eq!(mixture("medium.state.X")[..2], [0.7, 0.2]);
    assert_close(air.last("d"), 3.0, 1e-12);
    let water = Case::text(package).model("Media.T2").run();
    assert_eq!([water.last("d"), water.last("state.X[1]"), water.last("state.p")], [6.0, 1.0, 3.0]);
}

/// The modifications of a function defined in short see the component that it is found in.
#[test]
fn functions_of_components_read_their_parameters() {
    let field = "package Field
           function std
             input Real r;
             input Integer kind = 0;
             input Real g = 1;
             output Real a;
           algorithm
             a := if kind == 1 then g*r else -g;
           end std;
           model World
             parameter Integer kind = 1;
             parameter Real g = 9.81;
             replaceable function acc = std(kind=kind, g=2*g);
           end World;
           model Body
             outer World world;
             Real a = world.acc(time);
           end Body;
           model T
             inner World world(g=5);
             Body b;
             Real c = world.acc(1);
           end T;
           model T1
             World world(g=5);
             Real c = world.acc(1);
           end T1;
         end Field;";
    for (model, name) in [("Field.T", "c"), ("Field.T", "b.a"), ("Field.T1", "c")] {
        assert_eq!(Case::text(field).model(model).run().last(name), 10.0);
    }
}

/// What comprehensions, reductions and loops run over may change while the model runs; what are subscripts
/// is known.
#[test]
fn iterators_run_over_what_changes() {
    let run = Case::text(
        "model Over
           record Tank Real level; end Tank;
           parameter Integer chosen[:] = {3, 1};
           Integer k = if time > 0.5 then 1 else 2;
           Real v[3] = {time, 2*time, 3};
           Tank low(level = time), high(level = 2);
           Real squares = sum(e^2 for e in v);
           Real most = max(e for e in v[1:2]);
           Real levels[:] = {t.level for t in {low, high}};
           Real some[:] = {v[i] for i in chosen};
           Real now[:] = {v[i] for i in {k, 3}};
           Real table[2, 2] = {x*y for x in {1.5, 2.5}, y in v[2:3]};
           Boolean large[3] = {x > 1.5 for x in v};
           Real total;
         algorithm
           total := 0;
           for e in v loop
             total := total + e;
           end for;
         end Over;",
    )
    .run();
    let last = |name: &str, n: usize| -> Vec<f64> {
        (1..=n).map(|k| run.last(&format!("{name}[{k}]"))).collect()
    };
    assert_eq!([run.last("squares"), run.last("most"), run.last("total")], [14.0, 2.0, 6.0]);
    assert_eq!(last("levels", 2), [1.0, 2.0]);
    assert_eq!(last("some", 2), [3.0, 1.0]);
    assert_eq!(last("now", 2), [1.0, 3.0]);
    assert_eq!(last("large", 3), [0.0, 1.0, 1.0]);
    let table = ["1,1", "1,2", "2,1", "2,2"].map(|k| run.last(&format!("table[{k}]")));
    assert_eq!(table, [3.0, 5.0, 4.5, 7.5]);
}

/// Types may be arrays: of locals, outputs and omitted inputs of functions, and of fields.
#[test]
fn types_that_are_arrays_have_their_sizes_in_functions() {
    let run = Case::text(
        "package Turns
           constant Integer n = 2;
           type Base = Real[3];
           type Vector extends Base(each unit = \"m\"); end Vector;
           type Pair = Vector[n];
           function unit_vector
             output Vector e;
           algorithm
             e[1] := 1;
           end unit_vector;
           function moved
             input Vector a;
             input Pair by;
             input Vector more = unit_vector();
             output Vector b;
           protected
             Vector t;
             Integer n = 7;
           algorithm
             t[1] := 5;
             for i in 2:3 loop
               t[i] := i;
             end for;
             b := a + t + by[1] + by[n - 5, :] + more;
           end moved;
           model Test
             Vector x = moved({time, 0, 0}, {{1, 2, 3}, {1, 1, 1}});
             Real h[2] = homotopy(actual = {time, 2}, simplified = {1, 1});
           end Test;
         end Turns;",
    )
    .run();
    let x = [1, 2, 3].map(|k| run.last(&format!("x[{k}]")));
    assert_eq!(x, [9.0, 5.0, 7.0]);
    assert_eq!([run.last("h[1]"), run.last("h[2]")], [1.0, 2.0]);
}

/// The same short class inherited twice is one, whatever its description.
#[test]
fn short_classes_inherited_twice_are_one() {
    let run = Case::text(
        "package Flow
           package Medium constant Real d = 1; end Medium;
           package Water extends Medium(d = 1000); end Water;
           partial model In replaceable package M = Medium; Real m; end In;
           partial model Out
             replaceable package M = Medium \"what flows\" annotation (choicesAllMatching = true);
             Real m \"mass\";
           end Out;
           model Pipe
             extends In(redeclare package M = Water);
             extends Out(redeclare package M = Water);
           equation
             m = M.d*time;
           end Pipe;
         end Flow;",
    );
    assert_eq!(run.run().last("m"), 1000.0);
}

/// At the start a truth value may follow from what is continuous later.
#[test]
fn initial_equations_choose_branches() {
    let run = Case::text(
        "model Branch
           function is_high
             input Real x;
             output Boolean b;
           algorithm
             b := x > 0.5;
           end is_high;
           final parameter Boolean high(fixed = false);
           Real x(start = 1, fixed = true);
         initial equation
           high = is_high(x);
         equation
           der(x) = if high then -1 else 1;
         end Branch;",
    );
    assert_eq!(run.run().last("der(x)"), -1.0);
}
