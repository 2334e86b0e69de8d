within Effects;
model StretchStiffening "Stiffness between two bodies that changes with their distance"
  //   f = c_2 x^2 + c_3 x^3,   x = s_rel - l_0
  // The first two terms beyond Hooke's law, in addition to a linear spring. Potential: c_2 x^3/3 + c_3 x^4/4.
  // Source: Duffing (1918), "Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz".
  extends PartialStretch;
  parameter Units.QuadraticStiffness c_2 = 0 "Force per square of the deflection";
  parameter Units.CubicStiffness     c_3 = 0 "Force per cube of the deflection";
  parameter Units.Length             l_0 = 0 "Distance without deflection";

  Units.Length x "Deflection";
equation
  x = s_rel - l_0;
  f = x^2*(c_2 + c_3*x);

  annotation(__mocc(
    effect   = "between=moving; series=true; amplitude=c_2,c_3; l_0=s_rel(1)",
    law      = "f = c_2 x^2 + c_3 x^3,  x = s_rel - l_0",
    explains = "%at stiffens with its deflection."));
end StretchStiffening;
