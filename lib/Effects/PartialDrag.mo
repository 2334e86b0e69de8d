within Effects;
partial model PartialDrag "Force on a flange that depends on the speed"
  extends PartialForce;
  Units.Velocity v "Speed";
equation
  v = der(s);
end PartialDrag;
