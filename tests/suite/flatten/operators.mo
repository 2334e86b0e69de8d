//@ case operator_records
//@ run stop=2
//@ snapshot flat
// An operator record: overloaded operators, its constructor combined with a number, and sums of arrays.
package Numbers
  operator record Dual
    Real value;
    Real slope;
    encapsulated operator 'constructor'
      function make
        import Numbers.Dual;
        input Real value;
        input Real slope = 0;
        output Dual d(value = value, slope = slope);
      algorithm
      end make;
    end 'constructor';
    encapsulated operator '+'
      function add
        import Numbers.Dual;
        input Dual a;
        input Dual b;
        output Dual c;
      algorithm
        c := Dual(a.value + b.value, a.slope + b.slope);
      end add;
    end '+';
    encapsulated operator '-'
      function negate
        import Numbers.Dual;
        input Dual a;
        output Dual c;
      algorithm
        c := Dual(-a.value, -a.slope);
      end negate;
      function subtract
        import Numbers.Dual;
        input Dual a;
        input Dual b;
        output Dual c;
      algorithm
        c := Dual(a.value - b.value, a.slope - b.slope);
      end subtract;
    end '-';
    encapsulated operator function '*'
      import Numbers.Dual;
      input Dual a;
      input Dual b;
      output Dual c;
    algorithm
      c := Dual(a.value*b.value, a.value*b.slope + a.slope*b.value);
    end '*';
  end Dual;
  model Derivative
    Dual x = Dual(3, 1);
    Dual y;
    Dual z;
  equation
    // x^2 + 2 x - 5 and its derivative at 3.
    y = x*x + 2*x - 5;
    z = sum({-x, x*x, Dual(time)});
  end Derivative;
end Numbers;
//@ expect flat lacks "Dual"
// x^2 + 2 x - 5 and 2 x + 2 at 3; -x + x^2 + t and 2 x - 1.
//@ expect y.value, y.slope = 10, 8
//@ expect z.value, z.slope = 8, 5
