within Translational;
connector Flange "Rigid mechanical connection along the axis s"
  Units.Position s "Position, the same for all connected components";
  flow Units.Force f "Force on the component that owns this flange, positive towards +s";
end Flange;
