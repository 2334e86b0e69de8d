//@ case several_problems
//@ check
//@ used by check.rs
// Each of these is wrong by itself, in the order of the text.
package Several
  connector Pin
    Real v;
    flow Real i;
  end Pin;

  model Resistor "Right"
    parameter Real R;
    Pin p, n;
  equation
    p.v - n.v = R*p.i;
    p.i + n.i = 0;
  end Resistor;

  //@ error[MO0234] 9-14
  model TooFew "An equation is missing"
    Pin p, n;
  equation
    p.i + n.i = 0;
  end TooFew;

  //@ error[MO0234] 9-15
  model TooMany "One too many"
    input Real u;
    output Real y;
  equation
    y = u;
    y = 2*u;
  end TooMany;

  model Undeclared
    //@ error[MO0202] 14
    Real x = z;
    //@ error[MO0202] 14
    Real y = w;
  end Undeclared;

  model Singular
    Real a, b;
  equation
    a + b = 1;
    2*a + 2*b = a + b + time - a - b;
    //@ error[MO0402] 5-17
    a = b - b + a;
  end Singular;

  partial model Open "Left to others"
    Real x;
  end Open;

  model OnlyInside "Has its `inner` around it elsewhere"
    outer parameter Real T;
    input Real u;
    output Real y = T*u;
  end OnlyInside;
end Several;
//@ expect messages lacks "Resistor"
//@ expect messages lacks "Open"
//@ expect messages lacks "OnlyInside"

//@ case functions_that_nothing_calls
//@ check
// Functions that nothing calls are read all the same; what depends on the sizes of their arguments is left open.
package Uncalled
  function scaled "Misspells its input"
    input Real gain;
    output Real y;
  algorithm
    //@ error[MO0202] 12-15
    y := 2*gian;
  end scaled;

  function mixed "Adds a text to a number"
    input Real x;
    output Real y;
  algorithm
    //@ error[MO0212] 10-18
    y := x + "one";
  end mixed;

  function third "Right for three elements or more"
    input Real v[:];
    output Real y;
  algorithm
    y := v[3];
  end third;

  model Idle
    Real x = time;
  end Idle;
end Uncalled;
//@ expect messages lacks "v[3]"
