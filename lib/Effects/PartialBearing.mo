within Effects;
partial model PartialBearing "Torque on a shaft that depends on the speed"
  extends PartialTorque;
  Units.AngularVelocity w "Speed";
equation
  w = der(phi);
end PartialBearing;
