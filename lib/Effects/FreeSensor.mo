within Effects;
block FreeSensor "Sensor with a free characteristic"
  //   y = u + f(u)
  // f is a smooth curve through the n amplitudes f at n simulated values, equally spaced from u_lo to u_hi (knotWeights).
  // For dead zones, saturation and other characteristics of which no law is known.
  extends PartialSensor;
  parameter Integer n    = 6        "Number of knots";
  parameter Real    f[n] = zeros(n) "Value added at each knot, in the unit of u";
  parameter Real    u_lo = 0        "First knot, in the unit of u";
  parameter Real    u_hi = 1        "Last knot, in the unit of u";
equation
  y = u + f*knotWeights((u - u_lo)/max(u_hi - u_lo, 1e-12)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=f; u_lo=min(u); u_hi=max(u)",
    law      = "y = u + f(u)",
    formula  = "extends=PartialSensor; knots=f; count=n; over=u; from=u_lo; to=u_hi; equation=y = u + F(u)",
    explains = "The sensor of %at reads by a law that is not known in advance."));
end FreeSensor;
