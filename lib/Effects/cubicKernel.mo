within Effects;
function cubicKernel "Weight of a knot at a distance: 1 at 0; 0 at +-1, and from +-2 on"
  input  Real d "Distance in knots";
  output Real k "Weight";
protected
  Real x "Magnitude of d";
algorithm
  x := abs(d);
  k := if x < 1 then 1 - x^2*(2.5 - 1.5*x) elseif x < 2 then 2 - x*(4 - x*(2.5 - 0.5*x)) else 0;
end cubicKernel;
