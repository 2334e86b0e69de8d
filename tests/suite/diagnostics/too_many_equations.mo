// status: 1
// error[MO0402] 8:3
model Pendulum
  Real phi(start = 1);
  Real w;
equation
  der(phi) = w;
  der(w) = -sin(phi);
  w = 2*phi;
end Pendulum;
