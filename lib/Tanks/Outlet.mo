within Tanks;
model Outlet "Hole in the bottom of a tank with a free outflow"
  //   q = k sqrt(h)
  // Torricelli's law, independent of the level at the other end. Below h_small the root becomes a line, which keeps
  // its slope finite: q = k h/sqrt(h + h_small).
  parameter Real           k       = 0.05 "Outflow at a level of 1 m, in m3/s";
  parameter Units.Position h_small = 1e-3 "Level below which the root becomes a line";

  Units.VolumeFlowRate q "Volume flow from a to b";

  Port port_a "The tank";
  Port port_b "Other end";
protected
  Units.Position h "Level, not below 0";
equation
  h = noEvent(max(port_a.h, 0));
  q = k*h/sqrt(h + h_small);
  port_a.q = q;
  port_b.q = -q;
end Outlet;
