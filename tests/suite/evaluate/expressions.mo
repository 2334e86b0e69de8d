//@ case conditional_component_read
model Conditional
  parameter Boolean present = true;
  record Reading
    //@ error[MO1286] 15-18
    Real at = time;
    Real value;
  end Reading;
  function clock
    //@ error[MO1286] 21-24
    output Real t = time;
  algorithm
  end clock;
  model Part
    parameter Real p = 1;
  end Part;
  Part part(p = 2) if present;
  //@ error[MO0217] 12-15
  Real x = part.p;
  Real level if present;
  Reading reading(value = 1);
  Real now = clock();
equation
  //@ error[MO0217] 3-7
  level = 1;
end Conditional;

//@ case delay_arguments
model Bounds
  Real x = time;
  //@ error[MO1250] 27
  Real late = delay(x, 2, 1);
  //@ error[MO1249] 29
  Real free = delay(x, 0.5, x);
  //@ error[MO1269] 27
  Integer n = cardinality(x);
end Bounds;

//@ case spatial_distribution_arguments
// The arguments that `spatialDistribution` accepts.
model Pipe
  Real x(start = 0, fixed = true), y[10];
  parameter Real p = 0.5;
equation
  der(x) = 1;
  //@ error[MO1252] 53-68
  (y[1], y[2]) = spatialDistribution(x, 0, x, true, {0, 0.7, 0.5, 1}, {0, 0, 0, 0});
  //@ error[MO1251] 47
  (y[3], y[4]) = spatialDistribution(time, 0, p, true);
  //@ error[MO0219] 18-48
  (y[5], y[6]) = spatialDistribution(time, 0, x);
  //@ error[MO0212] 18-51
  (y[7], y[8]) = spatialDistribution(time, 0, x, 1);
  //@ error[MO1252] 57-62
  (y[9], y[10]) = spatialDistribution(time, 0, x, true, {0, 1}, {1, 2, 3});
end Pipe;

//@ case operators_refused
// Elements that operator records may not have, and invalid calls of their operators.
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
        //@ error[MO1283] 21-24
        output Real rest = 0;
      algorithm
      end make;
    end 'constructor';
  end Twice;
  model Top
    Pair p(a = 1);
    //@ error[MO1257] 14-22
    Pair q = Pair(3.0);
    //@ error[MO0287] 18-20
    Pair sum = p.'+'.add(p, q);
    //@ error[MO1224] 18-24
    Pair wrong = p and q;
    Twice t = Twice(1);
  end Top;
end P;
