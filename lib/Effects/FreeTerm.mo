within Effects;
model FreeTerm "A term as a free curve over a variable"
  //   term = f(x)
  // f is a smooth curve through the n amplitudes f at n values of x, equally spaced from x_lo to x_hi (knotWeights). For
  // terms of which only the variable is known that they depend on.
  extends PartialTermOver;
  parameter Integer n    = 7        "Number of knots";
  parameter Real    f[n] = zeros(n) "Term at each knot, in the unit of the equation";
  parameter Real    x_lo = 0        "First knot";
  parameter Real    x_hi = 1        "Last knot";
equation
  term = f*knotWeights((x - x_lo)/max(x_hi - x_lo, 1e-12)*(n - 1), n);

  annotation(__mocc(
    effect   = "adds=term; amplitude=f; x_lo=min(x); x_hi=max(x)",
    law      = "f(x)",
    formula  = "extends=PartialTermOver; knots=f; count=n; over=x; from=x_lo; to=x_hi; equation=term = F(x)",
    explains = "The equation of %at lacks a term that depends on %over by a law that is not known in advance."));
end FreeTerm;
