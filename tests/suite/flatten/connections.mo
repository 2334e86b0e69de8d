//@ case one_node_and_one_open_end
//@ snapshot flat
// A node of two: the potentials are equal, the flows add up to zero, and an open end carries none.
model Node
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  model Leak
    Pin p;
    Pin open;
    parameter Real G = 1;
  equation
    p.i = G*p.v;
    open.v = 0;
  end Leak;
  model Source
    Pin p(v = time);
  end Source;
  Leak a(G = 2);
  Source source;
equation
  connect(a.p, source.p);
end Node;
//@ expect flat has 3 " = 0.0;"
//@ expect a.p.i, source.p.i = 2, -2

//@ case mismatched_connectors
model Mixed
  Translational.Mass mass(m = 1);
  Pneumatics.Volume  tank(V_0 = 1);
equation
  //@ error[MO1211] 3-33
  connect(mass.flange, tank.port);
end Mixed;

//@ case not_a_connector
model Mixed
  Translational.Mass  mass(m = 1);
  Translational.Fixed wall;
equation
  //@ error[MO0230] 11-14
  connect(mass, wall.flange);
end Mixed;

//@ case not_plug_compatible
package P
  connector Signal = input Real;
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  connector Half
    input Real v;
    output Real i;
  end Half;
  model Part
    Pin p;
    Half h;
  equation
    p.v = 2*p.i;
    h.i = h.v;
  end Part;
  model Top
    Part one;
    Part two;
    Real x = 1;
    Real y;
  equation
    //@ error[MO1211] 5-25
    connect(one.p, two.h);
    //@ error[MO0230] 13
    connect(x, y);
    if time > 0.5 then
      //@ error[MO1272] 7-27
      connect(one.p, two.p);
    end if;
  end Top;
end P;

//@ case restrictions
package Restrictions
  connector Input = input Real;
  connector Output = output Real;
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  connector Plug
    parameter Integer phases = 3;
    constant Real frequency = 50;
    Real v;
    flow Real i;
  end Plug;
  connector Socket
    Integer phases;
    constant Real frequency = 50;
    Real v;
    flow Real i;
  end Socket;
  connector Signal
    Real e;
    flow Real f;
    input Real u;
  end Signal;

  model Source
    Output y = 1;
  end Source;
  model Sink
    Input u;
  end Sink;
  model Outlet
    Plug plug(v = 1);
  end Outlet;
  model Device
    Plug plug(frequency = 60);
  end Device;
  model Adapter
    Socket socket(phases = 3);
  end Adapter;

  model System
    Source source, other;
    Sink sink;
    Outlet outlet;
    Device device;
    Adapter adapter;
    //@ error[MO1208] 18-20
    constant Pin pin;
    //@ error[MO1209] 18-23
    input Signal signal(e = 1, u = 2);
  equation
    //@ error[MO0246] 5-29
    connect(source.y, sink.u);
    connect(sink.u, other.y);
    //@ error[MO1291] 5-37
    connect(outlet.plug, device.plug);
    //@ error[MO1211] 5-40
    connect(outlet.plug, adapter.socket);
  end System;
end Restrictions;

//@ case cardinality
// Connections count from both sides.
model Count
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
end Count;
//@ expect a.n, b.n, c.n = 2, 3, 2
//@ expect a.none, b.q.v = 0, 5

//@ case open_end
// The flow of an open end is zero, which is legal: a mass may end a line. Through a resistor nothing flows then.
package Open
  connector Flange
    Real s(unit = "m");
    flow Real f(unit = "N");
  end Flange;
  model Spring
    parameter Real c(unit = "N/m") = 100;
    Flange a;
    Flange b;
  equation
    b.f = -a.f;
    a.f = c*(a.s - b.s);
  end Spring;
  model Mass
    parameter Real m(unit = "kg") = 1;
    Flange a;
    Flange b;
    Real v(unit = "m/s", start = 0, fixed = true);
  equation
    a.s = b.s;
    der(a.s) = v;
    m*der(v) = a.f + b.f;
  end Mass;
  model Line
    Mass first(a.s(start = 0.1, fixed = true));
    Mass last(a.s(start = 0, fixed = true));
    Spring spring;
    //@ warning[MO0334] 12-15
    Spring open;
  equation
    connect(first.b, spring.a);
    connect(spring.b, last.a);
    connect(last.b, open.a);
  end Line;
end Open;
//@ expect open.a.f, last.b.f = 0

//@ case arrays_of_vectors
// A matrix of components, and a component with a vector of connectors for each of its rows, whose number may be the
// same as that of the elements.
package Rows
  connector In = input Real;
  connector Out = output Real;
  block Gain
    parameter Real k = 1;
    Out y = k;
  end Gain;
  block Sum
    parameter Integer n = 1;
    In u[n];
    Out y = sum(u);
  end Sum;
  model Matrix
    parameter Integer rows = 2;
    parameter Integer columns = 3;
    Gain gain[rows, columns](k = {{1, 2, 3}, {10, 20, 30}});
    Gain single[rows, 1](k = {{4}, {5}});
    Sum sum[rows](each n = columns);
    Sum alone[rows](each n = 1);
  equation
    connect(gain.y, sum.u);
    connect(single.y, alone.u);
  end Matrix;
end Rows;
//@ expect sum[1].y, sum[2].y = 6, 60
//@ expect alone[1].y, alone[2].y = 4, 5

//@ case connectors_that_no_element_has
// A conditional connector of each component of an array, which all are absent, whatever its size.
package Conditional
  connector In = input Real;
  connector Out = output Real;
  block Part
    parameter Boolean has = false;
    parameter Integer n = 2;
    In u if has;
    In list[n] if has;
    Out y = 7;
  end Part;
  block Source
    parameter Integer n = 3;
    Out y[n] = fill(2.0, n);
  end Source;
  model Plant
    Source source;
    Source more(n = 6);
    Part part[3](each has = false);
  equation
    connect(source.y, part.u);
    connect(more.y, part.list);
  end Plant;
end Conditional;
//@ expect part[3].y = 7
//@ expect no column part[1].u
