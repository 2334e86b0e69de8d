within Effects;
model DirectionalFriction "Sliding friction that differs between the two directions"
  //   f = -F |tanh(v/v_0)|
  // The friction is greater by F against +v and smaller by F against -v, as with a lip whose flanks differ; at rest
  // nothing changes. It is smoothed over v_0, so the spool needs other friction to lock.
  extends PartialFriction;
  parameter Units.Force    F   = 0    "Half the difference between the two directions";
  parameter Units.Velocity v_0 = 1e-3 "Speed at which 76 % of it acts";
equation
  f_slide = F*tanh(v/v_0);
  f_static = 0;

  annotation(__mocc(
    effect   = "amplitude=F",
    law      = "f = -F |tanh(v/v_0)|",
    explains = "%at rubs more in one direction than in the other."));
end DirectionalFriction;
