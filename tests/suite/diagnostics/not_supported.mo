// status: 1
// error[MO0200] 9:3
// error[MO0200] 16:9
// error[MO0200] 23:7
// error[MO0200] 24:7
// error[MO0200] 25:3
// error[MO0200] 26:3
model NotNow
  Clock c = Clock(0.1);
  Real x(start = 0), y, z, u;
  Boolean b;
  inner Integer i(start = 0);
  model A
    outer output Integer i;
  equation
    i = previous(i) + 2;
  end A;
  A a1, a2;
equation
  when c then
    x = previous(x) + 1;
  end when;
  y = hold(x);
  z = inStream(y);
  initialState(a1);
  transition(a1, a2, i > 10, immediate = false);
end NotNow;
