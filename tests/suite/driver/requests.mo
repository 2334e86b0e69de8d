//@ case no_such_model
//@ run model=Tanks.Larg
//@ error[MO0104] nowhere
//@ status 2
package Tanks
  model Large
    Real x = 1;
  end Large;
end Tanks;

//@ case only_partial_models
//@ error[MO0106] 1
partial model Law
  Real v;
  Real f;
end Law;

//@ case unknown_override
//@ run set=mas=2
//@ status 2
//@ error[MO0241] nowhere
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;

//@ case override_of_a_variable
//@ run set=v=2
//@ status 2
//@ error[MO1213] nowhere
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;

//@ case override_of_a_final
//@ run set=body.mass=2
//@ status 2
//@ error[MO0209] at --set:1:16
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;
model Two
  Body body(final mass = 3);
end Two;

//@ case override_of_wrong_type
//@ error[MO0284] at --set:1:21-25
//@ run set=closed=5 set=kind=Kind.Steel
//@ status 2
//@ error[MO0212] at --set:1:16
model Body
  type Kind = enumeration(Oak, Ash);
  parameter Boolean closed = true;
  parameter Kind kind = Kind.Oak;
  Real v(start = 1);
equation
  der(v) = if closed and kind == Kind.Oak then -v else v;
end Body;

//@ case override_without_value
//@ run set=mass
//@ status 2
//@ error[MO0240] nowhere
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;

//@ case loop
//@ used by cli.rs
model Loop
  Real x(start = 1, fixed = true);
  Real z(start = 0.5);
equation
  z ^ 3 + z = 0.625 * x;
  der(x) = -z;
end Loop;

//@ case shop
//@ used by cli.rs
package Shop
  type Kind = enumeration(Slow, Fast);
  model Part
    parameter Real rate = 1;
    Real x(start = 1, fixed = true);
  equation
    der(x) = -rate*x;
  end Part;
  model Other
    Real y = 7*time;
  end Other;
  model Machine
    parameter Integer n = 2;
    parameter Boolean running = true;
    parameter Kind kind = Kind.Slow;
    parameter Real gain = 1;
    Part part[n];
    Real out = (if running then gain else 0)*(if kind == Kind.Fast then 10 else 1);
    annotation(experiment(StopTime = 1, Interval = 0.1, Tolerance = 1e-8));
  end Machine;
end Shop;
