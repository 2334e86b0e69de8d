// status: 1
// error[MO0247] 13:21
// error[MO0248] 15:24
// error[MO0247] 17:3
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
  quiet = noEvent(time > 0.5);
end Discrete;
