// status: 1
// error[MO0224] 22:20
// error[MO0224] 23:20
// error[MO0224] 24:21
// error[MO0224] 28:20
// error[MO0225] 49:23
// error[MO0225] 61:35
// error[MO0225] 63:34
package Closed
  model Base
    final replaceable Real fixed_part = 2;
    replaceable constant Real number = 1;
    replaceable Real level = 3;
  protected
    replaceable model Inside
      Real x = 1;
    end Inside;
  end Base;

  model Derived
    extends Base;
    redeclare Real fixed_part = 3;
    redeclare Real number = 2;
    redeclare model Inside
      Real x = 2;
    end Inside;
  protected
    redeclare Real level = 4;
  end Derived;

  model Small
    Real x = 1;
  end Small;

  model Large
    Real x = 2;
    Real y = 3;
  end Large;

  model Open
    replaceable Large part constrainedby Small;
  end Open;

  model Narrow
    extends Open(replaceable Large part constrainedby Large);
  end Narrow;

  model Wrong
    replaceable Small part constrainedby Large;
  end Wrong;

  type Pair = Real[2];
  model Vector
    replaceable type Item = Pair;
    Item item = {1, 2};
  end Vector;

  model Test
    Derived derived;
    Open open(redeclare Small part);
    Narrow narrow(redeclare Small part);
    Wrong wrong;
    Vector vector(redeclare type Item = Real);
  end Test;
end Closed;
