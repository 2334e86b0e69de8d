//@ case restrictions
model KindsOfClasses
  type State = enumeration(
    //@ error[MO1279] 10-14
    off, start);

  connector Bad
  protected
    //@ error[MO0226] 10-15
    Real hidden;
  end Bad;

  record Data
    //@ error[MO0226] 16
    input Real u;
    //@ error[MO0226] 17
    output Real y;
  end Data;

  record Rule
    //@ error[MO0226] 16
    outer Real x;
    Real y;
  end Rule;

  //@ error[MO1281] 12-16
  function twice
    input Real u;
    output Real y;
    //@ error[MO1284] 10-16
    Real between;
  equation
    y = 2*u;
  end twice;

  model Part
    Real x = 1;
  end Part;
  block Wrong
    //@ error[MO0227] 13-16
    extends Part;
  end Wrong;
  connector Flows
    Real e;
    //@ error[MO0228] 18
    flow Integer f;
  end Flows;

  Bad bad;
  Data data(u = 1, y = 2);
  inner Real x = 1;
  Rule rule(y = 1);
  Wrong wrong;
  Flows flows;
  //@ error[MO0228] 17-20
  constant Part part;
  //@ error[MO1280] 8-13
  Real String = 3;
  Real y;
  Real t = twice(1);
  State state = State.off;
equation
  y = 1;
  //@ error[MO1204] 7
  for i loop
    y = 1;
  end for;
end KindsOfClasses;

//@ case operators_misplaced
package P
  operator record Pair
    Real a;
    operator '+'
      //@ error[MO1282] 21-24
      constant Real bias = 1;
      function add
        input Pair x;
        input Pair y;
        output Pair z;
      algorithm
        z := Pair(x.a + y.a);
      end add;
    end '+';
  end Pair;
  operator record Longer
    //@ error[MO1288] 13-16
    extends Pair;
  end Longer;
  package Inside
    operator record Number
      Real a;
    end Number;
  end Inside;
  package Around
    //@ error[MO1288] 13-18
    extends Inside;
    constant Real k = 2;
  end Around;
  model Top
    Pair p(a = 1);
    Pair q = p + p;
    Longer l(a = 2);
    Real k = Around.k;
  end Top;
end P;

//@ case stream_outside_of_a_connector
model Outside
  //@ error[MO0226] 15
  stream Real x = 1;
end Outside;

//@ case icons_of_classes_of_another_kind
// A class without elements is no more than an icon.
package Icons
  partial model Example
  end Example;
  model Full
    extends Example;
    Real x = 1;
  end Full;
  package Examples
    extends Example;
    constant Real c = 3;
  end Examples;
  function doubled
    extends Example;
    input Real u;
    output Real y = 2*u;
  end doubled;
  model Top
    Full full;
    Real y = doubled(Examples.c);
  end Top;
end Icons;
//@ expect y = 6
//@ expect full.x = 1
