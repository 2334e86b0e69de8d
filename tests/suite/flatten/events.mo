// When-clauses, reinit and initial equations stay what they are.
model Ball
  Real h;
  Real v;
  Integer n(start = 0, fixed = true);
initial equation
  h = 1;
  v = 0;
equation
  der(h) = v;
  der(v) = -9.81;
  when h <= 0 then
    reinit(v, -0.8*v);
    n = pre(n) + 1;
  elsewhen {initial(), sample(0, 0.5)} then
    n = 0;
  end when;
end Ball;
