// status: 1
// error[MO0226] 16:10
// error[MO0226] 20:10
// error[MO0226] 24:16
// error[MO0226] 25:17
// error[MO0226] 29:16
// error[MO0226] 33:12
// error[MO0226] 36:10
// error[MO0227] 45:13
// error[MO0228] 49:18
// error[MO0228] 58:17
// error[MO0226] 59:8
// error[MO0218] 65:7
model KindsOfClasses
  type State = enumeration(
    off, start);

  connector Bad
  protected
    Real hidden;
  end Bad;

  record Data
    input Real u;
    output Real y;
  end Data;

  record Rule
    outer Real x;
    Real y;
  end Rule;

  function twice
    input Real u;
    output Real y;
    Real between;
  equation
    y = 2*u;
  end twice;

  model Part
    Real x = 1;
  end Part;
  block Wrong
    extends Part;
  end Wrong;
  connector Flows
    Real e;
    flow Integer f;
  end Flows;

  Bad bad;
  Data data(u = 1, y = 2);
  inner Real x = 1;
  Rule rule(y = 1);
  Wrong wrong;
  Flows flows;
  constant Part part;
  Real String = 3;
  Real y;
  Real t = twice(1);
  State state = State.off;
equation
  y = 1;
  for i loop
    y = 1;
  end for;
end KindsOfClasses;
