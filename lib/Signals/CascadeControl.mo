within Signals;
block CascadeControl "Drive under control: proportional for the position, around proportional for the speed"
  // y = k_v (k_p (s_ref - s) - v): the deviation of the position asks for a speed, the deviation from that for the signal.
  parameter Units.PerTime  k_p "Speed asked for by the deviation of the position";
  parameter Real           k_v(unit = "V.s/m") "Signal by the deviation of the speed";

  input Units.Position s_ref "Where the drive is to be";
  input Units.Position s     "Where it is";
  input Units.Velocity v     "Its speed";
  output Units.Voltage y     "The signal for the drive";
equation
  y = k_v*(k_p*(s_ref - s) - v);
end CascadeControl;
