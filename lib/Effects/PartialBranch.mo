within Effects;
partial model PartialBranch "Current between two pins, in addition to existing ones"
  Units.Voltage v "Voltage: p.v - n.v";
  Units.Current i "Current from p to n";

  Electrical.Pin p;
  Electrical.Pin n;
equation
  v = p.v - n.v;
  p.i = i;
  n.i = -i;
end PartialBranch;
