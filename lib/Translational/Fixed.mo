within Translational;
model Fixed "Point fixed in the housing"
  parameter Units.Position s_0 = 0 "Position";
  Flange flange;
equation
  flange.s = s_0;
end Fixed;
