within Effects;
model SquareTerm "A term in proportion to the square of a variable"
  //   term = a x^2
  // Heat of a current in a resistance, lift, a force between currents: the same for both directions.
  extends PartialTermOver;
  parameter Real a = 0 "Factor of x^2";
equation
  term = a*x^2;

  annotation(__mocc(
    effect   = "adds=term; amplitude=a",
    law      = "a x^2",
    explains = "The equation of %at lacks a term that grows with the square of %over, whatever its sign."));
end SquareTerm;
