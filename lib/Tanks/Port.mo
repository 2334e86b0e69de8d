within Tanks;
connector Port "Connection of an open tank"
  Units.Position h "Level of the liquid above the outlet";
  flow Units.VolumeFlowRate q "Liquid flowing into the component that owns this port";
end Port;
