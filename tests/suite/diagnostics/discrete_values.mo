// status: 1
// error[MO0247] 12:21
// error[MO0248] 14:24
model Discrete
  function above
    input Real x;
    output Boolean y;
  algorithm
    y := x > 0.5;
  end above;
  Boolean event = time > 0.5;
  Boolean through = above(time);
  Boolean quiet;
  discrete Real held = 1;
equation
  quiet = noEvent(time > 0.7);
end Discrete;
