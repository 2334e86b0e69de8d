within;
package Translational "Motion along one axis: masses, springs, dampers, stops"

  type Motion = enumeration(
    AtMin    "at rest on the lower stop",
    Backward "sliding towards -s",
    Locked   "held by static friction between the stops",
    Forward  "sliding towards +s",
    AtMax    "at rest on the upper stop",
    Free     "moving freely between the stops: nothing could hold it at rest")
    "Motion of a body between two stops";

  // The roles of components in the animation of a report.
  annotation(__mocc(view = "body.position = s; body.stops = s_min, s_max; spring.stiffness = c"));
end Translational;
