// status: 1
// error[MO0200] 11:3
// error[MO0200] 19:9
// error[MO0200] 26:7
// error[MO0200] 27:7
// error[MO0200] 28:3
// error[MO0200] 29:3
// error[MO0200] 30:6
// error[MO0200] 33:7
model NotNow
  Clock c = Clock(0.1);
  Real x(start = 0), y, z, u;
  Boolean b;
  Real w[2] = {1, 2}, v[2];
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
  if Connections.isRoot(a1) then
    u = 1;
  end if;
  v = sample(w, c);
end NotNow;
