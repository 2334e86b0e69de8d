//@ case inheritance_cycle
model A
  extends B;
end A;
//@ error[MO0205] 7
model B
  extends A;
end B;

//@ case duplicate_declaration
model Box
  Real length = 1;
  Real width = 2;
  //@ error[MO0204] 11-16
  Integer length = 3;
end Box;

//@ case inherited_twice
model Base
  Real x = 1;
end Base;
model Box
  extends Base;
  //@ error[MO0204] 8
  Real x = 2;
end Box;

//@ case extends_unknown_modifier
model Car
  model Base
    replaceable model Engine
      Real x = 1;
    end Engine;
    Engine part;
  end Base;
  //@ error[MO0203] 16-18
  //@ error[MO0203] 41-45
  extends Base(foo = 3, redeclare model Engin = Other);
  model Other
    Real x = 2;
  end Other;
end Car;

//@ case partial_model
partial model Law
  Real v;
  Real f;
end Law;
model Use
  //@ error[MO0208] 3-5
  Law law;
end Use;

//@ case prefixed_base
package P
  record Data
    Real x;
  end Data;
  record Given = input Data;
  record Both
    //@ error[MO0227] 13-17
    extends Given;
    Real y;
  end Both;
  model Top
    Both both(x = 1, y = 2);
  end Top;
end P;
