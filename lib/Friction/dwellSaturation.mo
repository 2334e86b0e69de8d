within Friction;
function dwellSaturation "Fraction of the Stribeck force that has built up after resting: 1 - exp(-(t_no/tau)^n)"
  input  Units.Time     t_no  "Time without operation";
  input  Units.Time     tau   "Time constant of the build-up";
  input  Units.Exponent n     "Stretching exponent, below 1: fast at first, then slow";
  output Units.Fraction share "0 just locked, 1 after infinite rest";
protected
  // For n < 1 the curve starts with a vertical tangent. Shorter rests are treated as this one, which changes the
  // share by at most 1e-7 and keeps the slope finite.
  constant Units.Time t_least = 1e-20;
algorithm
  share := 1 - exp(-(max(t_no, t_least)/tau)^n);
end dwellSaturation;
