// status: 3
// error[MO0912] 7:3
model Heater
  Real T(start = 300, fixed = true);
equation
  der(T) = 100;
  assert(T < 350, "Heater: the temperature leaves the range of the table");
end Heater;
