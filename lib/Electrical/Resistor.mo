within Electrical;
model Resistor "Linear resistor"
  //   v = R i
  extends PartialTwoPin;
  parameter Units.Resistance R "Resistance";
equation
  v = R*i;
end Resistor;
