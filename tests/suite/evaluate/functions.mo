//@ case function_arguments
model Call
  function twice
    input Real x;
    output Real y = 2*x;
  end twice;
  //@ error[MO0219] 12-18
  Real a = twice();
  //@ error[MO0219] 12-22
  Real b = twice(1, 2);
  //@ error[MO0219] 18
  Real c = twice(z = 2);
end Call;

//@ case function_sections
package P
  function begun
    input Real x;
    output Real y;
  //@ error[MO0226] 3-
  initial algorithm
    y := x;
  end begun;
  function twice
    input Real x;
    output Real y;
  algorithm
    y := x;
  //@ error[MO0226] 3-
  algorithm
    y := 2*y;
  end twice;
  partial function open
    input Real x;
    output Real y;
  algorithm
    y := x;
  end open;
  function short = open;
  model Top
    Real a = begun(1);
    Real b = twice(1);
    //@ error[MO0208] 14-20
    Real c = open(1);
    //@ error[MO0208] 14-21
    Real d = short(1);
  end Top;
end P;

//@ case derived_functions
model DerivedFunctions
  function f
    input Real x;
    input Real u[2];
    output Real y = x + u[1];
  algorithm
  end f;
  //@ error[MO0219] 29
  function by_what = der(f, z);
  function by_array = der(f, u);
  //@ error[MO0219] 26-29
  function of_what = der(Real, x);
  Real a = by_what(time, {1, 2});
  //@ error[MO0200] 12-33
  Real b = by_array(time, {1, 2});
  //@ error[MO0219] 12-24
  Real c = of_what(time);
end DerivedFunctions;

//@ case recursion_without_end
// A depth that only a run knows, of vectors that get shorter: such a function has no sizes of its own.
model Sums
  function sum
    input Real x;
    input Real v[:];
    output Real s;
  algorithm
    // It never looks whether there are elements left.
    //@ error[MO0221] 31-50
    s := if x < 0 then 0 else sum(x - 1, v[2:end]) + sum(x - 2, cat(1, v, {x}));
  end sum;
  Real s = sum(time, {1, 2, 3});
end Sums;
