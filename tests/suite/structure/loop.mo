// A bridge of resistors: one linear loop, torn.
model Bridge
  Real u = sin(time);
  Real a;
  Real b;
  Real i[5];
equation
  {u - a, u - b, a, b, a - b} = {10*i[1], 20*i[2], 30*i[3], 40*i[4], 50*i[5]};
  i[1] = i[3] + i[5];
  i[2] + i[5] = i[4];
end Bridge;
