within Effects;
block ActuatorBacklash "Actuator behind a linkage with play"
  //   y = u - h z,   w dz/dt = dx/dt - |dx/dt| |z|^18 z
  // With w = h what acts rests while the play of 2 h is crossed, and then follows at the distance h. With a smaller w it
  // follows sooner. Bouc's and Wen's form of hysteresis, with a sharp corner. The path x follows u with a short lag, so that
  // u may jump.
  extends PartialActuator;
  parameter Real h = 0 "Half the play, in the unit of u";
  parameter Real w = 1 "Path after which the actuator follows, in the unit of u";
  parameter Real z_0 = 0 "Position within the play before the start, -1 to 1";
  parameter Units.Time T_min = 1e-6 "How late the path is known";

  Units.Time     t = time                   "Time";
  Real           x                          "Path, in the unit of u";
  Units.Fraction z(start = max(-1, min(1, z_0)), fixed = true) "Position within the play, -1 to 1";
initial equation
  x = u;
equation
  T_min*der(x) = u - x;
  w*der(z) = der(x) - noEvent(abs(der(x)))*z^19;
  y = u - h*z;

  annotation(__mocc(
    effect   = "acts=y; amplitude=h>0; w=0.02*span(u),0.1*span(u); z_0=-1,0,1; T_min=1e-5*span(t)",
    law      = "y = u - h z",
    explains = "The signal %at acts behind a play."));
end ActuatorBacklash;
