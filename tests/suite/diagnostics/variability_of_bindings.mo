// status: 1
// error[MO0268] 9:23
// error[MO0268] 11:22
// error[MO0248] 14:21
// error[MO0212] 15:16
// error[MO0212] 17:15
model Bindings
  parameter Real p = 1;
  constant Real c = 2*p;
  Real x = time;
  parameter Real q = x + 1;
  parameter Real r = p + c;
  constant Integer n = size({p, p}, 1);
  discrete Real d = 1;
  Real slope = der(d);
  parameter Integer k = 3;
  Real rate = der(k);
end Bindings;
