//@ case counts_once_at_an_edge
//@ run also=flat
// On entry, a variable has its value from before the event (MLS 11.1.2).
model M
  Integer n(start = 0, fixed = true), k(start = 0, fixed = true);
  discrete Real x(start = 1, fixed = true);
algorithm
  when time > 0.5 then
    n := n + 1;
    n := n + 10;
  end when;
algorithm
  when sample(0.125, 0.25) then
    k := k + 1;
    x := 2*x;
  end when;
end M;
//@ expect n at 0.4, 1 = 0, 11
//@ expect k at 0.3, 0.4, 1 = 1, 2, 4
//@ expect x at 0.3, 0.4, 1 = 2, 4, 16

//@ case reads_before_it_writes
//@ run also=flat
model M
  Integer k(start = 3, fixed = true), m(start = 0, fixed = true), t(start = 0, fixed = true);
  Integer a(start = 1, fixed = true), b(start = 2, fixed = true), c(start = 0, fixed = true);
algorithm
  when time > 0.5 then
    m := k;
    k := 5;
    t := k;
  end when;
algorithm
  when sample(0.25, 0.25) then
    c := a;
    a := b;
    b := c;
  end when;
end M;
//@ expect k, m, t = 5, 3, 5
//@ expect a at 0.3, 0.6, 0.8 = 2, 1, 2
//@ expect b at 0.3, 0.6, 0.8 = 1, 2, 1

//@ case shift_register
//@ run interval=0.05 also=flat
model M
  discrete Real buf[3](each start = 0, each fixed = true), ring[3](each start = 0, each fixed = true);
  Integer at(start = 0, fixed = true);
algorithm
  when sample(0.1, 0.1) then
    buf[2:3] := buf[1:2];
    buf[1] := time;
    at := mod(at, 3) + 1;
    ring[at] := ring[at] + time;
  end when;
end M;
//@ expect buf[1:3] at 0.55 = 0.5, 0.4, 0.3 abs 1e-12
//@ expect ring[1:3] at 0.55 = 0.1 + 0.4, 0.2 + 0.5, 0.3 abs 1e-12

//@ case statements_in_order
//@ run also=flat
//@ snapshot flat
// `n` is 10 when the second statement runs, and 20 only then.
model M
  Integer n(start = 0, fixed = true), m(start = 0, fixed = true), before, after;
algorithm
  before := n;
  when time > 0.3 then
    n := 10;
  end when;
  when n > 5 then
    m := n;
  end when;
  when n > 5 then
    n := 20;
  end when;
  after := n;
end M;
//@ expect n at 0.2, 0.4, 1 = 0, 20, 20
//@ expect m at 0.2, 0.4, 1 = 0, 10, 10
//@ expect before, after = 20, 20

//@ case several_assignments
//@ run also=flat
// The rule of a single assignment (8.3.5.4) is about when-equations.
model M
  Integer n(start = 0, fixed = true), capped(start = 0, fixed = true), again(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
algorithm
  when time > 0.3 then
    n := 10;
  end when;
  if n > 20 then
    n := 0;
  end if;
algorithm
  when sample(0.1, 0.1) then
    capped := capped + 1;
  end when;
  if capped >= 4 then
    capped := 0;
  end if;
algorithm
  when time > 0.2 then
    x := x + time;
    again := again + 1;
  elsewhen time > 0.5 then
    x := 2*x;
  end when;
  when {time > 0.2, time > 0.7} then
    x := x + 1;
    again := again + 10;
  end when;
end M;
//@ expect n at 0.2, 0.4, 1 = 0, 10, 10
//@ expect capped at 0.35, 0.45, 0.55, 0.95 = 3, 0, 1, 1
//@ expect x at 0.1, 0.4, 0.6, 1 = 0, 1.2, 2.4, 3.4 abs 1e-12
//@ expect again at 0.1, 0.4, 0.6, 1 = 0, 11, 11, 21

//@ case during_initialization
//@ run also=flat
model M
  Integer n(start = 1, fixed = true), k(start = 1, fixed = true);
algorithm
  when initial() then
    n := n + 5;
  elsewhen time > 0.5 then
    n := n + 1;
  end when;
algorithm
  when initial() then
    k := 10*k;
  end when;
  when {initial(), time > 0.5} then
    k := k + 1;
  end when;
end M;
//@ expect n at start = 6
//@ expect n = 7
//@ expect k at start = 11
//@ expect k = 12

//@ case conditions_and_loops_in_a_clause
//@ run also=flat
model M
  function minmax
    input Real x[:];
    output Real least = min(x);
    output Real most = max(x);
    output Integer count = size(x, 1);
  algorithm
  end minmax;
  record R
    Integer a(start = 1, fixed = true);
    Real b(start = 2, fixed = true);
  end R;
  R r;
  Integer length(start = 2, fixed = true), total(start = 0, fixed = true), odd(start = 0, fixed = true);
  discrete Real low(start = 0, fixed = true), high(start = 0, fixed = true);
algorithm
  when sample(0.25, 0.25) then
    length := length + 1;
    total := 0;
    for i in 1:length loop
      if i == 4 then
        break;
      end if;
      for j in 1:2 loop
        total := total + i;
      end for;
    end for;
    if mod(length, 2) == 1 then
      odd := odd + 1;
    end if;
    r.a := r.a + length;
    r.b := r.b*r.a;
    (low, high) := minmax({r.b, -length, low});
    assert(high < 1e6, "reads the value that was just assigned");
  end when;
end M;
//@ expect length at 0.3, 0.6, 0.8 = 3, 4, 5
//@ expect total at 0.3, 0.6, 0.8 = 12, 12, 12
//@ expect odd at 0.3, 0.6, 0.8 = 1, 1, 2
//@ expect r.a at 0.3, 0.6, 0.8 = 4, 8, 13
//@ expect r.b at 0.3, 0.6, 0.8 = 8, 64, 832
//@ expect low at 0.3, 0.6, 0.8 = -3, -4, -5
//@ expect high at 0.3, 0.6, 0.8 = 8, 64, 832

//@ case edges_of_what_was_assigned
//@ run also=flat
model M
  Boolean up(start = false, fixed = true);
  Integer edges(start = 0, fixed = true), changes(start = 0, fixed = true);
algorithm
  when sample(0.1, 0.1) then
    up := not up;
    if edge(up) then
      edges := edges + 1;
    end if;
    if change(up) then
      changes := changes + 1;
    end if;
  end when;
end M;
//@ expect edges at 0.55 = 3
//@ expect changes at 0.55 = 5

//@ case ends_with_the_new_value
model M
  Integer n(start = 0, fixed = true);
algorithm
  when sample(0.1, 0.1) then
    n := n + 1;
    if n >= 3 then
      terminate("enough");
    end if;
  end when;
end M;
//@ expect n = 3
//@ expect time = 0.3 abs 1e-12

//@ case continuous_variables_begin_with_start
//@ run also=flat
model M
  Real y(start = 7), z;
  discrete Real seen(start = 0, fixed = true), later(start = 0, fixed = true);
algorithm
  when time > 0.5 then
    seen := y;
  end when;
  y := 10*time;
  when time > 0.5 then
    later := y;
  end when;
  z := y;
  y := y + 1;
end M;
//@ expect seen = 7
//@ expect later = 5 abs 1e-9
//@ expect each y = 10*time + 1 abs 1e-9
//@ expect each z = 10*time abs 1e-9
