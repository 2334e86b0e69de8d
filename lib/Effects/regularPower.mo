within Effects;
function regularPower "Power of a number that keeps its sign, with a finite slope at zero"
  //   y = x (x^2 + delta^2)^((n - 1)/2)
  // Equal to sign(x) |x|^n where |x| is large compared with delta.
  input  Real x         "Base";
  input  Real n         "Exponent";
  output Real y         "sign(x) |x|^n";
protected
  constant Real delta = 1e-3 "Base below which the power is a straight line";
algorithm
  y := x*(x^2 + delta^2)^((n - 1)/2);
  annotation(Inline = true);
end regularPower;
