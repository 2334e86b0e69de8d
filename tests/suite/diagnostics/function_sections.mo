// status: 1
// error[MO0226] 10:3
// error[MO0226] 18:3
// error[MO0208] 31:14
// error[MO0208] 32:14
package P
  function begun
    input Real x;
    output Real y;
  initial algorithm
    y := x;
  end begun;
  function twice
    input Real x;
    output Real y;
  algorithm
    y := x;
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
    Real c = open(1);
    Real d = short(1);
  end Top;
end P;
