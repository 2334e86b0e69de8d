within Effects;
model TwistStiffening "Stiffness between two shafts that changes with the twist"
  //   tau = c_3 phi_rel^3
  // The first term beyond Hooke's law that is equal in both directions, in addition to a linear spring. Potential: c_3
  // phi_rel^4/4.
  // Source: Duffing (1918), "Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz".
  extends PartialTwist;
  parameter Real c_3(unit = "N.m/rad3") = 0 "Torque per cube of the twist";
equation
  tau = c_3*phi_rel^3;

  annotation(__mocc(
    effect   = "series=true; amplitude=c_3",
    law      = "tau = c_3 phi_rel^3",
    explains = "%at stiffens with its twist."));
end TwistStiffening;
