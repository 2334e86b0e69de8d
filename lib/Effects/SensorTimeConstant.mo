within Effects;
block SensorTimeConstant "Sensor with a store of its own, whose reading approaches the value"
  //   T dy/dt = u - y
  // A thermometer in its well, a damped pointer, or a filter. With tau = sqrt(T^2 + T_min^2), where T_min is short
  // compared with everything, the equations y = u - T (u - x)/tau and tau dx/dt = u - x are regular at T = 0 and become
  // the lag of first order beyond T_min. SensorLag also describes sensors that see a part of the value immediately.
  parameter Units.Time T     = 0    "Time constant";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
  Units.Time t   = time                "Time";
  Units.Time tau = sqrt(T^2 + T_min^2) "Time constant of x";
  Real       x                         "Reading of a lag of first order with tau";
initial equation
  x = u;
equation
  tau*der(x) = u - x;
  y = u - T*(u - x)/tau;

  annotation(__mocc(
    effect   = "amplitude=T>0; T_min=1e-5*span(t); named=Effects.SensorLag",
    law      = "T dy/dt = u - y",
    explains = "The sensor of %at has a store of its own, and follows with a time constant."));
end SensorTimeConstant;
