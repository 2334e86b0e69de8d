//@ case what_is_allowed
//@ run stop=1
//@ snapshot flat
// Valid counterparts of models that are refused: redeclarations, class extensions, lookup, records.
package Rules
  // A constant that a package gives to what it inherits.
  package General
    constant Integer n = 1;
    replaceable function count
      output Integer y = n;
    algorithm
    end count;
    replaceable model Body
      Real mass = 1;
    end Body;
  end General;

  package Special
    extends General(n = 3);
    redeclare model extends Body(mass = 2)
      Real weight = mass*n;
    end Body;
  end Special;

  // What constrains a replaceable component also modifies it, and what replaces it.
  model Plain
    parameter Real a = 1;
    parameter Real b = 2;
  end Plain;
  model Fancy
    parameter Real a = 3;
    parameter Real b = 4;
    parameter Real c = 5;
  end Fancy;
  model Holder
    replaceable Plain part constrainedby Plain(a = 6, b = 7);
    replaceable parameter Real list[2];
  end Holder;
  model Filled
    extends Holder(part(a = 8), redeclare Fancy part(b = 9), redeclare parameter Real list = {1, 2});
  end Filled;

  // Functions are found in components, and an outer class is the inner one around.
  model Tool
    function twice
      input Real u;
      output Real y = 2*u;
    algorithm
    end twice;
  end Tool;
  partial function Law
    input Real u;
    output Real y;
  end Law;
  model User
    outer function law = Law;
    Real y = law(3);
  end User;
  model Around
    inner function law = Square;
    User user;
  end Around;
  function Square
    extends Law;
  algorithm
    y := u*u;
  end Square;

  // The value of a record counts more than the defaults of its fields.
  record Data
    Real x;
    Real y = z + 1;
    constant Real z = 10;
  end Data;

  function both
    input Real u;
    output Real sum;
    output Real difference;
  algorithm
    sum := u + 1;
    difference := u - 1;
  end both;

  type In = input Real;
  function typed
    In u;
    output Real y = u + 1;
  algorithm
  end typed;

  // Classes that are modified, and not replaced.
  model Outer
    model Inner
      parameter Real p = 1;
    end Inner;
    Inner inside;
  end Outer;
  model Modified
    extends Outer(Inner(p = 4));
  end Modified;

  // A `flow` outside of connectors is a variable like any.
  model Test
    Special.Body body;
    Integer n = Special.count();
    Holder holder(list = {3, 4});
    Filled filled;
    Tool tool;
    Real t = tool.twice(7);
    Around around;
    Data data = Data(1, 2);
    Data short = Data(5);
    Real first = both(4);
    Real v = typed(1);
    Modified modified;
    flow Real q = 3;
    String text = String(3.14159265, significantDigits = 4);
    Boolean right = text == "3.142";
    Real x(start = 0.25, fixed = true);
    Real limited;
    Real seen[7] = {holder.part.a, holder.part.b, filled.part.a, filled.part.b, filled.part.c,
      filled.list[2], modified.inside.p};
  equation
    der(x) = 1;
  algorithm
    limited := min(x, 1);
    assert(limited <= 1, "never said");
  end Test;
end Rules;
// A flow outside of connectors has no second equation.
//@ expect flat lacks "q = 0"
//@ expect body.mass, body.weight = 2, 6
//@ expect n = 3
//@ expect seen[1:7] = 6, 7, 8, 9, 5, 2, 4
//@ expect t, around.user.y = 14, 9
//@ expect data.x, data.y = 1, 2
//@ expect short.x, short.y = 5, 11
//@ expect first, v = 5, 2
//@ expect q, right = 3, 1
//@ expect limited = 1 abs 1e-9
