within Effects;
model StretchOrifice "Damping between two bodies in proportion to the square of the difference of their speeds"
  //   f = k |v_rel| v_rel
  // A hydraulic damper whose oil flows through an orifice. The difference v of the speeds of two masses m with this alone
  // falls as 1/(1/v_0 + 2 k t/m).
  extends PartialStretchRate;
  parameter Real k(unit = "N.s2/m2") = 0 "Force per square of the speed";
equation
  f = k*noEvent(abs(v_rel))*v_rel;

  annotation(__mocc(
    effect   = "between=moving; amplitude=k>0",
    law      = "f = k |v_rel| v_rel",
    explains = "The deflection of %at is damped with the square of its speed."));
end StretchOrifice;
