//@ case unknown_modifier
model Shaft
  //@ error[MO0203] 27-30
  Translational.Mass mass(mass = 1);
end Shaft;

//@ case misspelt_modifier
model Misspelt
  //@ error[MO0203] 34-40
  Translational.Mass mass(m = 1, v_strat = 2);
  //@ error[MO0203] 40-44
  Translational.Spring spring(c = 100, s_rl0 = 0.1);
  //@ error[MO0201] 17-23
  Translational.Damper2 damper;
equation
  connect(mass.flange, spring.flange_a);
end Misspelt;

//@ case unknown_attribute
model Start
  //@ error[MO0289] 10-14
  Real x(begin = 1);
equation
  der(x) = -x;
end Start;

//@ case wrong_type_modifier
model Switch
  //@ error[MO0212] 25-27
  parameter Integer n = 2.5;
  //@ error[MO0212] 30
  parameter Boolean closed = 1;
  Real x = n;
end Switch;

//@ case missing_each
model Chain
  //@ error[MO1230] 34-39
  Translational.Mass mass[3](m = {1, 2});
  //@ error[MO1230] 40
  Translational.Mass more[3](s_start = 1);
end Chain;

//@ case too_many_values
model Chain
  //@ error[MO1230] 34-42
  Translational.Mass mass[2](m = {1, 2, 3});
  //@ error[MO1230] 52-60
  Translational.Mass more[2](each m = 1, s_start = {0, 1, 2});
  Translational.Mass fine[2](m = {1, 2}, s(start = {0, 1}));
end Chain;

//@ case modified_twice
package Modified
  type Angle = Real(final unit = "rad", displayUnit = "deg");
  model Part
    parameter Real gain = 1;
    parameter Real offset = 0;
  end Part;
  replaceable model Exchangeable
    Real x = 1;
  end Exchangeable;
  model Extended
    //@ error[MO0262] 13-24
    extends Exchangeable;
  end Extended;
  //@ error[MO1290] 13-17
  connector Mixed
    extends Real;
    Real more = 1;
  end Mixed;
  model Same
    model Inner
      Real x = 1;
    end Inner;
  end Same;
  model Twice
    extends Same;
    //@ error[MO0292] 11-15
    model Inner
      Real x = 2;
    end Inner;
  end Twice;
  model Whole
    Part part;
    replaceable model Chosen = Exchangeable;
  end Whole;
  model Test
    //@ error[MO0264] 37-44
    Part part(gain = 2, offset = 1, gain = 3);
    //@ error[MO0264] 37-44
    //@ error[MO0264] 95-101
    Whole whole(part.gain = 2, part(gain = 3, offset = 1), part(offset(min = 0)), part.offset(min = 1));
    //@ error[MO0264] 82-87
    Whole other(redeclare replaceable model Chosen = Same.Inner, redeclare model Chosen = Twice.Inner);
    //@ error[MO0209] 22-26
    Angle phi(unit = "deg") = 1;
    Angle psi(displayUnit = "rad") = 1;
    Extended extended;
    Mixed mixed;
    Twice twice;
  end Test;
end Modified;

//@ case the_outermost_wins
package P
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
end P;
//@ run
//@ expect h.one.x, h.two.x = 8, 22
//@ expect h.many[1].x, h.many[2].x = 8, 9
//@ run set=h.one.a=4 set=h.many[2].b=2
//@ expect h.one.x, h.many[2].x = 9, 10

//@ case sizes_of_fields_of_a_record_that_is_passed_on
// The record as a whole overrides what its class says of a field of a field, also about sizes.
package Records
  record Curve
    parameter Real V[:];
    parameter Real dp[size(V, 1)];
  end Curve;
  record Data
    parameter Curve curve(V = {0, 0}, dp = {0, 0});
    final parameter Real V_max = curve.V[end];
  end Data;
  model Inner
    parameter Data data;
    Real y = data.V_max*time + size(data.curve.V, 1) + sum(data.curve.dp);
  end Inner;
  model Outer
    replaceable parameter Data data(curve = standard);
    parameter Real d = 2;
    parameter Curve standard(V = d*{0, 1, 1.5}, dp = d*{3, 2, 1});
    Inner inner_one(final data = data);
  end Outer;
  model Top
    Outer a(redeclare Data data(curve = a.standard), d = 3);
    Outer b(d = 4);
    Inner c(data(curve(V = {1, 7}, dp = {0, 1})));
  end Top;
end Records;
//@ expect a.inner_one.y, b.inner_one.y, c.y = 4.5 + 3 + 18, 6 + 3 + 24, 7 + 2 + 1

//@ case attributes_of_elements_are_set_from_outside
//@ run stop=1 set=x[2].start=5 set=z[2,1].fixed=false set=z[1].start=7
model Elements
  Real x[3](each start = 1, each fixed = true);
  Real z[2, 2](each start = 2, each fixed = true);
equation
  der(x) = zeros(3);
  der(z) = zeros(2, 2);
initial equation
  z[2, 1] = 9;
end Elements;
//@ expect x[1], x[2], x[3] = 1, 5, 1
//@ expect z[1,1], z[1,2], z[2,1], z[2,2] = 7, 7, 9, 2

//@ case an_attribute_of_an_element_that_does_not_exist
//@ run stop=1 set=x[4].start=5
model Beyond
  Real x[3](each start = 1, each fixed = true);
equation
  der(x) = zeros(3);
end Beyond;
//@ error[MO0241] nowhere
//@ status 2

//@ case a_package_or_function_is_redeclared
// Calls and constants do not see modifications of local packages and functions.
package Shop
  package Air
    constant Real c = 1;
  end Air;
  model Machine
    replaceable package Medium = Air;
    function gain
      input Real x;
      input Real k = 2;
      output Real y = k*x;
    end gain;
    Real z = Medium.c + gain(3);
  end Machine;
  model Derived
    //@ error[MO0200] 21-26
    extends Machine(Medium(c = 5));
  end Derived;
  model Top
    //@ error[MO0200] 15-20
    Machine a(Medium(c = 5));
    //@ error[MO0200] 15-18
    Machine b(gain(k = 5));
    Machine c(redeclare package Medium = Air(c = 7));
    Derived d;
  end Top;
end Shop;

//@ case each_of_a_qualified_name
// `each c.a` is `c(each a)`: the example of section 7.2.5 of the specification.
package Each
  model C
    parameter Real a[3];
    parameter Real d;
  end C;
  model B
    C c[5](each a = {1, 2, 3}, d = {1, 2, 3, 4, 5});
    parameter Real b = 0;
  end B;
  model D
    B b(each c.a = {3, 4, 5}, c.d = {2, 3, 4, 5, 6});
  end D;
end Each;
//@ expect b.c[1].a[2], b.c[5].a[3], b.c[1].d, b.c[5].d = 4, 5, 2, 6
