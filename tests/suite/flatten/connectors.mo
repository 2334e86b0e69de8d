//@ case unbalanced
package Unbalanced
  //@ error[MO0245] 13-16
  connector Bare = Real;
  //@ error[MO0245] 13-20
  connector Lopsided
    Real v;
    Real w;
    flow Real i;
  end Lopsided;
  record State
    Real p;
    Real T;
  end State;
  connector Port
    State state;
    flow Real m_flow;
    flow Real H_flow;
    parameter Integer n = 2;
    input Real signal;
  end Port;
  model Plant
    Bare bare = 1;
    Lopsided lopsided(v = 1, w = 2);
    Port port(state(p = 1, T = 2), signal = 1);
  end Plant;
end Unbalanced;

//@ case stream_connectors
package Streams
  //@ error[MO1215] 13-16
  connector Lone
    stream Real h;
  end Lone;
  //@ error[MO1215] 13-18
  connector Double
    Real p[2];
    flow Real m[2];
    stream Real h;
  end Double;
  model Plant
    Lone lone(h = 1);
    Double double(p = {1, 2}, h = 3);
  end Plant;
end Streams;

//@ case without_causality
package P
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  operator record Pair
    Real a;
    operator '+'
      function add
        input Pair x;
        input Pair y;
        output Pair z;
      algorithm
        z := Pair(x.a + y.a);
      end add;
    end '+';
  end Pair;
  connector Double
    Pair e;
    //@ error[MO0250] 15
    flow Pair f;
  end Double;
  block Source
    //@ error[MO0249] 9
    Pin p;
  equation
    p.v = 1;
  end Source;
  model Part
    Double d;
  equation
    d.e.a = d.f.a;
  end Part;
  model Top
    Source source;
    Part part;
  end Top;
end P;
