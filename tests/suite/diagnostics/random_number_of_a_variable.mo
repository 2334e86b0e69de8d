// status: 1
// error[MO0290] 13:14
// error[MO0290] 16:9
// A generator that keeps its state gives another number at each call: what holds all the time can not call it.
package P
  impure function draw
    input Integer id;
    output Real y;
  external "C" y = ModelicaRandom_impureRandom_xorshift1024star(id);
  end draw;

  model Noise
    Real y = draw(7);
    Real z;
  equation
    z = draw(7);
  end Noise;
end P;
