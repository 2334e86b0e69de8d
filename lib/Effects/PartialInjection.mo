within Effects;
partial model PartialInjection "Current into a pin, from outside of the circuit"
  Units.Voltage v "Potential";
  Units.Current i "Current into what is connected";

  Electrical.Pin p "Where it enters";
equation
  v = p.v;
  p.i = -i;
end PartialInjection;
