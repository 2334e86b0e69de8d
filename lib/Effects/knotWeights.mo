within Effects;
function knotWeights "Weights of n equally spaced knots in a smooth curve through their values"
  // Cubic convolution: the curve passes through the values, has a continuous slope, and reproduces straight lines;
  // beyond the first and the last knot it is constant. One knot beyond each end continues the values on a straight
  // line.
  // Source: Keys (1981), "Cubic convolution interpolation for digital image processing", IEEE Trans. ASSP 29(6), a =
  // -1/2.
  input  Real    x    "Place: 0 at the first knot, n - 1 at the last";
  input  Integer n    "Number of knots, at least 2";
  output Real    w[n] "Weights; their sum is 1";
protected
  Real y      "Place within the knots";
  Real before "Weight of the knot before the first";
  Real after  "Weight of the knot after the last";
algorithm
  y := min(max(x, 0), n - 1);
  for i in 1:n loop
    w[i] := cubicKernel(y - (i - 1));
  end for;
  before := cubicKernel(y + 1);
  after := cubicKernel(y - n);
  w[1] := w[1] + 2*before;
  w[2] := w[2] - before;
  w[n] := w[n] + 2*after;
  w[n - 1] := w[n - 1] - after;
end knotWeights;
