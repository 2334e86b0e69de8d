// status: 1
// error[MO0401] 4:8
model Pendulum
  Real phi(start = 1);
  Real w;
  Real torque;
equation
  der(phi) = w;
  der(w) = torque - sin(phi);
end Pendulum;
