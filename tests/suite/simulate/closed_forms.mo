//@ case circuit_of_connectors
// Thevenin: 7.5 V behind 750 Ohm.
package Electric
  connector Pin
    Real v(unit = "V");
    flow Real i(unit = "A");
  end Pin;
  partial model TwoPin
    Pin p;
    Pin n;
    Real v(unit = "V");
    Real i(unit = "A");
  equation
    v = p.v - n.v;
    i = p.i;
    p.i + n.i = 0;
  end TwoPin;
  model Resistor
    extends TwoPin;
    parameter Real R(unit = "Ohm");
  equation
    v = R*i;
  end Resistor;
  model Capacitor
    extends TwoPin;
    parameter Real C(unit = "F");
  equation
    C*der(v) = i;
  end Capacitor;
  model Source
    extends TwoPin;
    parameter Real V(unit = "V");
  equation
    v = V;
  end Source;
  model Ground
    Pin p;
  equation
    p.v = 0;
  end Ground;
  model RC
    Source source(V = 10);
    Resistor upper(R = 1000);
    Resistor lower(R = 3000);
    Capacitor c(C = 1e-6, v(start = 0, fixed = true));
    Ground ground;
  equation
    connect(source.p, upper.p);
    connect(upper.n, c.p);
    connect(upper.n, lower.p);
    connect(c.n, ground.p);
    connect(lower.n, ground.p);
    connect(source.n, ground.p);
    annotation(experiment(StopTime = 5e-3, Tolerance = 1e-9));
  end RC;
end Electric;
//@ expect each c.v = 7.5*(1 - exp(-time/0.75e-3)) abs 1e-7
//@ expect each upper.i = lower.i + c.i abs 1e-12

//@ case pendulum_of_index_3
// It keeps its length and its energy.
model Pendulum "Cartesian, hence index 3"
  parameter Real L = 1;
  parameter Real g = 9.81;
  Real x(start = 0.5, fixed = true);
  Real y(start = -0.8660254037844386);
  Real vx(start = 0, fixed = true);
  Real vy;
  Real F;
  Real energy = (vx^2 + vy^2)/2 + g*y;
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -F*x/L;
  der(vy) = -F*y/L - g;
  x^2 + y^2 = L^2;
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end Pendulum;
// The period by the arithmetic-geometric mean, amplitude asin(0.5).
//@ let mean(a, b, n) = if n == 0 then a else mean((a + b)/2, sqrt(a*b), n - 1)
//@ let period = 2*pi/mean(1, cos(asin(0.5)/2), 8)/sqrt(9.81)
//@ expect each sqrt(x^2 + y^2) = 1 abs 1e-9
//@ expect each energy = -9.81*0.8660254037844386 abs 1e-6
//@ run stop=2.04098988951913 interval=2.04098988951913
//@ expect time = period rel 1e-14
//@ expect x = 0.5 abs 1e-6

//@ case rigidly_connected_masses
// The force between them moves the second mass alone.
model Rigid "Two masses on one flange: one speed, index 2"
  Translational.Mass a(m = 1, s_start = 0.1);
  Translational.Mass b(m = 3, s(fixed = false), v(fixed = false));
  Translational.Spring spring(c = 100);
  Translational.Fixed wall;
equation
  connect(a.flange, b.flange);
  connect(b.flange, spring.flange_b);
  connect(spring.flange_a, wall.flange);
  annotation(experiment(StopTime = 2, Tolerance = 1e-9));
end Rigid;
//@ expect each a.s = 0.1*cos(5*time) abs 1e-7
//@ expect each a.s = b.s
//@ expect each a.flange.f = a.a rel 1e-9

//@ case gear
// Seen from the load: i tau = (J_load + i^2 J_motor) der(w).
package Rotational
  connector Shaft
    Real phi;
    flow Real tau;
  end Shaft;
  model Inertia
    parameter Real J;
    Shaft shaft;
    Real w(stateSelect = StateSelect.prefer);
  equation
    der(shaft.phi) = w;
    J*der(w) = shaft.tau;
  end Inertia;
  model Gear
    parameter Real i "Speed of a over speed of b";
    Shaft a;
    Shaft b;
  equation
    a.phi = i*b.phi;
    0 = i*a.tau + b.tau;
  end Gear;
  model Torque
    parameter Real tau;
    Shaft shaft;
  equation
    shaft.tau = -tau;
  end Torque;
  model Drive
    Inertia motor(J = 0.01);
    Inertia load(J = 4, w(start = 0, fixed = true), shaft(phi(start = 0, fixed = true)));
    Gear gear(i = 10);
    Torque torque(tau = 2);
  equation
    connect(torque.shaft, motor.shaft);
    connect(motor.shaft, gear.a);
    connect(gear.b, load.shaft);
    annotation(experiment(StopTime = 1));
  end Drive;
end Rotational;
//@ let acceleration = 10*2/(4 + 100*0.01)
//@ expect load.w = acceleration rel 1e-9
//@ expect load.shaft.phi = acceleration/2 rel 1e-9
//@ expect motor.w = 10*acceleration rel 1e-9

//@ case chain_of_masses
model Chain "Masses between springs, walls at both ends, released in an eigenform"
  parameter Integer N = 5;
  parameter Integer form = 1;
  parameter Real pi = 3.141592653589793;
  Translational.Mass mass[N](each m = 2, s_start = {sin(k*form*pi/(N + 1)) for k in 1:N});
  Translational.Spring spring[N + 1](each c = 800);
  Translational.Fixed wall[2];
equation
  connect(wall[1].flange, spring[1].flange_a);
  for k in 1:N loop
    connect(spring[k].flange_b, mass[k].flange);
    connect(mass[k].flange, spring[k + 1].flange_a);
  end for;
  connect(spring[N + 1].flange_b, wall[2].flange);
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Chain;
//@ let omega(angle) = 2*sqrt(800/2)*sin(angle/2)
//@ let swing(k, angle) = sin(k*angle)*cos(omega(angle)*time)
//@ run set=N=5 set=form=1
//@ expect each mass[1].s = swing(1, 1*pi/6) abs 1e-6
//@ expect each mass[2].s = swing(2, 1*pi/6) abs 1e-6
//@ expect each mass[3].s = swing(3, 1*pi/6) abs 1e-6
//@ expect each mass[4].s = swing(4, 1*pi/6) abs 1e-6
//@ expect each mass[5].s = swing(5, 1*pi/6) abs 1e-6
//@ run set=N=5 set=form=3
//@ expect each mass[1].s = swing(1, 3*pi/6) abs 1e-6
//@ expect each mass[2].s = swing(2, 3*pi/6) abs 1e-6
//@ expect each mass[3].s = swing(3, 3*pi/6) abs 1e-6
//@ expect each mass[4].s = swing(4, 3*pi/6) abs 1e-6
//@ expect each mass[5].s = swing(5, 3*pi/6) abs 1e-6
//@ run set=N=12 set=form=2
//@ expect each mass[1].s = swing(1, 2*pi/13) abs 1e-6
//@ expect each mass[2].s = swing(2, 2*pi/13) abs 1e-6
//@ expect each mass[3].s = swing(3, 2*pi/13) abs 1e-6
//@ expect each mass[4].s = swing(4, 2*pi/13) abs 1e-6
//@ expect each mass[5].s = swing(5, 2*pi/13) abs 1e-6
//@ expect each mass[6].s = swing(6, 2*pi/13) abs 1e-6
//@ expect each mass[7].s = swing(7, 2*pi/13) abs 1e-6
//@ expect each mass[8].s = swing(8, 2*pi/13) abs 1e-6
//@ expect each mass[9].s = swing(9, 2*pi/13) abs 1e-6
//@ expect each mass[10].s = swing(10, 2*pi/13) abs 1e-6
//@ expect each mass[11].s = swing(11, 2*pi/13) abs 1e-6
//@ expect each mass[12].s = swing(12, 2*pi/13) abs 1e-6

//@ case robertson
// y(40 s) to the digits commonly printed for this problem (Robertson 1966; the example of CVODE and IDA).
model Robertson
  Real y[3](start = {1, 0, 0}, each fixed = true, nominal = {1, 1e-5, 1});
equation
  der(y[1]) = -0.04*y[1] + 1e4*y[2]*y[3];
  der(y[2]) = 0.04*y[1] - 1e4*y[2]*y[3] - 3e7*y[2]^2;
  der(y[3]) = 3e7*y[2]^2;
  annotation(experiment(StopTime = 40, Tolerance = 1e-8));
end Robertson;
//@ expect y[1] = 0.715827 rel 1e-5
//@ expect y[2] = 9.1855e-6 rel 1e-4
//@ expect y[3] = 0.284164 rel 1e-5
//@ expect each y[1] + y[2] + y[3] = 1 abs 1e-12
