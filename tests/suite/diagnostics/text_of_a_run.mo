// status: 1
// error[MO0268] 8:28
// error[MO0247] 10:19
// Texts are compared at events; that of what changes between them is good for messages only.
model Gauge
  Real p(start = 1, fixed = true);
  Integer n = if time > 0.5 then 2 else 1;
  parameter String shown = "p = " + String(p);
  Boolean low = "n = " + String(n) == "n = 1";
  Boolean whole = String(p) == "1";
equation
  der(p) = -p;
  assert(p < 2, shown + " is too much after " + String(time) + " s");
end Gauge;
