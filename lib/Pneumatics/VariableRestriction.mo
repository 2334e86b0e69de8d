within Pneumatics;
model VariableRestriction "Restriction opened from outside"
  extends PartialRestriction;
  input Units.Fraction x "Opening, 0 closed to 1 fully open";
equation
  opening = x;
end VariableRestriction;
