//@ case subscript_out_of_range
model Sums
  Real a[3] = {1, 2, 3};
  //@ error[MO0216] 14
  Real b = a[4];
end Sums;

//@ case enumerations_misused
model Enumerations
  //@ error[MO1278] 42-46
  type Size = enumeration(small, medium, small);
  type Gear = enumeration(low, high);
  parameter Real ratio[Gear] = {3, 1};
  parameter Boolean on = true;
  Real flags[Boolean] = {0, 1};
  //@ error[MO1243] 18
  Real x = ratio[1];
  Real y = flags[on];
  //@ error[MO1243] 18
  Real z = flags[2];
  Real w = ratio[Gear.low];
  Size size = Size.medium;
end Enumerations;

//@ case size_of_something_missing
// A size that depends on something missing is not a second error.
model Sizes
  //@ error[MO0288] 29-32
  parameter Real given[:] = rows(3);
  //@ error[MO0202] 15-21
  Real y[:] = missing + given;
  Real z[size(y, 1)] = y;
end Sizes;

//@ case subscripts_in_branches_that_are_not_taken
// A subscript out of range counts only where it is read.
model Guarded
  parameter Real x[3] = {1, 2, 4};
  parameter Real on[Boolean] = {10, 20};
  function largest_below
    input Real x[:];
    input Integer n;
    output Real y = 0;
  algorithm
    for k in 1:size(x, 1) loop
      if k < size(x, 1) and x[k + 1] > x[k] then
        y := x[k + 1];
      end if;
    end for;
    if n >= 1 and n <= size(x, 1) and x[n] > 1 then
      y := x[n];
    elseif n > size(x, 1) then
      return;
    else
      y := 0;
    end if;
    y := y + x[n]/100;
  end largest_below;
  discrete Integer i(start = 1, fixed = true);
  Real chosen = if i <= 3 then x[i] else -1;
  Boolean large = i <= 3 and x[i] > 3;
  Boolean beyond = i > 3 or x[i] > 3;
  Real y = largest_below(x, i);
  Real z;
  Real o = on[i > 3];
  discrete Real last(start = 0, fixed = true);
equation
  if i <= 3 then
    z = x[i];
  else
    z = 0;
  end if;
  assert(i < 9, "never read: " + (if x[i] > 0 then "a" else "b"));
  when sample(1, 1) then
    i = pre(i) + 1;
    if pre(i) < 3 then
      last = x[pre(i) + 1];
    end if;
  end when;
end Guarded;
//@ run stop=1.5
//@ expect i, chosen, y, z, o, last = 2, 2, 2.02, 2, 10, 2
//@ run stop=3.5
//@ expect i, chosen, large, beyond, y, z, o, last = 4, -1, 0, 1, 4, 0, 20, 4

//@ case matrices_and_vectors
model Linear
  parameter Real A[2, 2] = [0, 1; -4, 0];
  parameter Real x_0[2] = {1, 0};
  Real x[2](start = x_0, each fixed = true);
  Real y = {3, 4}*{1, 2} + sum(A) + max(x_0);
  Real z[2] = transpose(A)*x_0;
  Real w[3] = cat(1, {1}, 2*ones(2));
equation
  der(x) = A*x;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Linear;
//@ expect x[1] = cos(2) rel 1e-7
//@ expect x[2] = -2*sin(2) rel 1e-7
//@ expect y = 11 - 3 + 1
//@ expect z[1:2] = 0, 1
//@ expect w[1], w[3] = 1, 2

//@ case vectors_of_subscripts
//@ run stop=0.6
// A vector of subscripts may hold variables, where elements are read and where they are assigned.
model Vectors
  Integer k(start = 1, fixed = true);
  Integer idx[2] = {k, 2};
  Real v[3] = {time, 2 * time, 3 * time};
  Real w[2] = v[idx];
  Real m[3, 3] = {{10 * i + j for j in 1:3} for i in 1:3};
  Real p[2, 2] = m[idx, {3, 1}];
  Real q[3, 2] = m[:, idx];
  Real a[3];
  function swap
    input Real u[3];
    input Integer i[2];
    output Real y[3] = u;
  algorithm
    y[i] := y[{i[2], i[1]}];
  end swap;
  Real s[3] = swap({1, 2, 3}, {k, 4 - k});
algorithm
  a := zeros(3);
  a[idx] := {7, 8};
equation
  when sample(0.25, 0.25) then
    k = if pre(k) < 3 then pre(k) + 1 else 1;
  end when;
end Vectors;
//@ expect k, w[1:2] = 3, 3*0.6, 2*0.6
//@ expect p[1,1:2], p[2,1:2] = 33, 31, 23, 21
//@ expect q[1,1:2], q[3,1:2] = 13, 12, 33, 32
//@ expect a[1:3] = 0, 8, 7
// First and last change places at the beginning and at the end.
//@ expect s[1:3] = 3, 2, 1
//@ expect s[1:3] at start = 3, 2, 1

//@ case tables_are_looked_up
//@ run stop=1 interval=0.125 also=flat
// Elements of known arrays are looked up, not chosen one by one: a straight line between squares.
model Lookup
  function lookup
    input Real x;
    output Real y;
  protected
    constant Real nodes[:] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    constant Real values[:, 2] = [0, 10; 1, 11; 4, 14; 9, 19; 16, 26; 25, 35; 36, 46; 49, 59; 64, 74; 81, 91];
    constant Integer places[10] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    Integer low;
    Integer high;
    Integer mid;
  algorithm
    low := 1;
    high := 10;
    while high - low > 1 loop
      mid := div(low + high, 2);
      if nodes[mid] > x then
        high := mid;
      else
        low := mid;
      end if;
    end while;
    y := values[places[low], 1] + (values[high, 1] - values[low, 1])*(x - nodes[low]);
  end lookup;
  parameter Real p[9] = {3, 1, 4, 1, 5, 9, 2, 6, 5};
  constant Real c[9] = {3, 1, 4, 1, 5, 9, 2, 6, 5};
  Integer i = integer(4*time) + 1;
  Real y = lookup(9*time);
  Real z = c[i];
  Real w = p[i];
parameter Real many[1000] = {k^2 for k in 1:1000};
Real square = many[100*i + 51];
end Lookup;
//@ let low(t) = min(floor(9*t), 8)
//@ let line(t) = low(t)^2 + (2*low(t) + 1)*(9*t - low(t))
//@ expect flat has "'$table3'['$table2'["
//@ expect flat has "z = '$table4'[i]"
//@ expect each y = line(time) where mod(8*time, 1) == 0 rel 1e-12
//@ expect z, w at 0.6 = 4
//@ expect z at 0.8 = 1
//@ expect square at start = 151^2
//@ expect square at 0.6 = 351^2

//@ case subscripts_known_at_run_time_are_assigned
//@ run stop=0.58
package P
  record Cell
    Real value;
    Integer writes;
  end Cell;
  function put
    input Real row[:];
    input Integer at;
    input Real value;
    output Real changed[size(row, 1)] = row;
  algorithm
    changed[at] := value;
  end put;
  model Memory
    Integer at(start = 0, fixed = true);
    Real table[2, 3](each start = 0, each fixed = true);
    Cell cells[3](each value(start = -1, fixed = true), each writes(start = 0, fixed = true));
    Real read;
    Real second = cells[if time > 0.55 then 2 else 3].value;
    Real moved[3] = put({1, 2, 3}, if time > 0.5 then 2 else 3, 10*time);
  algorithm
    when sample(0.1, 0.1) then
      at := mod(pre(at), 3) + 1;
      table[2, at] := time;
      table[1, :] := {at, 0, -at};
      cells[at].value := 10*time;
      cells[at].writes := pre(cells[at].writes) + 1;
    end when;
    read := table[2, if time > 0.35 then 3 else 1];
  end Memory;
end P;
// Written at 0.1 (first), 0.2 (second), 0.3 (third), and so on.
//@ expect table[2,1:3] = 0.4, 0.5, 0.3 rel 1e-12
//@ expect table[1,1], table[1,3] = 2, -2
//@ expect read = 0.3 rel 1e-12
//@ expect cells[2].value = 5 rel 1e-12
//@ expect second = 5 rel 1e-12
//@ expect cells[1].writes, cells[2].writes, cells[3].writes = 2, 2, 1
//@ expect moved[1], moved[3] = 1, 3
//@ expect moved[2] = 5.8 rel 1e-12

//@ case the_size_of_a_range_with_a_parameter
model Grid
  parameter Real step = 3;
  parameter Real last = 6;
  Real x[:] = 0:step:last;
  Real y[:] = last:-step:0;
end Grid;
//@ run stop=1
//@ expect x[1:3] = 0, 3, 6
//@ expect y[1:3] = 6, 3, 0

//@ case the_largest_of_one_number
model Peak
  Real x = time;
  //@ error[MO0219] 12-17
  Real y = max(x);
end Peak;

//@ case parts_of_arrays_without_elements
model Columns
  function count
    input Real h[:, 2] = fill(0, 0, 2);
    output Integer n;
  protected
    Real t[size(h, 1)] = h[:, 1];
    Real u[size(h, 1), 1] = h[:, {2}];
  algorithm
    n := size(t, 1) + 10*size(u, 2);
  end count;
  Integer none = count();
  Integer two = count({{1, 2}, {3, 4}});
end Columns;
//@ expect none, two = 10, 12
