//@ case bridge_of_resistors
//@ snapshot structure
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
//@ expect structure has 3 "linear system of 7, torn to 1: a"
// The potentials of the closed form: the bridge is a 2 by 2 system.
//@ let g1 = 0.1
//@ let g2 = 1/20
//@ let g3 = 1/30
//@ let g4 = 1/40
//@ let g5 = 1/50
//@ let aa = g1 + g3 + g5
//@ let bb = g2 + g4 + g5
//@ expect a = (bb*g1 + g5*g2)*sin(1)/(aa*bb - g5^2) abs 1e-12
