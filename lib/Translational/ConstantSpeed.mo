within Translational;
model ConstantSpeed "Point that moves at constant speed, at any force"
  parameter Units.Velocity v_0 = 1 "Speed";
  parameter Units.Position s_0 = 0 "Position at time 0";
  Flange flange;
equation
  flange.s = s_0 + v_0*time;
end ConstantSpeed;
