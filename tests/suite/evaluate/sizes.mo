//@ case dimensions_of_one_component
// A size may be that of another dimension of the same component, as of a square matrix.
model Squares
  block StateSpace
    parameter Real A[:, size(A, 1)] = [1, 0; 0, 1];
    parameter Real B[size(A, 1), :] = [1; 1];
    parameter Real C[size(C, 2) - 1, :] = [1, 2];
    input Real u[size(B, 2)];
    output Real x[size(A, 1)](each start = 0, each fixed = true);
  equation
    der(x) = A * x + B * u;
  end StateSpace;
  StateSpace one(u = {1});
  StateSpace three(
    A = -identity(3), B = {{1, 0}, {0, 1}, {1, 1}}, u = {1, 2}, C = zeros(2, 3));
  Integer sizes[4] = {size(one.A, 2), size(one.C, 1), size(three.A, 2), size(three.C, 1)};
end Squares;
//@ expect one.x[2] = exp(1) - 1 rel 1e-5
//@ expect three.x[3] = 3*(1 - exp(-1)) rel 1e-5
//@ expect sizes[1:4] = 2, 1, 3, 2

//@ case array_types
// Types may be arrays: of locals, outputs and omitted inputs of functions, and of fields.
package Turns
  constant Integer n = 2;
  type Base = Real[3];
  type Vector extends Base(each unit = "m"); end Vector;
  type Pair = Vector[n];
  function unit_vector
    output Vector e;
  algorithm
    e[1] := 1;
  end unit_vector;
  function moved
    input Vector a;
    input Pair by;
    input Vector more = unit_vector();
    output Vector b;
  protected
    Vector t;
    Integer n = 7;
  algorithm
    t[1] := 5;
    for i in 2:3 loop
      t[i] := i;
    end for;
    b := a + t + by[1] + by[n - 5, :] + more;
  end moved;
  model Test
    Vector x = moved({time, 0, 0}, {{1, 2, 3}, {1, 1, 1}});
    Real h[2] = homotopy(actual = {time, 2}, simplified = {1, 1});
  end Test;
end Turns;
//@ expect x[1:3] = 9, 5, 7
//@ expect h[1:2] = 1, 2

//@ case from_start_values
model Sized
  parameter Real a[:] = {1, 2, 3};
  Real x[:](each fixed = true, start = 2*a);
equation
  der(x) = -x;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Sized;
//@ expect x[3] = 6*exp(-1) rel 1e-7

//@ case arrays_of_arrays_that_are_too_large
// Each of these would take more memory than there is.
model Large
  parameter Real v[100000] = ones(100000);
  //@ error[MO0297] 26-43
  parameter Real a = sum(outerProduct(v, v));
  //@ error[MO0297] 26-36
  parameter Real b = sum(diagonal(v));
  Real y = v[1];
end Large;

//@ case an_array_that_doubles
model Doubled
  function doubled
    input Integer n;
    output Real s;
  protected
    Real a[:];
  algorithm
    a := {1.0};
    for i in 1:n loop
      //@ error[MO0297] 12-23
      a := cat(1, a, a);
    end for;
    s := sum(a);
  end doubled;
  parameter Real x = doubled(60);
  Real y = x;
end Doubled;

//@ case sizes_by_values_of_real_arguments
//@ run stop=1
// The number of outputs is a value that a function computes from real numbers.
function largest
  input Real x[:];
  output Integer n = integer(max(x));
end largest;
function multiples
  input Real x[:];
  output Real y[n + size(x, 1)];
protected
  Integer n = largest(x);
algorithm
  for k in 1:size(y, 1) loop
    y[k] := k*x[1];
  end for;
end multiples;
model Sequence
  parameter Real weights[:] = {2, 3, 1};
  final parameter Real list[:] = multiples(weights);
  Real last = list[end]*time;
  Real count = size(list, 1)*time;
end Sequence;
//@ expect count at 1 = 6
//@ expect last at 1 = 12
