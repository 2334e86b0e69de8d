package Chain
  connector Flange
    Real s(unit="m");
    flow Real f(unit="N");
  end Flange;
  model Fixed
    Flange flange;
  equation
    flange.s = 0;
  end Fixed;
  model Mass
    parameter Real m(unit="kg") = 1;
    parameter Real s0 = 0;
    Flange a;
    Flange b;
    Real s(start = s0, fixed = true);
    Real v(start = 0, fixed = true);
  equation
    a.s = s;
    b.s = s;
    der(s) = v;
    m*der(v) = a.f + b.f;
  end Mass;
  model SpringDamper
    parameter Real c = 100;
    parameter Real d = 0.1;
    Flange a;
    Flange b;
    Real s_rel;
    Real v_rel;
    Real f;
  equation
    s_rel = b.s - a.s;
    v_rel = der(s_rel);
    f = c*s_rel + d*v_rel;
    b.f = f;
    a.f = -f;
  end SpringDamper;
  model Test
    parameter Integer N = 1000;
    Fixed wall;
    Mass mass[N](s0 = {if i == 1 then 0.1 else 0 for i in 1:N});
    SpringDamper spring[N];
  equation
    connect(wall.flange, spring[1].a);
    for i in 1:N loop
      connect(spring[i].b, mass[i].a);
    end for;
    for i in 1:N-1 loop
      connect(mass[i].b, spring[i+1].a);
    end for;
  end Test;
end Chain;
