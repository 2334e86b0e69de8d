// status: 1
// error[MO0306] 9:3
model Count
  Integer n(start = 0, fixed = true);
equation
  when time > 0.5 then
    n = 1;
  end when;
  when time > 0.7 then
    n = 2;
  end when;
end Count;
