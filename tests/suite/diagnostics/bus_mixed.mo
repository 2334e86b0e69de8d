// status: 1
// error[MO0243] 8:14
// error[MO0243] 9:15
// error[MO0230] 21:3
// error[MO0217] 22:7
model M
  expandable connector Bus
    Real x = 1;
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
  connect(bus, pin);
  y = bus.unused;
end M;
