within Rotational;
connector Flange "End of a shaft"
  Units.Angle phi "Angle, the same for all connected components";
  flow Units.Torque tau "Torque on the component that owns this flange, positive towards +phi";
end Flange;
