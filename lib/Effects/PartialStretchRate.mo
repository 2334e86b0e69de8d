within Effects;
partial model PartialStretchRate "Force between two bodies that depends on the difference of their speeds"
  extends PartialStretch;
  Units.Velocity v_rel "Difference of the speeds";
equation
  v_rel = der(s_rel);
end PartialStretchRate;
