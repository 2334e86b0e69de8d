within Tanks;
model Outlet "Hole in the bottom of a tank: what leaves it falls freely"
  // q = k sqrt(h) after Torricelli, whatever the level is where it falls. Below h_small the root goes over into a
  // line, which keeps its slope finite: q = k h/sqrt(h + h_small).
  parameter Real           k(unit = "m2.5/s") = 0.05 "Outflow at a level of 1 m";
  parameter Units.Position h_small = 1e-3 "Level below which the root becomes a line";

  Units.VolumeFlowRate q "Volume flow from a to b";

  Port port_a "The tank";
  Port port_b "Where it falls";
protected
  Units.Position h "Level, not below 0";
equation
  h = noEvent(max(port_a.h, 0));
  q = k*h/sqrt(h + h_small);
  port_a.q = q;
  port_b.q = -q;
end Outlet;
