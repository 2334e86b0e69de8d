// status: 1
// error[MO0200] 8:32
// error[MO0201] 9:16
// error[MO0200] 17:32
// What can not be known is said once: nothing follows from it where it is used.
model Sampled
  "A clock that comes in from outside"
  connector ClockInput = input Clock;
  type Level = Reel;
  ClockInput c;
  Level h;
  Real u = time, y, z;
equation
  when c then
    y = u + h;
  end when;
  z = h + sample(u, c) + y*u + sample(u);
end Sampled;
