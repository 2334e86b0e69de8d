within Effects;
model OtherValue "A parameter with another value than the model gives it"
  //   p = p_0 exp(a)
  // A dimension or a stiffness that was taken for known. An amended model sets the parameter to p.
  Real factor "The parameter, relative to the value that the model gives it";
  parameter Real a = 0 "Logarithm of the factor";
equation
  factor = exp(a);

  annotation(__mocc(
    effect   = "varies=factor; amplitude=a",
    law      = "exp(a)",
    explains = "%at has another value than the model gives it."));
end OtherValue;
