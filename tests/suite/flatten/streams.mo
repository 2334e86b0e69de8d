//@ case mixing
//@ run stop=1
// The formulas of section 15.2 for three inside connectors, of which two supply; and the mean of the
// values where no flow at all decides.
package Mixing
  connector Port
    Real p;
    flow Real m_flow;
    stream Real h_outflow;
  end Port;
  model Source
    parameter Real m;
    parameter Real h;
    Port port;
    Real h_in = inStream(port.h_outflow);
    Real h_now = actualStream(port.h_outflow);
  equation
    port.m_flow = -m;
    port.h_outflow = h;
  end Source;
  model Sink
    parameter Real h;
    Port port(p = 1);
    Real h_in = inStream(port.h_outflow);
    Real h_now = actualStream(port.h_outflow);
  equation
    port.h_outflow = h;
  end Sink;
  model Node
    parameter Real scale = 1;
    Source a(m = scale, h = 10), b(m = 3*scale, h = 20);
    Sink c(h = 50);
  equation
    connect(a.port, b.port);
    connect(b.port, c.port);
  end Node;
  model Nodes
    Node flowing;
    Node resting(scale = 0);
  end Nodes;
end Mixing;
//@ expect flowing.a.h_in, flowing.b.h_in, flowing.c.h_in = 20, 10, (10 + 3*20)/4 abs 1e-12
//@ expect flowing.a.h_now, flowing.b.h_now, flowing.c.h_now = 10, 20, 17.5 abs 1e-12
//@ expect resting.a.h_in, resting.b.h_in, resting.c.h_in = 35, 30, 15 abs 1e-12

//@ case inside_and_outside
//@ run stop=1
// A component in a component: the outside connector passes on the mixture of what is inside, and
// brings in what is outside. One port cannot supply, and takes no part.
package Nested
  connector Port
    Real p;
    flow Real m_flow;
    stream Real h_outflow;
    stream Real X_outflow[2];
  end Port;
  model Volume
    parameter Real m;
    parameter Real h;
    Port port(m_flow = m);
    Real h_in = inStream(port.h_outflow);
    Real X_in[2] = inStream(port.X_outflow);
  equation
    port.h_outflow = h;
    port.X_outflow = {h/100, 1 - h/100};
  end Volume;
  model Box
    Port port;
    Volume first(m = 2, h = 10), second(m = -5, h = 40);
    Volume third(m = 1, h = 99, port(m_flow(min = 0)));
  equation
    connect(port, first.port);
    connect(port, second.port);
    connect(third.port, port);
  end Box;
  model Shell
    Port port;
    Box box;
  equation
    connect(box.port, port);
  end Shell;
  model Ambient
    Port port(p = 1);
    Real h_in = inStream(port.h_outflow);
  equation
    port.h_outflow = 70;
    port.X_outflow = {0.3, 0.7};
  end Ambient;
  model System
    Shell shell;
    Ambient ambient;
  equation
    connect(shell.port, ambient.port);
  end System;
end Nested;
// 5 flow out of the second, 2 into the first, 1 into the third, 2 into the ambient.
//@ expect ambient.h_in, shell.port.m_flow = 40, -2 abs 1e-12
//@ expect shell.box.first.h_in, shell.box.third.h_in = 40, 40 abs 1e-12
//@ expect shell.box.first.X_in[1], shell.box.first.X_in[2] = 0.4, 0.6 abs 1e-12

//@ case reversal
//@ run stop=6.283185307179586 tolerance=1e-9
// A volume that breathes: the product of the flow and `actualStream` is continuous, so it has no
// event. Inwards 300 J/kg flow, outwards its own enthalpy; the mass is 2 - cos(t).
package Reversal
  connector Port
    Real p;
    flow Real m_flow;
    stream Real h_outflow;
  end Port;
  model Ambient
    Port port;
  equation
    port.m_flow = -sin(time);
    port.h_outflow = 300;
  end Ambient;
  model Volume
    Port port;
    Real m(start = 1, fixed = true);
    Real U(start = 100, fixed = true);
  equation
    port.p = 1;
    der(m) = port.m_flow;
    der(U) = port.m_flow*actualStream(port.h_outflow);
    port.h_outflow = U/m;
  end Volume;
  model Breathing
    Ambient ambient;
    Volume volume;
  equation
    connect(ambient.port, volume.port);
  end Breathing;
end Reversal;
// Filled from 1 to 3 kg: U = 100 + 2*300; then it leaves at 700/3 J/kg.
//@ expect events = 0
//@ expect volume.U at 3.141592653589793 = 700 rel 1e-3
//@ expect volume.U = 700/3 rel 1e-6

//@ case nested_connectors
// Each of the nested connectors has one flow that transports its own streams. The size of an array may be that of a
// stream that flows in.
package Nested
  connector Port
    Real p;
    flow Real m;
    stream Real x[2];
  end Port;
  connector Bundle
    Port a;
    Port b;
  end Bundle;
  model Source
    parameter Real k = 1;
    Bundle out;
  equation
    out.a.p = k;
    out.b.p = 2*k;
    out.a.x = {k, 0};
    out.b.x = {0, k};
  end Source;
  model Sink
    Bundle into;
    Real x[:] = inStream(into.a.x);
    Real y = actualStream(into.b.x[2]);
  equation
    into.a.m = 1;
    into.b.m = 2;
    into.a.x = {7, 7};
    into.b.x = {8, 8};
  end Sink;
  model Top
    Source source(k = 3);
    Sink sink;
  equation
    connect(source.out, sink.into);
  end Top;
end Nested;
//@ expect sink.x[1], sink.x[2], sink.y = 3, 0, 3
//@ expect source.out.a.m, source.out.b.m = -1, -2
