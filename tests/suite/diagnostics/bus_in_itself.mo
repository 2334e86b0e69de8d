// status: 1
// error[MO0276] 14:3
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
  connect(bus, bus.inside);
  connect(source.y, bus.speed);
end Car;
