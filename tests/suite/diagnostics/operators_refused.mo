// status: 1
// error[MO0226] 42:21
// error[MO0219] 49:14
// error[MO0202] 50:18
// error[MO0212] 51:18
// What operator records may not have, and how their operators are not called.
package P
  operator record Pair
    Real a;
    encapsulated operator 'constructor'
      function ofNumber
        import P.Pair;
        input Real a;
        output Pair p(a = a);
      algorithm
      end ofNumber;
      function ofFactor
        import P.Pair;
        input Real factor;
        output Pair p(a = 2*factor);
      algorithm
      end ofFactor;
    end 'constructor';
    encapsulated operator '+'
      function add
        import P.Pair;
        input Pair x;
        input Pair y;
        output Pair z;
      algorithm
        z.a := x.a + y.a;
      end add;
    end '+';
  end Pair;
  operator record Twice
    Real a;
    encapsulated operator 'constructor'
      function make
        import P.Twice;
        input Real a;
        output Twice t(a = a);
        output Real rest = 0;
      algorithm
      end make;
    end 'constructor';
  end Twice;
  model Top
    Pair p(a = 1);
    Pair q = Pair(3.0);
    Pair sum = p.'+'.add(p, q);
    Pair wrong = p and q;
    Twice t = Twice(1);
  end Top;
end P;
