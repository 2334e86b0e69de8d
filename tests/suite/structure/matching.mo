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
//@ error[MO0402] at lib/Translational/Flange.mo:4:20
model Drive
  Translational.Mass   mass(m = 1);
  Translational.Spring spring(c = 100);
  Translational.Damper damper(d = 2);
equation
  connect(spring.flange_b, mass.flange);
end Drive;
