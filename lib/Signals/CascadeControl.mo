within Signals;
block CascadeControl "Cascaded control of a drive: proportional position and speed controllers"
  //   y = k_v (k_p (s_ref - s) - v)
  // The position error demands a speed, and the speed error gives the signal.
  parameter Units.PerTime  k_p "Demanded speed per position error";
  parameter Real           k_v(unit = "V.s/m") "Signal per speed error";

  input Units.Position s_ref "Reference position";
  input Units.Position s     "Position";
  input Units.Velocity v     "Speed";
  output Units.Voltage y     "Signal for the drive";
equation
  y = k_v*(k_p*(s_ref - s) - v);
end CascadeControl;
