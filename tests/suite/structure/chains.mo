// Two volumes and a pipe between them: `semiLinear` with a common flow, which rests at the start.
model Chain
  parameter Real cold = 1;
  parameter Real hot = 5;
  Real rate = if time < 1 then 0 else time - 2.5;
  Real port;
  Real a;
  Real b;
  Boolean before(start = true);
  Boolean later(start = false);
initial equation
  pre(before) = false;
  pre(later) = pre(before);
equation
  a = semiLinear(rate, cold, port);
  b = semiLinear(-rate, hot, port);
  a + b = 0;
  before = time > 2 or pre(before);
  later = pre(before);
end Chain;
