within Electrical;
model Current "Current source, given by an input"
  input Units.Current i "Current that the source delivers, out of p";
  Pin p "Where the current leaves";
  Pin n "Where it returns";
equation
  p.i = -i;
  n.i = i;
end Current;
