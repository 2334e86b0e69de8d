//@ case decay
//@ used by sensitivity.rs
model Decay
  parameter Real k = 2;
  Real x(start = 3, fixed = true);
  Real y = x ^ 2;
equation
  der(x) = -k * x;
end Decay;

//@ case nonlinear_loop_and_function
//@ used by sensitivity.rs
package P
  function half
    input Real u;
    output Real y;
  protected
    Real sum;
  algorithm
    sum := 0;
    for i in 1:20 loop
      sum := sum + u * 0.5 ^ (i + 1);
    end for;
    y := sum;
  end half;
  model Loop
    parameter Real a = 2;
    Real x(start = 1, fixed = true);
    Real z(start = 0.5);
    Real h = half(x);
  equation
    z ^ 3 + z = a * x;
    der(x) = -z;
  end Loop;
end P;
