within Translational;
connector SpoolFlange "Connector between a spool and its seals"
  // The spool provides its motion; the seals contribute forces, which the connection adds up. As everywhere in the
  // library, a positive flow acts on the component that owns the connector.
  Units.Position s    "Stroke of the spool";
  Units.Velocity v    "Speed of the spool";
  Units.Time     t_no "Time without operation: how long the spool has rested";

  flow Units.Force f_slide  "Dry friction while the spool slides, as a magnitude";
  flow Units.Force f_static "Friction that can be mobilised at standstill";
  flow Units.Force f_push   "Force along the axis that does not depend on the direction of motion, positive towards +s";
end SpoolFlange;
