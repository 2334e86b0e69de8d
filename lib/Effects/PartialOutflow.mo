within Effects;
partial model PartialOutflow "Flow out of a connection set, to somewhere outside of the model"
  Real e "Potential";
  Real f "Flow out of what is connected";

  AnyPort port "Where it leaves";
equation
  e = port.e;
  port.f = f;
end PartialOutflow;
