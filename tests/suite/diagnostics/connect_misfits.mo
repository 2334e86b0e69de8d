// status: 1
// error[MO0230] 28:5
// error[MO0230] 29:13
// error[MO0231] 31:7
package P
  connector Signal = input Real;
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  connector Half
    input Real v;
    output Real i;
  end Half;
  model Part
    Pin p;
    Half h;
  equation
    p.v = 2*p.i;
    h.i = h.v;
  end Part;
  model Top
    Part one;
    Part two;
    Real x = 1;
    Real y;
  equation
    connect(one.p, two.h);
    connect(x, y);
    if time > 0.5 then
      connect(one.p, two.p);
    end if;
  end Top;
end P;
