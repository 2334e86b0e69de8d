// status: 1
// error[MO0226] 17:24
// error[MO0226] 19:13
// error[MO0226] 21:16
// error[MO0226] 26:10
// error[MO0226] 30:12
// error[MO0226] 35:10
// error[MO0226] 35:10
// error[MO0227] 46:13
// error[MO0228] 50:9
// error[MO0228] 53:15
// error[MO0226] 54:8
// error[MO0218] 59:7
// error[MO0230] 63:11
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

  constant Part part;
  Real String = 3;
  Real y;
  State state = State.off;
equation
  y = 1;
  for i loop
    y = 1;
  end for;
end KindsOfClasses;
