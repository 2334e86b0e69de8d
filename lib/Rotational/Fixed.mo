within Rotational;
model Fixed "Shaft end fixed in the housing"
  parameter Units.Angle phi_0 = 0 "Angle";
  Flange flange;
equation
  flange.phi = phi_0;
end Fixed;
