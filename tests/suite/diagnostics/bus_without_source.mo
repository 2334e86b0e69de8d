// status: 1
// error[MO0244] 16:5
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
