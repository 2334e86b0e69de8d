//@ case decay
//@ used by sweep.rs
model Decay
  parameter Real rate = 1;
  parameter Integer n = 2;
  parameter Boolean doubled = false;
  Real x[n](each start = 1, each fixed = true);
  Real total = (if doubled then 2 else 1)*sum(x);
equation
  for i in 1:n loop
    der(x[i]) = -i*rate*x[i];
  end for;
  assert(rate < 4, "too fast");
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Decay;
