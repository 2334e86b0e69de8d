//@ case values_beyond_their_bounds
//@ check
// Values beyond the bounds of their parameters, as far as they are known without a run.
model Bounds
  type Length = Real(final unit = "m", min = 0);
  //@ warning[MO0273] 20-23
  parameter Length bore = -0.01;
  //@ warning[MO0273] 21-25
  parameter Integer seals(min = 1, max = 8) = 12;
  parameter Length land(max = 0.5) = 0.5;
  parameter Length stroke(max = bore) = 2*land;
  Real x(start = 1, fixed = true);
equation
  der(x) = -x;
end Bounds;
//@ expect messages lacks "`land`"
