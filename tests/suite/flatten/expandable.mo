//@ case buses
//@ snapshot flat
// A bus that begins empty: connections from either end add its variables.
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
//@ expect flat lacks "unused"
//@ expect flat lacks ".list[1]"
//@ expect sinks[1].u[1], sinks[1].u[2], sinks[1].deep = 3, 7, 3
//@ expect sinks[2].u[1], sinks[2].u[2], sinks[2].deep = 3, 7, 3
// Ohm's law and Kirchhoff's, across the bus.
//@ expect left.p.i, right.p.i = 5, -5

//@ case bus_undeclared
model M
  expandable connector Bus
  end Bus;
  Bus a, b;
equation
  //@ error[MO0242] 13-17
  //@ error[MO0242] 22-26
  connect(a.speed, b.speed);
end M;

//@ case bus_mixed
model M
  expandable connector Bus
    //@ error[MO1214] 14
    Real x = 1;
    //@ error[MO0243] 15
    flow Real f;
    Real unused;
  end Bus;
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  Bus bus;
  Pin pin;
  Real y;
equation
  pin.v = 1;
  //@ error[MO1212] 3-19
  connect(bus, pin);
  //@ error[MO1203] 7-16
  y = bus.unused;
end M;

//@ case bus_without_source
model M
  expandable connector Bus
  end Bus;
  connector RealInput = input Real;
  connector RealOutput = output Real;
  model Gauge
    RealInput u;
  end Gauge;
  model Sink
    Bus bus;
    Gauge speed;
    Gauge force;
  equation
    //@ error[MO0244] 5-31
    connect(bus.speed, speed.u);
    connect(bus.force, force.u);
  end Sink;
  model Source
    RealOutput y = time;
  end Source;
  Sink sink;
  Bus bus;
  Source source;
equation
  connect(source.y, bus.force);
  connect(bus, sink.bus);
end M;

//@ case bus_in_itself
// A bus that is connected with a part of itself would have buses in buses without an end.
model Car
  expandable connector Bus
  end Bus;
  connector RealOutput = output Real;
  model Source
    RealOutput y = time;
  end Source;
  Bus bus;
  Source source;
equation
  //@ error[MO0276] 3-26
  connect(bus, bus.inside);
  connect(source.y, bus.speed);
end Car;

//@ case disabled_source
//@ run stop=1
// A connection to a disabled component goes with it, and with it the variable of the bus that only
// this connection would have added.
package Buses
  connector In = input Real;
  connector Out = output Real;
  expandable connector Bus
  end Bus;
  model Clock
    Out y = time;
  end Clock;
  model Unit
    parameter Boolean measured = false;
    Bus bus;
    In ambient if measured;
    Clock clock;
  equation
    connect(ambient, bus.ambient);
    connect(clock.y, bus.y);
  end Unit;
  model User
    Unit unit;
    Bus bus;
    Real z;
  equation
    connect(unit.bus, bus);
    z = 2*bus.y;
  end User;
end Buses;
//@ expect z = 2
//@ expect no column bus.ambient

//@ case arrays_of_buses
//@ run stop=1
// A vector comes to a bus as a whole and leaves it by elements, in any order and through other buses.
package Arrays
  connector RealInput = input Real;
  connector RealOutput = output Real;
  expandable connector Bus end Bus;
  expandable connector Middle end Middle;
  block Ramp
    parameter Real k = 1;
    RealOutput y = k*time;
  end Ramp;
  block Ramps
    RealOutput y[3] = {1, 2, 3}*time;
  end Ramps;
  block Gain
    RealInput u;
    Real y = 10*u;
  end Gain;
  block Sum
    RealInput u[2];
    Real y = sum(u);
  end Sum;
  model Writer "components, the whole first"
    Bus bus;
    Ramp ramp[3](k = {1, 2, 3});
  equation
    connect(ramp.y, bus.vector);
  end Writer;
  model Reader
    Bus bus;
    Gain gain;
    Sum part;
  equation
    connect(bus.vector[2], gain.u);
    connect(bus.vector[2:3], part.u);
  end Reader;
  model Elements "the elements first"
    Bus bus;
    Ramp ramp[3](k = {1, 2, 3});
    Gain gain;
  equation
    connect(bus.vector[2], gain.u);
    connect(ramp.y, bus.vector);
  end Elements;
  model Variable "a vector variable, after one of its elements"
    Bus bus;
    Ramps ramps;
    Gain gain;
  equation
    connect(bus.vector[2], gain.u);
    connect(ramps.y, bus.vector);
  end Variable;
  model All
    Writer writer;
    Reader reader;
    Elements elements;
    Variable variable;
    Middle middle;
  equation
    connect(reader.bus, middle);
    connect(writer.bus, middle);
  end All;
end Arrays;
//@ expect reader.gain.y, reader.part.y = 20, 5
//@ expect elements.gain.y, variable.gain.y = 20, 20
//@ expect writer.bus.vector[1:3] = 1, 2, 3
