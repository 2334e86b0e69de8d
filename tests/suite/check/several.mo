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

  model TooFew "An equation is missing"
    Pin p, n;
  equation
    p.i + n.i = 0;
  end TooFew;

  model TooMany "One too many"
    input Real u;
    output Real y;
  equation
    y = u;
    y = 2*u;
  end TooMany;

  model Undeclared
    Real x = z;
    Real y = w;
  end Undeclared;

  model Singular
    Real a, b;
  equation
    a + b = 1;
    2*a + 2*b = a + b + time - a - b;
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
