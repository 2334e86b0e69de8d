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

//@ case slight_effects_are_not_solved_for
// The enthalpy of a liquid hardly depends on its pressure, so that the pressure does not follow from it.
model Liquid
  parameter Real T = 300;
  Real d(nominal = 1000, start = 1000);
  Real h(nominal = 1e6);
  Real p(nominal = 1e5);
  Real m = 2 + time;
equation
  h = 4200*(T - 278) + 1e-3*(p - 1e5);
  exp(d/1000 - 1) = exp(-2.57e-4*(h - 92400)/4200);
  sinh(p/1e5) = sinh(2 + 0.1*m^2/d);
end Liquid;
//@ expect structure has 3 "h := 4200.0"
//@ let d1 = 1000*(1 - 2.57e-4*1e-3*(1e5 + 90)/4200)
//@ expect d = d1 rel 1e-9
//@ expect p = 2e5 + 9e4/d1 rel 1e-9
