within Effects;
partial model PartialEnd "Force on a flange that depends on the distance to an end of the stroke"
  extends PartialDrag;
  parameter Integer        side = 1    "+1 at the upper end, -1 at the lower end";
  parameter Units.Position s_lo = 0    "Lower end of the stroke";
  parameter Units.Position s_hi = 1    "Upper end of the stroke";

  Units.Length   x    "Distance to the end";
  Units.Velocity v_in "Speed towards the end";
equation
  x = if side > 0 then s_hi - s else s - s_lo;
  v_in = if side > 0 then v else -v;
end PartialEnd;
