within Effects;
partial model PartialDrag "A force on a rigid connection that knows the speed"
  extends PartialForce;
  Units.Velocity v "Speed";
equation
  v = der(s);
end PartialDrag;
