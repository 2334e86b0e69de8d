//@ case pendulum_and_four_bar
//@ run model=Planar.FourBar stop=2 tolerance=1e-9
// Planar mechanics with a matrix of four elements for one angle. The loop is closed by the residual of
// `equalityConstraint`; independent of that are Freudenstein's equation of a four-bar linkage and
// the sum of the energies.
package Planar
  record Orientation
    Real T[2, 2];
    function equalityConstraint
      input Orientation R1;
      input Orientation R2;
      output Real residue[1];
    algorithm
      residue := {R1.T[1, 1]*R2.T[1, 2] - R1.T[1, 2]*R2.T[1, 1]};
    end equalityConstraint;
  end Orientation;

  connector Frame
    Real r[2];
    Orientation R;
    flow Real f[2];
    flow Real t;
  end Frame;

  model World
    Frame b;
  equation
    Connections.root(b.R);
    b.r = {0, 0};
    b.R.T = [1, 0; 0, 1];
  end World;

  model Rod
    parameter Real l;
    Frame a, b;
    Real e[2] = transpose(a.R.T)*{l, 0};
  equation
    Connections.branch(a.R, b.R);
    b.R = a.R;
    b.r = a.r + e;
    a.f + b.f = {0, 0};
    a.t + b.t + e[1]*b.f[2] - e[2]*b.f[1] = 0;
  end Rod;

  model Revolute
    Frame a, b;
    Real phi;
    Real w;
  equation
    Connections.branch(a.R, b.R);
    w = der(phi);
    b.r = a.r;
    if Connections.rooted(a.R) then
      b.R.T = [cos(phi), sin(phi); -sin(phi), cos(phi)]*a.R.T;
    else
      a.R.T = [cos(phi), -sin(phi); sin(phi), cos(phi)]*b.R.T;
    end if;
    a.f + b.f = {0, 0};
    a.t + b.t = 0;
    b.t = 0;
  end Revolute;

  model Mass
    parameter Real m = 1;
    Frame a;
    Real v[2];
    Real energy = m*(v[1]^2 + v[2]^2)/2 + m*10*a.r[2];
  equation
    Connections.potentialRoot(a.R);
    v = der(a.r);
    m*der(v) = a.f - {0, 10*m};
    a.t = 0;
  end Mass;

  model Pendulum
    World world;
    Revolute joint(phi(start = 0.2, fixed = true), w(start = 0, fixed = true));
    Rod rod(l = 0.5);
    Mass mass(m = 2);
  equation
    connect(world.b, joint.a);
    connect(joint.b, rod.a);
    connect(rod.b, mass.a);
  end Pendulum;

  model FourBar
    World world;
    Rod ground(l = 2);
    Revolute A(phi(start = 1.2, fixed = true), w(start = 0, fixed = true));
    Revolute B(phi(start = -0.9));
    Revolute C(phi(start = 1.2));
    Revolute D(phi(start = 1.6));
    Rod crank(l = 1), coupler(l = 1.8), rocker(l = 1.5);
    Mass first(m = 1), second(m = 2);
  equation
    connect(world.b, A.a);
    connect(A.b, crank.a);
    connect(crank.b, B.a);
    connect(crank.b, first.a);
    connect(B.b, coupler.a);
    connect(coupler.b, C.a);
    connect(world.b, ground.a);
    connect(ground.b, D.a);
    connect(D.b, rocker.a);
    connect(rocker.b, second.a);
    connect(C.b, rocker.b);
  end FourBar;
end Planar;
//@ let K3 = (1 - 1.8^2 + 1.5^2 + 4)/(2*1*1.5)
//@ expect each cos(A.phi - D.phi) = 2*cos(D.phi) - 2/1.5*cos(A.phi) + K3 abs 1e-7
//@ let A = cos(1.2) - 2 - 2/1.5*cos(1.2) + K3
//@ let C = 2 - (2/1.5 + 1)*cos(1.2) + K3
//@ let rocker_at_start = 2*atan((2*sin(1.2) - sqrt(4*sin(1.2)^2 - 4*A*C))/(2*A))
//@ expect each first.energy + second.energy = 10*sin(1.2) + 20*1.5*sin(rocker_at_start) abs 1e-4
//@ run model=Planar.Pendulum stop=3 tolerance=1e-9
//@ expect each joint.w^2 = 2*10/0.5*(sin(0.2) - sin(joint.phi)) abs 1e-5

//@ case spanning_forest
//@ snapshot flat
// A ring of three: the connections are taken in their order, so the last one is broken, and the
// component of the lowest priority is the root.
package Ring
  record Reference
    Real gamma;
    function equalityConstraint
      input Reference a;
      input Reference b;
      output Real residue[0];
    algorithm
      assert(abs(a.gamma - b.gamma) < 1e-6, "the angles should be equal");
    end equalityConstraint;
  end Reference;
  connector Pin
    Real v;
    flow Real i;
    Reference reference;
  end Pin;
  model Part
    parameter Integer priority = 0;
    parameter Real R = 1;
    parameter Real V = 0;
    Pin p, n;
  equation
    Connections.branch(p.reference, n.reference);
    Connections.potentialRoot(p.reference, priority);
    if Connections.isRoot(p.reference) then
      p.reference.gamma = priority + time;
    end if;
    p.reference.gamma = n.reference.gamma;
    p.i + n.i = 0;
    p.v - n.v = R*p.i + V;
  end Part;
  model Ground
    Pin p(v = 0);
  equation
    Connections.potentialRoot(p.reference, 9);
  end Ground;
  model Circuit
    Part first(priority = 3, V = 6), second(priority = 1), third(priority = 2);
    Ground ground;
  equation
    connect(first.n, second.p);
    connect(second.n, third.p);
    connect(third.n, first.p);
    connect(ground.p, first.p);
  end Circuit;
end Ring;
//@ expect first.p.reference.gamma, third.n.reference.gamma = 1 + 1, 1 + 1
//@ expect first.p.i, second.p.i = -2, -2
//@ expect flat has 1 "'second.p.reference.gamma' = 'second.priority' + time"

//@ case arrays_and_elements
// An array of connectors and a connector of each component: the graph has three cycles, of which two
// lie between connections alone.
package Star
  record Reference
    Real gamma;
    function equalityConstraint
      input Reference a;
      input Reference b;
      output Real residue[0];
    algorithm
    end equalityConstraint;
  end Reference;
  connector Pin
    Real v;
    flow Real i;
    Reference reference;
  end Pin;
  model Source
    Pin p;
  equation
    Connections.root(p.reference);
    p.reference.gamma = time;
    p.v = 1;
  end Source;
  model Resistor
    Pin p, n;
  equation
    Connections.branch(p.reference, n.reference);
    p.reference.gamma = n.reference.gamma;
    p.i + n.i = 0;
    p.v - n.v = p.i;
  end Resistor;
  model Ground
    Pin p;
  equation
    Connections.potentialRoot(p.reference, 10);
    p.v = 0;
  end Ground;
  model Fan
    Pin pins[3];
    Resistor resistors[3];
    Pin common;
  equation
    connect(pins, resistors.p);
    for k in 1:3 loop
      connect(resistors[k].n, common);
    end for;
  end Fan;
  model Circuit
    Source source;
    Fan fan;
    Ground ground;
  equation
    for k in 1:3 loop
      connect(source.p, fan.pins[k]);
    end for;
    connect(fan.common, ground.p);
  end Circuit;
end Star;
//@ expect ground.p.i, ground.p.reference.gamma = 3, 1 abs 1e-12

//@ case wrong_graphs
package Wrong
  record Reference
    Real gamma;
    function equalityConstraint
      input Reference a;
      input Reference b;
      output Real residue[0];
    algorithm
    end equalityConstraint;
  end Reference;
  connector Pin
    Real v;
    flow Real i;
    Reference reference;
  end Pin;
  model Part
    Pin p, n;
  equation
    //@ warning[MO0352] 5-48
    Connections.branch(p.reference, n.reference);
    p.reference.gamma = n.reference.gamma;
    p.i + n.i = 0;
    p.v - n.v = p.i;
    //@ error[MO0351] 5-48
    Connections.branch(n.reference, p.reference);
    //@ error[MO0350] 22-24
    Connections.root(p.v);
    //@ error[MO0353] 5-44
    Connections.uniqueRoot(p.reference, "m");
  end Part;
  model Circuit
    Part part;
  equation
    //@ error[MO1352] 25-32
    part.p.v = inStream(part.p.v);
  end Circuit;
end Wrong;
