within Rotational;
model ConstantSpeed "Shaft end that turns at constant speed, at any torque"
  parameter Units.AngularVelocity w_0   = 1 "Speed";
  parameter Units.Angle           phi_0 = 0 "Angle at time 0";
  Flange flange;
equation
  flange.phi = phi_0 + w_0*time;
end ConstantSpeed;
