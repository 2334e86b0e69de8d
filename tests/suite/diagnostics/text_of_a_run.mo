// status: 1
// error[MO0268] 8:28
// error[MO0200] 8:37
// error[MO0200] 10:26
// A text that only a run knows is good for messages, and for nothing else.
model Gauge
  Real p(start = 1, fixed = true);
  parameter String shown = "p = " + String(p);
  Integer n = if time > 0.5 then 2 else 1;
  Boolean low = "n = " + String(n) == "n = 1";
  Boolean same = shown == "p = 1";
equation
  der(p) = -p;
  assert(p < 2, shown + " is too much after " + String(time) + " s");
end Gauge;
