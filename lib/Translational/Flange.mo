within Translational;
connector Flange "Rigid mechanical connection along the axis s"
  Units.Position s "Position, the same for all parts connected here";
  flow Units.Force f "Force acting on the part that owns this flange, positive towards +s";
end Flange;
