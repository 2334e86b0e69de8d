within Tanks;
model Tank "Open tank of constant cross section"
  //   A dh/dt = q
  parameter Units.Area     A       = 1 "Cross section";
  parameter Units.Position h_start = 1 "Level at the start";

  Units.Position h(start = h_start, fixed = true, stateSelect = StateSelect.prefer) "Level";

  Port port;
equation
  A*der(h) = port.q;
  port.h = h;
end Tank;
