within Effects;
model StiffeningSpring "Stiffness that changes with the deflection"
  //   f = -(c_2 x^2 + c_3 x^3),   x = s - s_0
  // The first two terms beyond Hooke's law, in addition to a linear spring. c_3 alone is the hard (or, if negative,
  // soft) spring of Duffing; c_2 makes it harder in one direction. Potential: c_2 x^3/3 + c_3 x^4/4.
  // Source: Duffing (1918), "Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz".
  extends PartialForce;
  parameter Units.QuadraticStiffness c_2 = 0 "Force per square of the deflection";
  parameter Units.CubicStiffness     c_3 = 0 "Force per cube of the deflection";
  parameter Units.Position           s_0 = 0 "Where there is no deflection";

  Units.Length x "Deflection";
equation
  x = s - s_0;
  f = -x^2*(c_2 + c_3*x);

  annotation(__mocc(
    effect   = "amplitude=c_2,c_3; s_0=0",
    law      = "f = -(c_2 x^2 + c_3 x^3)",
    explains = "The spring at %at stiffens with its deflection."));
end StiffeningSpring;
