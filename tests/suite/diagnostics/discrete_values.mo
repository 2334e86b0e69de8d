// status: 1
// error[MO0247] 14:20
// error[MO0247] 17:21
// error[MO0248] 20:24
model Discrete
  function above
    input Real x;
    output Boolean y;
  algorithm
    y := x > 0.5;
  end above;
  record Level
    Real x;
    Boolean high = x > 0.5;
  end Level;
  Boolean event = time > 0.5;
  Boolean through = above(time);
  Level filled = Level(time);
  Boolean quiet;
  discrete Real held = 1;
equation
  quiet = noEvent(time > 0.7);
end Discrete;
