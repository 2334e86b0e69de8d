within Effects;
model DirectionalVariation "A parameter that differs by the sign of a quantity"
  //   p = p_0 (1 + a sign(x))
  // The resistance of a cell that is charged or discharged, the friction of a lift on its way up or down, the two areas of a
  // piston. At x = 0, the parameter is itself.
  extends PartialVariation;
  parameter Units.Fraction a = 0 "Half the relative difference";
equation
  factor = 1 + a*noEvent(if x > 0 then 1 elseif x < 0 then -1 else 0);

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=a",
    law      = "1 + a sign(x)",
    explains = "The value of %at differs by the sign of %over."));
end DirectionalVariation;
