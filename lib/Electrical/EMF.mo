within Electrical;
model EMF "Electric machine without losses: couples a circuit with a shaft"
  //   v = k w,   tau = k i
  extends PartialTwoPin;
  parameter Units.MotorConstant k "Voltage per speed, equal to the torque per current";

  Units.AngularVelocity w "Speed";

  Rotational.Flange flange "The shaft";
equation
  w = der(flange.phi);
  v = k*w;
  flange.tau = -k*i;
end EMF;
