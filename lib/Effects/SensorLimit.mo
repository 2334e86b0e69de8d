within Effects;
block SensorLimit "Sensor that stops at its largest reading"
  //   y = u - a (u - max(-y_max, min(y_max, u)))
  // The end of a measuring range. With a = 1 larger values read y_max.
  extends PartialSensor;
  parameter Units.Fraction a     = 0 "Share of what exceeds y_max that is not read";
  parameter Real           y_max = 1 "Largest reading, in the unit of u";

  Real size_of_u "Magnitude of u";
equation
  size_of_u = noEvent(abs(u));
  y = u - a*(u - noEvent(max(-y_max, min(y_max, u))));

  annotation(__mocc(
    effect   = "amplitude=a>0; y_max=0.5*max(size_of_u),0.7*max(size_of_u),0.9*max(size_of_u); simpler=Effects.SensorGain",
    law      = "y = u - a (u - max(-y_max, min(y_max, u)))",
    explains = "The sensor of %at reads up to a limit."));
end SensorLimit;
