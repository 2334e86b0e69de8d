within Effects;
model HarmonicVariation "A parameter that repeats itself over the turn"
  //   p = p_0 (1 + A sin(N x) + B cos(N x))
  // The torque of a wind turbine whose blades pass the tower, a pump that delivers by pistons, an eccentric pulley (N = 1).
  input Units.Angle x      "Angle that the parameter depends on";
  Real              factor "The parameter, relative to its mean over a turn";
  parameter Units.Fraction A = 0 "Amplitude of the sine";
  parameter Units.Fraction B = 0 "Amplitude of the cosine";
  parameter Real           N = 1 "Periods per turn";
equation
  factor = 1 + A*sin(N*x) + B*cos(N*x);

  annotation(__mocc(
    effect   = "varies=factor; amplitude=A,B; N=1,2,3,4,5,6,8,12; simpler=Effects.LinearVariation",
    law      = "1 + A sin(N x) + B cos(N x)",
    explains = "The value of %at repeats itself over the turn of %over."));
end HarmonicVariation;
