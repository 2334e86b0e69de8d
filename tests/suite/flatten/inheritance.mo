//@ case base_classes
//@ run tolerance=1e-9
//@ snapshot flat
// `extends` with a modification, a redeclared model, a final value, an enumeration and a condition.
package P
  type Kind = enumeration(Dry, Wet);
  model Linear
    input Real v;
    parameter Real d = 1;
    Real f = d*v;
  end Linear;
  model Base
    replaceable model Drag = Linear;
    parameter Kind kind = Kind.Dry;
    parameter Real m = 1;
    Drag drag(v = v);
    Real v(start = 1, fixed = true);
    Real wetness = time if kind == Kind.Wet;
  equation
    m*der(v) = -drag.f;
  end Base;
  model Body
    extends Base(final m = 2, redeclare model Drag = Linear(d = 4));
  end Body;
end P;
//@ expect flat lacks "wetness"
//@ expect v = exp(-2) abs 1e-8
