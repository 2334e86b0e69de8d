within Signals;
model SwitchSignal "Switches on once and off once"
  parameter Units.Time t_on  = 0 "Switch-on impulse";
  parameter Units.Time t_off     "Switch-off impulse";
  Boolean on "The signal";
equation
  on = time >= t_on and time < t_off;
end SwitchSignal;
