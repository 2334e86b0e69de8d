within Translational;
connector SpoolFlange "Where a seal sits on a spool"
  // The spool tells the seal how it moves; the seals answer with forces, which the connection itself adds up.
  // As with every force of the library, a positive flow acts on the part that owns the connector.
  Units.Position s    "Stroke of the spool";
  Units.Velocity v    "Speed of the spool";
  Units.Time     t_no "Time without operation: how long the spool has rested";

  flow Units.Force f_slide  "Friction magnitude while the spool slides";
  flow Units.Force f_static "Friction that can be mobilised at standstill";
  flow Units.Force f_push   "Force along the axis that does not depend on the direction of motion, positive towards +s";
end SpoolFlange;
