// args: --method radau
// status: 3
// error[MO0909] 5:8
model Escape
  Real x(start = 1, fixed = true);
equation
  der(x) = x^2;
  annotation(experiment(StopTime = 2));
end Escape;
