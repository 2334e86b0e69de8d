//@ case equation_missing
//@ check
package Works
  model Motor
    //@ error[MO0401] 16
    input Real u;
    output Real w;
  equation
    w = 2*u;
  end Motor;
  model Cart
    Motor motor;
    Real v = 3*motor.w;
  end Cart;
end Works;

//@ case equation_too_many
//@ check
package Works
  model Motor
    input Real u;
    output Real w;
  equation
    w = 2*u;
  end Motor;
  model Cart
    Motor motor;
    Real v = 3*motor.w;
  equation
    //@ error[MO0402] 5-18
    motor.u = time;
    motor.u = 1 - v;
  end Cart;
end Works;

//@ case state_given_by_an_equation
//@ check
package Works
  connector Port
    Real p(unit = "Pa");
    flow Real q(unit = "m3/s");
  end Port;
  model Source
    parameter Real p0(unit = "Pa") = 2e5;
    Port port;
  equation
    port.p = p0;
  end Source;
  model Pipe
    parameter Real k(unit = "m3/(s.Pa)") = 1e-8;
    Port a;
    Port b;
  equation
    a.q = k*(a.p - b.p);
    a.q + b.q = 0;
  end Pipe;
  model Vessel
    parameter Real c(unit = "m3/Pa") = 1e-7;
    Port port;
  equation
    c*der(port.p) = port.q;
  end Vessel;
  model Plant
    Source source;
    Pipe pipe;
    Vessel vessel;
  equation
    connect(source.port, pipe.a);
    connect(pipe.b, vessel.port);
    //@ error[MO0402] 5-23
    vessel.port.p = 1e5;
  end Plant;
end Works;

//@ case input_connected_and_given
//@ check
package Works
  connector In = input Real;
  connector Out = output Real;
  block Gain
    In u;
    Out y;
  equation
    y = 2*u;
  end Gain;
  block Ramp
    Out y;
  equation
    y = time;
  end Ramp;
  model Cart
    Ramp ramp;
    Gain gain;
    Gain other;
  equation
    connect(ramp.y, gain.u);
    connect(gain.y, other.u);
    //@ error[MO0402] 5-14
    gain.u = 3;
  end Cart;
end Works;

//@ case connectors_of_two_kinds
//@ check
package Works
  connector Flange
    Real s;
    flow Real f;
  end Flange;
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  model Spring
    Flange a;
  equation
    a.f = 3*a.s;
  end Spring;
  model Ground
    Pin p;
  equation
    p.v = 0;
  end Ground;
  model Cart
    Spring spring;
    Ground ground;
  equation
    //@ error[MO1211] 5-31
    connect(spring.a, ground.p);
  end Cart;
end Works;

//@ case unit_of_another_dimension
//@ check
model Cart
  //@ warning[MO0320] 8
  Real v(unit = "m/s") = 2*time;
  //@ warning[MO0320] 8
  Real s(unit = "m") = v;
end Cart;

//@ case celsius_for_kelvin
//@ check
model Oven
  parameter Real T_set(unit = "degC") = 20;
  Real T(unit = "K");
equation
  //@ warning[MO0323] 3-11
  T = T_set;
end Oven;

//@ case start_given_twice
//@ check
model Cart
  //@ error[MO0408] 8
  Real v(start = 1, fixed = true);
initial equation
  v = 2;
equation
  der(v) = -v;
end Cart;

//@ case rates_of_one_state_for_two
//@ check
model Cart
  //@ error[MO0408] 8
  Real x(start = 0, fixed = true);
  Real v;
initial equation
  der(x) = 0;
  der(v) = 0;
equation
  der(x) = 4 - x + v;
  der(v) = 3 - v;
end Cart;

//@ case equations_that_repeat_each_other
//@ check
model Cart
  Real a;
  Real b;
  Real v(start = 0, fixed = true);
equation
  a = b + 1;
  //@ error[MO0410] 3-11
  b = a - 1;
  der(v) = a;
end Cart;

//@ case integers_in_a_circle
//@ check
model Cart
  Integer a;
  Integer b;
  Real v = a*time;
equation
  //@ error[MO0410] 3-11
  a = b + 1;
  b = a - 1;
end Cart;

//@ case equations_that_contradict_each_other
//@ check
model Cart
  Real a;
  Real b;
equation
  a = b + 1;
  //@ error[MO0410] 3-11
  b = a + 1;
end Cart;

//@ case recursion_without_end
//@ check
model Cart
  function f
    input Real u;
    output Real y;
  algorithm
    //@ error[MO1205] 10-17
    y := f(u + 1);
  end f;
  parameter Real p = f(1);
  Real v = p*time;
end Cart;

//@ case reinit_in_an_algorithm
//@ check
model Cart
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
algorithm
  when x > 0.5 then
    //@ error[MO1265] 5-16
    reinit(x, 0);
  end when;
end Cart;

//@ case alternating_assignments
//@ check
model Cart
  discrete Real x(start = 0, fixed = true);
equation
  when time > 0.2 then
    x = 1;
  end when;
  //@ error[MO0306] 3-
  when time > 0.4 then
    x = 2;
  end when;
end Cart;
