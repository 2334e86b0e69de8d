within Pneumatics;
model Restriction "Fixed restriction: a line, a port, a silencer"
  extends PartialRestriction;
equation
  opening = 1;

  annotation(__mocc(
    effect   = "amplitude=blocked",
    explains = "%at lets less air through than its sheet says, or more: dirt, or another restriction in series."));
end Restriction;
