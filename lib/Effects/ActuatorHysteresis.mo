within Effects;
block ActuatorHysteresis "Actuator that gives too little going up and too much going down"
  //   y = u - h z,   w dz/dt = dx/dt - |dx/dt| z
  // The iron of a magnet, or friction in a drive. After a path long compared with w, z is +1 going up and -1 going down,
  // so the branches are 2 h apart: Duhem's form of hysteresis, with the slope of Dahl's friction. The path x follows u with
  // a short lag, so that u may jump.
  extends PartialActuator;
  parameter Real h = 0 "Half the distance between the branches, in the unit of u";
  parameter Real w = 1 "Path after which 63 % of a branch is reached, in the unit of u";
  parameter Units.Time T_min = 1e-6 "How late the path is known";

  Units.Time     t = time                   "Time";
  Real           x                          "Path, in the unit of u";
  Units.Fraction z(start = 0, fixed = true) "Position between the branches, -1 to 1";
initial equation
  x = u;
equation
  T_min*der(x) = u - x;
  w*der(z) = der(x) - noEvent(abs(der(x)))*z;
  y = u - h*z;

  annotation(__mocc(
    effect   = "acts=y; amplitude=h>0; w=0.02*span(u),0.1*span(u); T_min=1e-5*span(t)",
    law      = "y = u - h z",
    explains = "The signal %at acts with hysteresis."));
end ActuatorHysteresis;
