// status: 1
// error[MO0250] 23:15
// error[MO0249] 26:9
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
    flow Pair f;
  end Double;
  block Source
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
