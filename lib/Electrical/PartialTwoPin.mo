within Electrical;
partial model PartialTwoPin "Component between two pins"
  Units.Voltage v "Voltage: p.v - n.v";
  Units.Current i "Current from p to n";

  Pin p "Positive pin";
  Pin n "Negative pin";
equation
  v = p.v - n.v;
  p.i = i;
  n.i = -i;
end PartialTwoPin;
