//@ case lag
//@ used by measured.rs
model Lag
  parameter Real k(unit = "1/s") = 1 "Rate";
  input Real u(unit = "V");
  Real x(start = 0, fixed = true, unit = "V");
equation
  der(x) = k*(u - x);
  annotation(experiment(Tolerance = 1e-9));
end Lag;
