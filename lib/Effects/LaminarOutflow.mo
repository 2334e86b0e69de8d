within Effects;
model LaminarOutflow "Outflow proportional to the level"
  //   q = k h
  // The laminar part of the flow through a hole with a pipe behind it (Hagen and Poiseuille), as in the linear term
  // of Forchheimer's law; a negative k reduces the outflow. Under a tank of cross section A alone, the level falls as
  // exp(-k t/A).
  parameter Real k(unit = "m2/s") = 0 "Volume flow per level";

  Tanks.Port port_a "The tank";
  Tanks.Port port_b "Other end of its outlet";
equation
  port_a.q = k*noEvent(max(port_a.h, 0));
  port_b.q = -port_a.q;

  annotation(__mocc(
    effect   = "amplitude=k; host=port_a,port_b",
    law      = "q = k h",
    explains = "The flow through %at has a part proportional to the level."));
end LaminarOutflow;
