//@ case synchronous_and_stream
model NotNow
  //@ error[MO0200] 3-7
  Clock c = Clock(0.1);
  Real x(start = 0), y, z, u;
  Boolean b;
  Real w[2] = {1, 2}, v[2];
  inner Integer i(start = 0);
  model A
    outer output Integer i;
  equation
    //@ error[MO0200] 9-16
    i = previous(i) + 2;
  end A;
  A a1, a2;
equation
  when c then
    x = previous(x) + 1;
  end when;
  //@ error[MO0200] 7-10
  y = hold(x);
  //@ error[MO1352] 16
  z = inStream(y);
  //@ error[MO0200] 3-14
  initialState(a1);
  //@ error[MO0200] 3-12
  transition(a1, a2, i > 10, immediate = false);
  //@ error[MO1353] 25-26
  if Connections.isRoot(a1) then
    u = 1;
  end if;
  //@ error[MO0200] 7-18
  v = sample(w, c);
end NotNow;

//@ case clock_connectors
// An unknown type is reported once: its uses cause no further errors.
model Sampled
  "A clock that comes in from outside"
  //@ error[MO0200] 32-36
  connector ClockInput = input Clock;
  //@ error[MO0201] 16-19
  type Level = Reel;
  ClockInput c;
  Level h;
  Real u = time, y, z;
equation
  when c then
    y = u + h;
  end when;
  //@ error[MO0200] 32-40
  z = h + sample(u, c) + y*u + sample(u);
end Sampled;

//@ case derivative_of_derivative
model Fall
  Real h(start = 1, fixed = true);
equation
  //@ error[MO0200] 3-13
  der(der(h)) = -9.81;
end Fall;
