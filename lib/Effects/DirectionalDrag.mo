within Effects;
model DirectionalDrag "Damping that differs between the two directions"
  //   f = -d |v|
  // The damping is greater by d v towards +s and smaller by d v towards -s, as observed in drives and ball screws. A
  // mass m with this force alone slows down as exp(-d t/m) towards +s and speeds up as exp(d t/m) towards -s.
  // Source: Janot, Gautier and Brunot (2019), "Data Set and Reference Models of EMPS", asymmetric model.
  extends PartialDrag;
  parameter Real d(unit = "N.s/m") = 0 "Half the difference between the damping coefficients of the two directions";
equation
  f = -d*noEvent(abs(v));

  annotation(__mocc(
    effect   = "amplitude=d",
    law      = "f = -d |v|",
    explains = "%at is damped more in one direction than in the other."));
end DirectionalDrag;
