within Effects;
block SensorLag "Sensor with a lag"
  //   y = u - T (u - x)/tau,   tau dx/dt = u - x
  // A slow change is read with the delay T. T = tau is a first-order lag; with another T, part of the signal passes
  // immediately. The transfer function 1 - T s/(1 + tau s) is regular at T = 0.
  parameter Units.Time T   = 0    "How late a slow change is read";
  parameter Units.Time tau = 1e-3 "Time constant";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
  Units.Time t = time "Time";
  Real       x        "Reading of a first-order lag with tau";
initial equation
  x = u;
equation
  tau*der(x) = u - x;
  y = u - T*(u - x)/tau;

  annotation(__mocc(
    effect   = "amplitude=T>0; tau=0.0025*span(t),0.008*span(t),0.025*span(t)",
    law      = "y = u - T (u - x)/tau",
    explains = "The sensor of %at follows with a lag."));
end SensorLag;
