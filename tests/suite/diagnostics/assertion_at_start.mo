// status: 3
// error[MO0912] lib/Pneumatics/PartialRestriction.mo:16:3
model Valve
  Pneumatics.Source      supply(p = 7e5);
  Pneumatics.Restriction line(C = 1e-9, b = 1.3);
  Pneumatics.Volume      vessel(V_0 = 1e-3);
equation
  connect(supply.port, line.port_a);
  connect(line.port_b, vessel.port);
end Valve;
