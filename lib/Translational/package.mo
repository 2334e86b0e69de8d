within;
package Translational "Motion along one axis: masses, springs, dampers, stops"

  type Motion = enumeration(
    AtMin    "at rest on the lower stop",
    Backward "sliding towards -s",
    Locked   "held by static friction between the stops",
    Forward  "sliding towards +s",
    AtMax    "at rest on the upper stop")
    "What a body between two stops is doing";
end Translational;
