within Effects;
model StiffeningSpring "Stiffness that changes with the deflection"
  // f = -(c_2 x^2 + c_3 x^3) with x = s - s_0, beside a linear spring: the first two terms beyond Hooke's law. c_3 alone
  // is the hard (soft, if negative) spring of Duffing (1918), "Erzwungene Schwingungen bei veraenderlicher
  // Eigenfrequenz"; c_2 makes it harder one way than the other. Potential: c_2 x^3/3 + c_3 x^4/4.
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
    explains = "The spring at %at stiffens with its deflection."));
end StiffeningSpring;
