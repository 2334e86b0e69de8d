within Effects;
block SensorDeadTime "Sensor whose readings arrive after a dead time"
  //   y(t) = u(t - t_d)
  // A bus, a sampling or a filter with a linear phase. Each of m all-pass sections (Padé approximant of the first order)
  // delays by t_d/m: the phase is wrong by (omega t_d)^3/(12 m^2), the amplitude is right. With
  // tau = sqrt((t_d/(2 m))^2 + T_min^2), where T_min is short compared with everything, the sections are regular at
  // t_d = 0. u must be continuous.
  parameter Units.Time t_d   = 0    "Dead time";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";
  parameter Integer    m     = 4    "Number of sections";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
  Units.Time t   = time                        "Time";
  Units.Time tau = sqrt((t_d/(2*m))^2 + T_min^2) "Time constant of a section";
  Real       x[m]                              "Reading of a lag of first order with tau, by section";
  Real       v[m + 1]                          "Value before the first section, and behind each";
initial equation
  x = v[1:m];
equation
  v[1] = u;
  for k in 1:m loop
    tau*der(x[k]) = v[k] - x[k];
    v[k + 1] = v[k] - t_d/m*(v[k] - x[k])/tau;
  end for;
  y = v[m + 1];

  annotation(__mocc(
    effect   = "amplitude=t_d>0; T_min=1e-5*span(t); named=Effects.SensorDelay",
    law      = "y(t) = u(t - t_d)",
    explains = "The readings of the sensor of %at arrive after a dead time."));
end SensorDeadTime;
