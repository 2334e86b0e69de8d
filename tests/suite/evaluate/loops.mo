//@ case break_in_a_model
//@ run stop=2
model First
  Real x[3] = {time, 2*time, 5*time};
  Integer first;
  Integer seen;
algorithm
  first := 0;
  seen := 0;
  for k in 1:3 loop
    if x[k] > 1.5 then
      first := k;
      break;
    else
      seen := seen + 1;
    end if;
  end for;
end First;
//@ expect first at 0.2, 0.5, 1, 2 = 0, 3, 2, 1
//@ expect seen at 0.2, 0.5, 1, 2 = 3, 2, 1, 0

//@ case break_in_one_branch
model Branches
  function f
    input Real x;
    output Real y = 0;
  algorithm
    for k in 1:4 loop
      if x > 0 then
        if k > 2 then
          break;
        end if;
        y := y + 1;
      else
        y := y + 10;
      end if;
    end for;
    if x > 5 then
      if y > 1 then
        return;
      end if;
    end if;
    y := y + 100;
  end f;
  Real below = f(-1 - time);
  Real above = f(1 + time);
  Real far = f(6 + time);
end Branches;
//@ expect below, above, far = 140, 102, 2

//@ case ranges_known_at_run_time
//@ run stop=1.5 interval=0.25 also=flat
model Loops
  function total
    input Integer n;
    input Real x;
    output Real s = 0;
    output Integer squares = 0;
  protected
    Real v[5] = {1, 2, 3, 4, 5};
  algorithm
    for i in 1:n, j in 1:i loop
      s := s + x*i*j;
      if i == j then
        squares := squares + 1;
        v[i] := 0;
      end if;
    end for;
    for k in 5:-1:n loop
      if v[k] < 0.5 then
        break;
      end if;
      s := s + v[k];
    end for;
    for r in 0:0.1*x:0.3*x loop
      s := s + r;
    end for;
  end total;
  function first
    input Real x[:];
    input Real limit;
    input Integer n;
    output Integer at = 0;
  algorithm
    for i in 1:n loop
      if x[i] > limit then
        at := i;
        return;
      end if;
    end for;
    at := -1;
  end first;
  discrete Integer n(start = 1, fixed = true);
  Real s;
  Real squares;
  Real at;
  Integer m;
  Integer w[4];
equation
  (s, squares) = total(n, 2*time);
  at = first({1, 2, 3, 4}, 2.5, n);
  when sample(0.5, 0.5) then
    n = pre(n) + 1;
  end when;
algorithm
  m := 0;
  for i in 2:2:n loop
    m := m + i;
    w[i] := i;
  end for;
end Loops;
// With x = 2 t: x (1 + 2 + 4) for two rows, 5 + 4 + 3 after them, and 0.6 x.
//@ expect s, squares, at, m, w[2], w[4] at 0.75 = 23.4, 2, -1, 2, 2, 0 rel 1e-12
//@ expect s, squares, at, m, w[2], w[4] at 1.25 = 73, 3, 3, 2, 2, 0 rel 1e-12
//@ expect m, w[4] = 6, 4

//@ case branches_that_are_not_taken
//@ run stop=0.9 interval=0.1
// A loop that would never end is not run where its branch is not taken: in an equation, in an assertion, and
// in the loop of another function.
model Doublings
  function doublings
    input Real x;
    output Real n = 0;
  protected
    Real z = x;
  algorithm
    while z < 1 loop
      z := 2*z;
      n := n + 1;
    end while;
  end doublings;
  function total
    input Real x[2];
    input Integer turns;
    output Real sum = 0;
  protected
    Integer k = 0;
  algorithm
    while k < turns loop
      sum := sum + (if x[1] > 0 then doublings(x[1]) else 100) + (if x[2] > 0 then doublings(x[2]) else 10);
      k := k + 1;
    end while;
  end total;
  Real x = time - 0.5;
  Real s(start = 0, fixed = true);
  Integer turns = if time > 2 then 4 else 3;
  Real n = if x > 0 then doublings(x) else -1;
  Real sums = total({x, 0.25}, turns);
equation
  der(s) = if noEvent(x > 0) then 1 + 0*doublings(x) else 0;
  assert(noEvent(x <= 0 or doublings(x) < 1000), "too small");
end Doublings;
//@ expect n, sums at 0.2 = -1, 306
// 0.4 is doubled twice, 0.25 too.
//@ expect n, sums = 2, 12
//@ expect s = 0.4 rel 1e-6

//@ case break_and_return_in_nested_loops
// How often a number can be halved, the next one that is made of twos and threes, and the first square
// above it: loops in loops, left by `break` and `return`, whose length is known at run time.
package P
  function evened
    input Integer from;
    output Integer n;
  protected
    Integer rest;
  algorithm
    n := from;
    while true loop
      rest := n;
      while mod(rest, 2) == 0 loop
        rest := div(rest, 2);
      end while;
      while mod(rest, 3) == 0 loop
        rest := div(rest, 3);
      end while;
      if rest <= 1 then
        break;
      end if;
      n := n + 1;
    end while;
  end evened;
  function square
    input Integer above;
    output Integer root;
  algorithm
    root := 0;
    if above < 0 then
      return;
    end if;
    while root < 1000 loop
      root := root + 1;
      if root*root > above then
        return;
      end if;
    end while;
    root := -1;
  end square;
  model Top
    Integer k = 37 + integer(10*time);
    Integer n = evened(k);
    Integer r = square(k);
    Integer none = square(-k);
    Integer beyond = square(2000000 + k);
  end Top;
end P;
//@ run stop=0.5
//@ expect k, n, r at start = 37, 48, 7
//@ expect none, beyond at start = 0, -1
//@ run stop=1.25
//@ expect k, n, r = 49, 54, 8

//@ case table_in_a_when_clause
//@ run stop=999 interval=0.25 tolerance=1e-8
// A large table of parameters is looked up in the function, which each event calls. Its rows are the squares, so the
// function is their polygon; a later parameter is read by the table.
package Polygons
  function piece
    input Real table[:, 2];
    input Real t;
    input Integer last;
    output Real slope;
    output Real offset;
    output Real next;
    output Integer row;
  algorithm
    row := last;
    while row < size(table, 1) and t >= table[row, 1] loop
      row := row + 1;
    end while;
    next := table[row, 1];
    slope := (table[row, 2] - table[row - 1, 2])/(table[row, 1] - table[row - 1, 1]);
    offset := table[row - 1, 2] - slope*table[row - 1, 1];
  end piece;

  model Polygon
    parameter Real table[1001, 2] = {{i - 1, k*(i - 1)^2} for i in 1:1001};
    parameter Real k = 2;
    discrete Real slope, offset, next(start = 0, fixed = true);
    discrete Integer row(start = 1, fixed = true);
    Real y = slope*time + offset;
    Real area(start = 0, fixed = true);
  equation
    der(area) = y;
  algorithm
    when {initial(), time >= pre(next)} then
      (slope, offset, next, row) := piece(table, time, row);
    end when;
  end Polygon;
end Polygons;
//@ expect y at 0.5, 7.25 = 1, 2*49 + 0.25*30 rel 1e-9
// The trapezoidal rule: the sum of the squares, less half of the last.
//@ expect area = 2*(999*1000*1999/6 - 999^2/2) rel 1e-6

//@ case break_before_nested_loops
//@ run also=flat
// A loop in a loop that was left is not entered (MLS 11.2.5): each count is the number of iterations of a program with the
// same loops.
model M
  function f
    input Real x;
    output Real w;
  algorithm
    w := 0;
    for i in 1:3 loop
      if i > x then
        break;
      end if;
      for j in 1:2 loop
        w := w + 1;
      end for;
    end for;
  end f;
  function with_while
    input Real x;
    output Real w;
  protected
    Integer j;
  algorithm
    w := 0;
    for i in 1:3 loop
      if i > x then
        break;
      end if;
      j := 0;
      while j < 2 loop
        j := j + 1;
        w := w + 1;
      end while;
    end for;
  end with_while;
  function counted
    input Real x;
    input Integer n;
    output Real w;
  algorithm
    w := 0;
    for i in 1:n loop
      if i > x then
        break;
      end if;
      for j in 1:n loop
        if j > x + 1 then
          break;
        end if;
        for k in 1:2 loop
          w := w + 1;
        end for;
      end for;
    end for;
  end counted;
  Real x = 1.5 + 0.1*sin(time);
  Integer n(start = 3, fixed = true);
  Real a = f(x), b = f(1.5 + 0*time), c = with_while(x), d = counted(x, n), e = counted(x, 3), q, r;
equation
  when time > 2 then
    n = 4;
  end when;
algorithm
  q := 0;
  for i in 1:3 loop
    if i > x then
      break;
    end if;
    for j in 1:2 loop
      q := q + 1;
    end for;
  end for;
algorithm
  r := 0;
  for i in 1:n loop
    if i > x then
      break;
    end if;
    for j in 1:n loop
      r := r + 1;
    end for;
  end for;
end M;
//@ expect a, b, c, q = 2
//@ expect d, e = 4
//@ expect r = 3

//@ case return_after_break
model M
  function certain
    input Real x;
    output Real w;
  algorithm
    w := 1;
    for i in 1:3 loop
      if w > x then
        break;
      end if;
      return;
    end for;
    w := w + 1000;
  end certain;
  function perhaps
    input Real x;
    output Real w;
  algorithm
    w := 1;
    for i in 1:3 loop
      if w > x then
        break;
      end if;
      if w > x - 1 then
        return;
      end if;
      w := w + 1;
    end for;
    w := w + 1000;
  end perhaps;
  function nested
    input Real x;
    output Real w;
  algorithm
    w := 0;
    for i in 1:3 loop
      if i > x then
        break;
      end if;
      for j in 1:3 loop
        if i + j > 2*x then
          return;
        end if;
        w := w + 1;
      end for;
      w := w + 100;
    end for;
    w := w + 1000;
  end nested;
  function in_while
    input Real x;
    output Real n;
  algorithm
    n := 0;
    while n < 10 loop
      if n > x then
        break;
      end if;
      if n > 3 then
        return;
      end if;
      n := n + 1;
    end while;
    n := n + 1000;
  end in_while;
  Real s = 0.1*sin(time);
  Real b1 = certain(0.5 + s), r1 = certain(1.5 + s);
  Real b2 = perhaps(0.5 + s), r2 = perhaps(1.5 + s), r3 = perhaps(2.5 + s);
  Real n1 = nested(0.5 + s), n2 = nested(1.8 + s), n3 = nested(2.2 + s);
  Real w1 = in_while(1.5 + s), w2 = in_while(5.5 + s);
end M;
//@ expect b1, r1 = 1001, 1
//@ expect b2, r2, r3 = 1001, 1, 2
//@ expect n1, n2, n3 = 1000, 2, 105
//@ expect w1, w2 = 1002, 4

//@ case counted_loop_around_a_loop_counted_at_run_time
// The time of a call grows with the number of iterations, not by a power of it.
model M
  function f
    input Real x;
    input Integer n;
    output Real o;
  protected
    Real w;
  algorithm
    o := x;
    w := -1;
    for k in 1:40 loop
      w := max(o, w);
      for i in 1:n loop
        o := if o < x then 1 else w;
      end for;
      o := o + 0.5;
    end for;
  end f;
  Real x = 2 + time;
  Integer n(start = 2, fixed = true);
  Real y = f(x, n);
equation
  when time > 0.5 then
    n = 4;
  end when;
end M;
// Each of 40 iterations adds 0.5 to the largest value so far.
//@ expect each y = 2 + time + 20 abs 1e-9

//@ case loops_in_a_loop_in_a_loop
// The trip counts are known at run time only, and the loop in the `while` has an iterator of its own.
model Nested
  function f
    input Integer n;
    output Real y = 0;
  protected
    Integer j = 2, w = 0;
  algorithm
    for k1 in 1:mod(n, 4) loop
      while j < min(k1, n) and w < 5 loop
        w := w + 1;
        for k5 in -1:n loop
          j := k5;
        end for;
      end while;
      for k6 in -1:n loop
        y := y + 1;
      end for;
    end for;
  end f;
  Real y = f(integer(4*time + 1.5));
  Real z = sum(sum(i*k for k in 1:integer(i + time)) for i in 1:integer(3 + time));
end Nested;
// f(5) goes through the outer loop once; the inner sums are i*i*(i + 1)/2 at 0 s, with i + 1 terms and a fourth i at 1 s.
//@ run stop=1
//@ expect y at start = 3
//@ expect y = 7
//@ expect z at start = 1 + 6 + 18
//@ expect z = 3 + 12 + 30 + 60

//@ case relation_before_while
//@ run stop=1
// What a loop does not assign keeps its events: `x > 2.5` is a relation of the model.
model Model
  Real x(start = 2, fixed = true);
  Boolean big;
  Integer k;
  Real s;
algorithm
  s := 0;
  k := 0;
  big := x > 2.5;
  while s < 10 loop
    s := s + x + 1;
  end while;
  if big then
    k := 100;
  end if;
equation
  der(x) = 1;
end Model;
//@ expect k, s = 100, 12 abs 1e-9
//@ expect events "x > 2.5" = 1 at 0.5 abs 1e-9
