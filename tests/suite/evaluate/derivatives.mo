//@ case partial_derivatives
//@ run interval=0.1
// Gibbs' function gives entropy and volume as its partial derivatives.
model Derived
  function f
    input Real x;
    input Real y;
    input Integer n = 2;
    output Real a;
    output Real b;
  protected
    Real h;
  algorithm
    h := x * y;
    for i in 1:n loop
      h := h * sin(x);
    end for;
    if x > 0.55 then
      a := h + x ^ 2;
    else
      a := exp(x * y);
    end if;
    b := sqrt(x ^ 2 + y ^ 2);
  end f;
  function f_x = der(f, x);
  function f_xy = der(f_x, y);
  function f_xx = der(f, x, x);
  Real x = 0.1 + time;
  Real a_x, b_x, a_xy, b_xy, b_xx;
  Real by_hand[3];
equation
  (a_x, b_x) = f_x(x, 3 * x);
  (a_xy, b_xy) = f_xy(x, y = 3 * x);
  (, b_xx) = f_xx(x, y = 3 * x);
  by_hand[1] = if x > 0.55 then 3 * x * sin(x) ^ 2 + 6 * x ^ 2 * sin(x) * cos(x) + 2 * x
    else 3 * x * exp(3 * x ^ 2);
  by_hand[2] = if x > 0.55 then sin(x) ^ 2 + 2 * x * sin(x) * cos(x)
    else (1 + 3 * x ^ 2) * exp(3 * x ^ 2);
  by_hand[3] = 0.9 / (sqrt(10) * x);
end Derived;
// A relation in a function is no event: it may switch a row earlier.
//@ expect each a_x = by_hand[1] where abs(x - 0.55) >= 1e-9 rel 1e-12
//@ expect each a_xy = by_hand[2] where abs(x - 0.55) >= 1e-9 rel 1e-12
//@ expect each b_xx = by_hand[3] where abs(x - 0.55) >= 1e-9 rel 1e-12

//@ case derivative_of_a_call_with_a_loop
model Calls
  function doubled
    input Real x;
    output Real y = x;
  algorithm
    while y < 100 loop
      y := 2*y;
    end while;
  end doubled;
  function power
    input Real x;
    input Integer n;
    output Real y = 1;
  algorithm
    for i in 1:n loop
      y := y*x;
    end for;
  end power;
  Real x(start = 1, fixed = true);
  Integer n = integer(3.5 + 0*time);
  Real a = der(doubled(x));
  Real b = der(2*doubled(x) + x^2);
  Real c = der(power(x, n));
  Real d[2] = {der(power(1 + time, n)), der(power(x, n))};
equation
  der(x) = 1;
  annotation(experiment(StopTime = 0.5));
end Calls;
// At 0.5 s, x is 1.5: doubled(x) = 128 x, power(x, 3) = x^3.
//@ expect a, b, c = 128, 259, 6.75 rel 1e-9
//@ expect d[1], d[2] = 6.75, 6.75 rel 1e-9

//@ case derivative_of_a_recursion
model Recursion
  function rec
    input Real x;
    input Integer n;
    output Real y;
  algorithm
    if n <= 0 then
      y := 1;
    else
      y := x*rec(x, n - 1);
    end if;
  end rec;
  Integer n = integer(3.5 + 0*time);
  //@ error[MO0404] 8
  Real r = rec(1 + time, n);
  Real d = der(r);
end Recursion;
