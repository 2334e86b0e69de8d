within Translational;
model GuidedSpool "Spool that follows a given stroke, at any force"
  input Units.Position s "Stroke, with a continuous slope";

  Units.Velocity v = der(s)      "Speed";
  Units.Force    f = seals.f_push "Force of the seals along the axis but for friction, positive towards +s";

  SpoolFlange seals "Seals on the spool";
equation
  seals.s = s;
  seals.v = v;
  seals.t_no = 0;
end GuidedSpool;
