within Translational;
model CentringSpring "Two preloaded springs with cups that push a body back to the middle"
  //   f = -(f_0 tanh((s - s_0)/w) + c (s - s_0))
  // Away from the middle, one spring is lifted off its stop in the housing and pushes with f_0 + c |s - s_0|, and the
  // other rests on its own stop. In the middle they hand over within the play w.
  extends PartialActuator;
  parameter Units.SpringStiffness c           "Stiffness of one spring";
  parameter Units.Force           f_0         "Preload of each spring";
  parameter Units.Position        s_0 = 0     "The middle";
  parameter Units.Length          w   = 50e-6 "Play of the cups";
equation
  flange.f = f_0*tanh((flange.s - s_0)/w) + c*(flange.s - s_0);
end CentringSpring;
