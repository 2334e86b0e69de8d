within Translational;
model Mass "Rigid body that slides without friction"
  //   m d2s/dt2 = f
  parameter Units.Mass     m           "Mass";
  parameter Units.Position s_start = 0 "Position at the start";
  parameter Units.Velocity v_start = 0 "Speed at the start";

  Units.Position     s(start = s_start, fixed = true, stateSelect = StateSelect.prefer) "Position";
  Units.Velocity     v(start = v_start, fixed = true, stateSelect = StateSelect.prefer) "Speed";
  Units.Acceleration a "Acceleration";

  Flange flange;
equation
  s = flange.s;
  v = der(s);
  a = der(v);
  m*a = flange.f;
end Mass;
