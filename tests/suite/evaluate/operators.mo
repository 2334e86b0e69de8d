//@ case logical_operators_and_strings_of_records
//@ run stop=1
// Kleene's logic of three values.
package Logic
  operator record Three "True, false or unknown: 1, -1 or 0"
    Integer v;
    encapsulated operator 'constructor'
      function of
        import Logic.Three;
        input Integer v;
        output Three t(v = v);
      algorithm
      end of;
    end 'constructor';
    encapsulated operator function 'and'
      import Logic.Three;
      input Three a;
      input Three b;
      output Three c = Three(min(a.v, b.v));
    algorithm
    end 'and';
    encapsulated operator function 'or'
      import Logic.Three;
      input Three a;
      input Three b;
      output Three c = Three(max(a.v, b.v));
    algorithm
    end 'or';
    encapsulated operator function 'not'
      import Logic.Three;
      input Three a;
      output Three c = Three(-a.v);
    algorithm
    end 'not';
    encapsulated operator 'String'
      function short
        import Logic.Three;
        input Three a;
        output String s = if a.v > 0 then "yes" elseif a.v < 0 then "no" else "unknown";
      algorithm
      end short;
      function spelt
        import Logic.Three;
        input Three a;
        input String before;
        output String s = before + (if a.v > 0 then "yes" else "no");
      algorithm
      end spelt;
    end 'String';
  end Three;
  model Tables
    Integer n(start = -1, fixed = true);
    Three a = Three(n);
    Three b = Three(0);
    Three both = a and b;
    Three one = a or not b;
    Three mixed = not a or a and b;
    Boolean known = String(both) <> "unknown";
    Boolean said = String(a, "it is ") == "it is yes";
  equation
    when time > 0.5 then
      n = 1;
    end when;
  end Tables;
end Logic;
//@ expect both.v, one.v, mixed.v, known, said at start = -1, 0, 1, 1, 0
//@ expect both.v, one.v, mixed.v, known, said = 0, 1, 0, 0, 1

//@ case operands_of_other_types
model Operands
  Real x[2] = {1, 2};
  //@ error[MO0219] 15-24
  Boolean a = initial(3);
  //@ error[MO0212] 14-17
  Real b = x[true];
  //@ error[MO0212] 15-36
  Integer c = product({true, false});
  //@ error[MO0212] 21-24
  Real d = homotopy(true, false);
end Operands;

//@ case undefined_in_max
//@ run stop=1
//@ status 3
// A root that does not exist is not replaced by the other operand.
model Root
  //@ error[MO0902] 8
  Real y = max(sqrt(time - 0.5), 1);
end Root;

//@ case constructors_of_different_length
// One number cannot be given to `full`, whose second input has no default.
package Q
  operator record Quat
    Real w;
    Real x;
    encapsulated operator 'constructor'
      import Q.Quat;
      function fromReal
        input Real r;
        output Quat q(w = r, x = 0);
      algorithm
      end fromReal;
      function full
        input Real w;
        input Real x;
        output Quat q(w = w, x = x);
      algorithm
      end full;
    end 'constructor';
    encapsulated operator function '+'
      import Q.Quat;
      input Quat a;
      input Quat b;
      output Quat c = Quat(a.w + b.w, a.x + b.x);
    algorithm
    end '+';
  end Quat;
  model Use
    Quat a = Quat(1, 2);
    Quat b = Quat(5.0);
    Quat c = a + time;
  end Use;
end Q;
//@ expect a.x, b.w, b.x, c.w, c.x = 2, 5, 0, 2, 2
