within Effects;
block SensorLag "Sensor that follows gradually"
  // y = u - T (u - x)/tau, tau dx/dt = u - x: a slow change is read T late. With T = tau, y = x is the first-order
  // lag; with another T, a part of the signal passes at once. Transfer function 1 - T s/(1 + tau s), regular at
  // T = 0.
  parameter Units.Time T   = 0    "How late a slow change is read";
  parameter Units.Time tau = 1e-3 "Time constant";

  input Real  u "What is measured, in any unit";
  output Real y "What the sensor says, in the same unit";
  Real x "What a lag of tau would say";
initial equation
  x = u;
equation
  tau*der(x) = u - x;
  y = u - T*(u - x)/tau;

  annotation(__mocc(
    effect   = "amplitude=T>0; tau=0.3e-3,1e-3,3e-3",
    explains = "The sensor of %at follows gradually."));
end SensorLag;
