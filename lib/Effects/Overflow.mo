within Effects;
model Overflow "Liquid that runs over the edge of a tank"
  // Over the edge of the height h_max runs w = (h - h_max)^(3/2), the law of a weir: the part k_in of it falls where
  // the outlet leads, the part k_out is lost. Poleni (1717), "De motu aquae mixto"; Henderson (1966), "Open Channel
  // Flow", section 6.2. Above an outlet that is shut the level falls as (h_0 - h_max)/(1 + k (h_0 - h_max)^(1/2) t/(2 A))^2.
  parameter Real           k_in(unit = "m1.5/s")  = 0 "What falls where the outlet leads";
  parameter Real           k_out(unit = "m1.5/s") = 0 "What is lost";
  parameter Units.Position h_max = 1 "Height of the edge";

  Units.Position h "Level";
  Real           w(unit = "m1.5") "Course of the flow over the edge";

  Tanks.Port port_a "The tank";
  Tanks.Port port_b "Where its outlet leads";
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
    explains = "The tank before %at runs over."));
end Overflow;
