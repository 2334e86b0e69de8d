// status: 1
// error[MO0226] 9:21
// error[MO0227] 20:13
// error[MO0227] 28:13
package P
  operator record Pair
    Real a;
    operator '+'
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
    extends Pair;
  end Longer;
  package Inside
    operator record Number
      Real a;
    end Number;
  end Inside;
  package Around
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
