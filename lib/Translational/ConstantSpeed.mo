within Translational;
model ConstantSpeed "Point moved at constant speed, whatever force that takes"
  parameter Units.Velocity v_0 = 1 "Speed";
  parameter Units.Position s_0 = 0 "Position at time 0";
  Flange flange;
equation
  flange.s = s_0 + v_0*time;
end ConstantSpeed;
