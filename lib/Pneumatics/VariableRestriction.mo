within Pneumatics;
model VariableRestriction "Restriction opened from outside"
  extends PartialRestriction;
  input Units.Fraction x "Opening, 0 closed to 1 fully open";
equation
  opening = x;

  annotation(__mocc(
    effect   = "amplitude=blocked",
    explains = "%at lets less air through than its sheet says, or more: dirt, or another restriction in series."));
end VariableRestriction;
