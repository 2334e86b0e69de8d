//@ case singular
model Levels
  //@ error[MO0401] 8
  Real b;
  Real a;
  Real c;
equation
  //@ error[MO0402] 3-10
  a = time;
  a = sin(time);
  b + c = 1;
end Levels;

//@ case too_few_equations
model Pendulum
  //@ error[MO0401] 8-10
  Real phi(start = 1);
  Real w;
  Real torque;
equation
  der(phi) = w;
  der(w) = torque - sin(phi);
end Pendulum;

//@ case too_many_equations
model Pendulum
  Real phi(start = 1);
  Real w;
equation
  der(phi) = w;
  //@ error[MO0402] 3-20
  der(w) = -sin(phi);
  w = 2*phi;
end Pendulum;

//@ case singular_connection
//@ error[MO0402] at lib/Pneumatics/Source.mo:30:5-14
//@ error[MO0401] at lib/Pneumatics/Port.mo:4:27-32
model Supplies
  Pneumatics.Source left(p = 2e5);
  Pneumatics.Source right(p = 3e5);
equation
  connect(left.port, right.port);
end Supplies;

//@ case unconnected_mass
//@ error[MO0401] at lib/Translational/Flange.mo:3:18
//@ error[MO0402] at lib/Translational/Damper.mo:16:3-16
model Drive
  Translational.Mass   mass(m = 1);
  //@ warning[MO0334] 24-29
  Translational.Spring spring(c = 100);
  //@ warning[MO0327] 24-29
  Translational.Damper damper(d = 2);
equation
  connect(spring.flange_b, mass.flange);
end Drive;

//@ case equations_that_repeat_each_other
// The same law in two forms: what follows from it would be arbitrary.
model Level
  Real low;
  Real high;
  Real volume(start = 0, fixed = true);
equation
  high = low + 1;
  //@ error[MO0410] 3-16
  low = high - 1;
  der(volume) = high;
end Level;

//@ case equations_that_repeat_each_other_by_rounding
// 0.1*3 is not 0.3 in floating point.
model Level
  parameter Real k = 0.1;
  Real low;
  Real high;
  Real volume(start = 0, fixed = true);
equation
  k*high = 3*k*low;
  //@ error[MO0410] 3-26
  0.1*high - 0.3*low = 0.0;
  der(volume) = high;
end Level;

//@ case equations_that_contradict_each_other
model Split
  Real a;
  Real b;
  Real x(start = 1, fixed = true);
equation
  a + b = x;
  //@ error[MO0410] 3-23
  2*a + 2*b = 2*x + 1.0;
  der(x) = -x;
end Split;

//@ case a_coefficient_that_is_zero
model Tank
  parameter Real area = 0;
  Real level(start = 1, fixed = true);
equation
  //@ error[MO0410] 3-26
  area*der(level) = -level;
end Tank;

//@ case a_circuit_without_ground
// The currents do not depend on the level of the potentials.
model Bridge
  Real v1;
  Real v2;
  Real v3;
  Real i(start = 2, fixed = true);
  Real power;
equation
  v1 - v2 = 5*i;
  //@ warning[MO0410] 3-15
  v2 - v3 = 7*i;
  v3 - v1 = -12*i;
  der(i) = v3 - v1;
  power = (v1 - v2)*i;
end Bridge;
//@ run stop=0.1 tolerance=1e-9
//@ expect i = 2*exp(-1.2) rel 1e-7

//@ case boolean_that_holds_itself
model Latch
  Boolean a;
  Real x = if a then 1 else 2;
equation
  //@ error[MO0410] 3-16
  a = a or false;
end Latch;

//@ case boolean_loop_with_a_solution
model Latch
  Boolean a = b and time > 0.5;
  Boolean b = time > 0.2 or a;
end Latch;
//@ expect a at 0.4, 0.7 = 0, 1
