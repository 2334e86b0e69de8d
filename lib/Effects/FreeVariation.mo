within Effects;
model FreeVariation "A parameter that varies with a quantity along a free curve"
  //   p = p_0 (1 + f(x))
  // f is a smooth curve through 0 at x_lo and the n amplitudes f at n values of x, equally spaced up to x_hi
  // (knotWeights): p_0 is the value at x_lo. The annotation `varies` of an amended model says which parameters are
  // multiplied by the factor.
  extends PartialVariation;
  parameter Integer        n    = 5        "Number of knots in addition to x_lo";
  parameter Units.Fraction f[n] = zeros(n) "Relative change at each knot";
  parameter Real           x_lo = 0        "First knot";
  parameter Real           x_hi = 1        "Last knot";
equation
  factor = 1 + cat(1, {0}, f)*knotWeights((x - x_lo)/max(x_hi - x_lo, 1e-12)*n, n + 1);

  annotation(__mocc(
    effect   = "varies=factor; amplitude=f; x_lo=min(x); x_hi=max(x)",
    law      = "1 + f(x)",
    formula  = "extends=PartialVariation; knots=f; count=n; over=x; from=x_lo; to=x_hi; anchored=true; equation=factor = 1 + F(x)",
    explains = "The value of %at varies with %over by a law that is not known in advance."));
end FreeVariation;
