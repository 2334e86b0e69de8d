// status: 3
// error[MO0912] 9:18
// A subscript that only a run knows leaves the array.
model Gearbox
  parameter Real ratios[3] = {4, 2, 1};
  discrete Integer gear(start = 1, fixed = true);
  Real ratio;
equation
  ratio = ratios[gear];
  when sample(1, 1) then
    gear = pre(gear) + 1;
  end when;
  annotation(experiment(StopTime = 10));
end Gearbox;
