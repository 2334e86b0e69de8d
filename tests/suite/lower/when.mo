//@ case two_whens_one_variable
model Count
  Integer n(start = 0, fixed = true);
equation
  when time > 0.5 then
    n = 1;
  end when;
  //@ error[MO0306] 3-
  when time > 0.7 then
    n = 2;
  end when;
end Count;
