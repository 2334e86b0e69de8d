within Translational;
model StopMass "Rigid body between two stops without rebound, with friction of seals"
  // The body slides or rests; `mode` tells which. It changes only when
  //   - the driving force on the resting body exceeds what static friction can hold (breakaway),
  //   - the body reaches a stop,
  //   - its speed passes through zero (it locks; it may break away again within the same event).
  // Where nothing can hold it at rest (f_static = 0: no friction, bristles, smoothed friction), a body whose speed
  // passes through zero continues freely in either direction, without further events, until it meets a stop or static
  // friction. Friction without f_static must vanish with the speed, as f_slide, or act as f_push.
  // With has_bristles, elastic bristles carry the friction of the seals, as in LuGre:
  //   df_z/dt = sigma_0 (v - |v| f_z/g),   f_bristles = f_z + sigma_1 (v - |v| f_z/g)
  // where g is the dry friction that the seals have while sliding. The body then yields before it slips.
  // Source: Canudas de Wit, Olsson, Åström and Lischinsky (1995), "A New Model for Control of Systems with Friction",
  // IEEE Trans. Automatic Control 40(3).
  // Friction that has grown at rest is lost as the contacts slip: with slip_length, the time without operation falls
  // from its value at rest to that of a fresh contact,
  //   dt_no/dt = -|v| (t_no - t_fresh)/slip_length
  // Source: Dieterich (1979), "Modeling of Rock Friction 1", Journal of Geophysical Research 84(B5): contacts are
  // renewed over a characteristic path. Without it, the friction keeps the value of rest until the body locks again.
  // Source: Otter, Elmqvist, Mattsson (1999), "Hybrid Modeling in Modelica based on the
  // Synchronous Data Flow Principle". A resting body has exactly zero speed and acceleration.
  parameter Units.Mass     m              "Mass";
  parameter Units.Position s_min      = 0 "Lower stop";
  parameter Units.Position s_max          "Upper stop";
  parameter Units.Position s_start    = s_min         "Position at the start";
  parameter Units.Velocity v_start    = 0             "Speed at the start, 0 if it rests";
  parameter Motion         mode_start = Motion.AtMin  "Motion before the start";
  parameter Units.Time     t_no_start = 0 "Time without operation before the start";

  parameter Boolean  has_bristles = false "True if bristles carry the friction of the seals";
  parameter Units.SpringStiffness    sigma_0 = 1e6 "Bristles: stiffness";
  parameter Units.DampingCoefficient sigma_1 = 300 "Bristles: damping";
  parameter Units.Length             slip_length = 0 "Path over which sliding renews the contacts; 0: it does not";
  parameter Units.Time               t_fresh = 0   "Time without operation that a fresh contact corresponds to";

  Units.Position     s(start = s_start, fixed = true, nominal = s_max - s_min, stateSelect = StateSelect.prefer)
    "Stroke";
  Units.Velocity     v(start = v_start, fixed = true, nominal = 0.1, stateSelect = StateSelect.prefer)
    "Speed";
  Units.Acceleration a
    "Acceleration";
  Units.Time         t_no(start = t_no_start, fixed = true)
    "Time without operation: grows at rest, kept or lost while sliding";

  Motion  mode(start = mode_start, fixed = true) "Motion of the body";
  Boolean locked(start = true) "True at rest, stops included";

  Units.Force f        "Driving force: all but friction, positive towards +s";
  Units.Force f_slide  "Dry friction while sliding, sum over the seals";
  Units.Force f_static "Friction available at rest, sum over the seals";
  Units.Force f_z(start = 0, fixed = has_bristles) "Elastic force of the bristles";

  Flange      flange "Forces that drive the body";
  SpoolFlange seals  "Seals on the body";
protected
  constant Units.Force f_least = 1e-3 "Friction below which bristles would be too stiff for it";
  Units.Velocity v_z "Speed at which the bristles bend";
  // Each of the five is the argument of one relation. Where a relation is irrelevant, its argument is kept away
  // from the threshold, so that a relation changes if and only if the physics does.
  Units.Force    f_ahead  "Driving force towards +s on a body that rests and may go there";
  Units.Force    f_behind "Driving force towards -s on a body that rests and may go there";
  Units.Velocity v_along  "Speed in the direction of sliding";
  Units.Length   s_left   "Distance to the stop in the direction of sliding, or to the nearer one";
  Units.Force    f_held   "Friction available at rest to a body that moves freely";
equation
  // Motion
  der(s) = v;
  der(v) = a;
  m*a = if mode == Motion.Forward then f - f_slide
    elseif mode == Motion.Backward then f + f_slide
    elseif mode == Motion.Free then (if noEvent(v >= 0) then f - f_slide else f + f_slide)
    else 0;
  der(t_no) = if locked then 1
    elseif slip_length > 0 then -noEvent(abs(v))*(t_no - t_fresh)/slip_length
    else 0;

  // Connections
  if has_bristles then
    v_z = v - noEvent(abs(v))*f_z/noEvent(max(seals.f_slide, f_least));
    der(f_z) = sigma_0*v_z;
    f = flange.f + seals.f_push - f_z - sigma_1*v_z;
    f_slide = 0;
    f_static = 0;
  else
    v_z = 0;
    f_z = 0;
    f = flange.f + seals.f_push;
    f_slide = seals.f_slide;
    f_static = seals.f_static;
  end if;
  flange.s = s;
  seals.s = s;
  seals.v = v;
  seals.t_no = t_no;

  // Switching
  f_ahead  = if pre(mode) == Motion.AtMin or pre(mode) == Motion.Locked then f else 0;
  f_behind = if pre(mode) == Motion.AtMax or pre(mode) == Motion.Locked then -f else 0;
  v_along  = if pre(mode) == Motion.Forward then v elseif pre(mode) == Motion.Backward then -v else 0;
  s_left   = if pre(mode) == Motion.Forward then s_max - s elseif pre(mode) == Motion.Backward then s - s_min
    elseif pre(mode) == Motion.Free then noEvent(min(s_max - s, s - s_min))
    else s_max - s_min;
  f_held   = if pre(mode) == Motion.Free then f_static else 0;

  mode = if s_left <= 0 then (if noEvent(s_max - s < s - s_min) then Motion.AtMax else Motion.AtMin)
    elseif v_along < 0 then (if noEvent(f_static > 0) then Motion.Locked else Motion.Free)
    elseif f_held > 0 then (if noEvent(v > 0) then Motion.Forward elseif noEvent(v < 0) then Motion.Backward
      else Motion.Locked)
    elseif f_ahead > f_static then Motion.Forward
    elseif f_behind > f_static then Motion.Backward
    else pre(mode);
  locked = mode == Motion.AtMin or mode == Motion.Locked or mode == Motion.AtMax;

  when locked then
    reinit(v, 0);
    reinit(t_no, 0);
  end when;
  when mode == Motion.AtMax then
    reinit(s, s_max);
  elsewhen mode == Motion.AtMin then
    reinit(s, s_min);
  end when;
  assert(s_max > s_min, "StopMass: the upper stop s_max must lie above the lower stop s_min");

  annotation(__mocc(
    choice   = "with has_bristles=true; sigma_0=5e4,2e5,1e6; sigma_1=10,100; slip_length=1e-5,1e-4; t_fresh=0.1,10;
      named=Friction.LuGre",
    chosen   = "f = f_z + sigma_1 v_z,  der(f_z) = sigma_0 v_z,  v_z = v - |v| f_z/f_slide,  der(t_no) = -|v| (t_no - t_fresh)/slip_length",
    explains = "Elastic bristles carry the friction of %at, which yields before it slips (LuGre)."));
end StopMass;
