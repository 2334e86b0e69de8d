within Effects;
model DirectionalDrag "Damping that is greater one way than the other"
  // f = -d |v|: d more than the damping that is there on the way to +s, d less on the way to -s. Drives and ball
  // screws are damped so, the more the faster they turn: the asymmetric model of Janot, Gautier, Brunot (2019), "Data
  // Set and Reference Models of EMPS". Alone on a mass m that moves to +s its speed falls as exp(-d t/m), to -s it
  // grows as exp(d t/m).
  extends PartialDrag;
  parameter Real d(unit = "N.s/m") = 0 "Half the difference of the damping coefficients of the two ways";
equation
  f = -d*noEvent(abs(v));

  annotation(__mocc(
    effect   = "amplitude=d",
    explains = "%at is damped more one way than the other."));
end DirectionalDrag;
