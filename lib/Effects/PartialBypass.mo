within Effects;
partial model PartialBypass "Flow between two connection sets, in addition to existing ones"
  Real de "Difference of the potentials: port_a.e - port_b.e";
  Real f  "Flow from a to b";

  AnyPort port_a;
  AnyPort port_b;
equation
  de = port_a.e - port_b.e;
  port_a.f = f;
  port_b.f = -f;
end PartialBypass;
