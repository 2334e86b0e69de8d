within Effects;
partial model PartialVariation "A parameter that varies with a quantity"
  input Real x      "Quantity that the parameter depends on";
  Real       factor "The parameter, relative to its own value";
end PartialVariation;
