within Pneumatics;
model Restriction "Fixed restriction: a line, a port, a silencer"
  extends PartialRestriction;
equation
  opening = 1;
end Restriction;
