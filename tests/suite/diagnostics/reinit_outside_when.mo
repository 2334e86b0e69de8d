// status: 1
// error[MO0231] 11:3
model Count
  Integer n(start = 0);
  Real x(start = 0);
equation
  der(x) = 1;
  when x > 0.5 then
    n = n + 1;
  end when;
  reinit(x, 0);
end Count;
