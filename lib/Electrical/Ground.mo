within Electrical;
model Ground "Point of the circuit with potential 0"
  Pin p;
equation
  p.v = 0;
end Ground;
