within Signals;
model PilotValve "Solenoid pilot valve: follows a switch with a delay and a lag"
  // Each edge of the switch takes effect t_delay later. Only one edge of each kind can be pending at a time, so the
  // switching period must be longer than t_delay.
  parameter Units.Time t_delay "Delay of each edge";
  parameter Units.Time tau     "Time constant of the opening";
  parameter Units.Time t_off_more   = 0 "Delay of switching off in addition to t_delay";
  parameter Units.Time tau_off_more = 0 "Time constant of closing in addition to tau";
  input Boolean on "The switch";

  Units.Fraction x(start = 0, fixed = true) "Opening, 0 closed to 1 open";
  Boolean open(start = false, fixed = true) "Target of the opening";
protected
  constant Units.Time never = 1e30;
  discrete Units.Time t_open(start = never, fixed = true)  "When the last switching-on takes effect";
  discrete Units.Time t_close(start = never, fixed = true) "When the last switching-off takes effect";
equation
  when {initial(), on} then
    t_open = if on then time + t_delay else never;
  end when;
  when not on then
    t_close = time + t_delay + t_off_more;
  end when;
  when time >= t_open then
    open = true;
  elsewhen time >= t_close then
    open = false;
  end when;
  (if open then tau else tau + tau_off_more)*der(x) = (if open then 1 else 0) - x;

  annotation(__mocc(
    effect   = "amplitude=t_off_more,tau_off_more",
    explains = "%at switches off more slowly than on, or faster."));
end PilotValve;
