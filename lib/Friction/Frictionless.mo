within Friction;
model Frictionless "No friction"
  extends Law;
equation
  f_slide = 0;
  f_static = 0;
end Frictionless;
