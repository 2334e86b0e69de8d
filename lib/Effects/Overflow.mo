within Effects;
model Overflow "Liquid that runs over the edge of a tank"
  //   q_in = k_in (h - h_max)^(3/2),   q_out = k_out (h - h_max)^(3/2)
  // The law of a weir with the height h_max: q_in falls where the outlet leads, q_out is lost. Above a closed outlet
  // the level falls as (h_0 - h_max)/(1 + k (h_0 - h_max)^(1/2) t/(2 A))^2.
  // Source: Poleni (1717), "De motu aquae mixto"; Henderson (1966), "Open Channel Flow", section 6.2.
  parameter Real           k_in(unit = "m1.5/s")  = 0 "Coefficient of the flow to where the outlet leads";
  parameter Real           k_out(unit = "m1.5/s") = 0 "Coefficient of the flow that is lost";
  parameter Units.Position h_max = 1 "Height of the edge";

  Units.Position h "Level";
  Real           w(unit = "m1.5") "Shape of the flow over the edge";

  Tanks.Port port_a "The tank";
  Tanks.Port port_b "Other end of its outlet";
protected
  Units.Length over "Height of the liquid above the edge";
equation
  h = port_a.h;
  over = noEvent(max(h - h_max, 0));
  w = over*sqrt(over + 1e-9);
  port_a.q = (k_in + k_out)*w;
  port_b.q = -k_in*w;

  annotation(__mocc(
    effect   = "amplitude=k_in>0,k_out>0; host=port_a,port_b; h_max=h(8)",
    law      = "q_in = k_in (h - h_max)^(3/2)",
    explains = "The tank in front of %at runs over."));
end Overflow;
