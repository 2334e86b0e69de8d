//@ case xorshift64star_and_xorshift128plus
//@ used by native.rs
// Random numbers are drawn at events.
package P
  function star
    input Integer before[2];
    output Integer after[2];
    output Real x;
  external "C" ModelicaRandom_xorshift64star(before, after, x);
  end star;
  function plus
    input Integer before[4];
    output Integer after[4];
    output Real x;
  external "C" ModelicaRandom_xorshift128plus(before, after, x);
  end plus;
  model Draws
    parameter Integer seed(fixed = false);
    parameter Integer first = seed + 1;
    Integer s[2];
    Integer t[4](start = {1, 2, 3, 4}, each fixed = true);
    discrete Real x;
    discrete Real y(start = 0, fixed = true);
  initial equation
    seed = 4;
    pre(s) = {first, -7};
    pre(x) = 0;
  equation
    when sample(0.1, 0.1) then
      (s, x) = star(pre(s));
      (t, y) = plus(pre(t));
    end when;
  end Draws;
end P;

//@ case xorshift1024star
//@ used by native.rs
package P
  function draw
    input Integer before[33];
    output Integer after[33];
    output Real x;
  external "C" ModelicaRandom_xorshift1024star(before, after, x);
  end draw;
  model Draws
    Integer s[33](start = {if k == 33 then 14 else 65537*k - 99 for k in 1:33}, each fixed = true);
    discrete Real x(start = 0, fixed = true);
  equation
    when sample(0.1, 0.1) then
      (s, x) = draw(pre(s));
    end when;
  end Draws;
end P;

//@ case hidden_state
//@ used by native.rs
// The generator that keeps its state to itself: of two when-clauses each draws the next numbers, those of
// one instant in order, after the one that is drawn at the start.
package P
  function begin
    input Integer seed[33];
    output Integer id;
  protected
    function set
      input Integer seed[33];
      input Integer id;
    external "C" ModelicaRandom_setInternalState_xorshift1024star(seed, 33, id);
    end set;
  algorithm
    id := 7;
    set(seed, id);
  end begin;
  impure function draw
    input Integer id;
    output Real y;
  external "C" y = ModelicaRandom_impureRandom_xorshift1024star(id);
  end draw;
  model Draws
    constant Integer state[33] = cat(1, {1234567*k - 20000000 for k in 1:32}, {3});
    parameter Integer id(fixed = false);
    parameter Real first = draw(id);
    Real seen = first;
    discrete Real a, b, c;
  initial equation
    id = begin(state);
  equation
    when sample(0.1, 0.2) then
      a = draw(id);
      b = draw(id) + draw(id);
    end when;
    when sample(0.1, 0.1) then
      c = draw(id);
    end when;
  end Draws;
end P;
