within Effects;
model DirectionalFriction "Friction while sliding that is greater one way than the other"
  // F more against +v, and F less against -v; nothing more at rest. A lip whose flanks differ does so.
  // Smoothed over v_0; the spool needs other friction besides, which locks it.
  extends PartialFriction;
  parameter Units.Force    F   = 0    "Half the difference of the two ways";
  parameter Units.Velocity v_0 = 1e-3 "Speed at which 76 % of it acts";
equation
  f_slide = F*tanh(v/v_0);
  f_static = 0;

  annotation(__mocc(
    effect   = "amplitude=F",
    explains = "%at rubs more one way than the other."));
end DirectionalFriction;
