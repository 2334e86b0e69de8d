within Effects;
model AngleDrag "Damping that grows with the angle"
  //   tau = -d x w,   x = (phi - phi_lo)/(phi_hi - phi_lo) for side > 0, else (phi_hi - phi)/(phi_hi - phi_lo)
  // A shaft that turns back and forth in a bearing or damper whose resistance depends on where it stands.
  extends PartialBearing;
  parameter Units.RotationalDamping d = 0 "Damping coefficient at the end where it is greatest";
  parameter Integer     side   = 1 "+1: greatest at the upper end, -1: at the lower end";
  parameter Units.Angle phi_lo = 0 "Lower end";
  parameter Units.Angle phi_hi = 1 "Upper end";
equation
  tau = -d*(if side > 0 then phi - phi_lo else phi_hi - phi)/(phi_hi - phi_lo)*w;

  annotation(__mocc(
    effect   = "amplitude=d>0; side=-1,1; phi_lo=min(phi); phi_hi=max(phi)",
    law      = "tau = -d (phi - phi_lo)/(phi_hi - phi_lo) w",
    explains = "%at is damped in proportion to its speed, the more the further it is towards an end."));
end AngleDrag;
