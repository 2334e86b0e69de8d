// A bus that begins empty: what stands on it comes from what is connected, from either end.
package Buses
  connector RealOutput = output Real;
  connector RealInput = input Real;
  connector Pin
    Real v;
    flow Real i;
  end Pin;

  expandable connector Inner
  end Inner;
  expandable connector Bus
    Real unused;
    Inner engine;
    Real list[:];
  end Bus;

  model Source
    parameter Real k;
    RealOutput y = k*time;
    Bus bus;
  equation
    connect(y, bus.signal);
    connect(y, bus.engine.deep);
  end Source;

  model Sink
    RealInput u[2];
    RealInput deep;
    Bus bus;
  equation
    connect(bus.signal, u[1]);
    connect(bus.list[2], u[2]);
    connect(bus.engine.deep, deep);
  end Sink;

  model Resistor
    Pin p;
  equation
    p.v = 2*p.i;
  end Resistor;

  model Battery
    Pin p;
  equation
    p.v = 10;
  end Battery;

  model System
    Source source(k = 3);
    Sink sinks[2];
    Bus middle;
    RealOutput other = 7;
    Resistor left;
    Battery right;
  equation
    connect(source.bus, middle);
    for k in 1:2 loop
      connect(middle, sinks[k].bus);
    end for;
    connect(other, middle.list[2]);
    connect(left.p, middle.pin);
    connect(middle.pin, right.p);
  end System;
end Buses;
