// status: 1
// error[MO0202] 20:14
// error[MO0208] 34:5
// error[MO0208] 35:19
// error[MO0202] 36:14
// error[MO0217] 37:14
package P
  partial package Open
    constant Real k = 2;
  end Open;
  model Part
    function f
      input Real x;
      output Real y = 2*x;
    algorithm
    end f;
    Real a = 1;
  end Part;
  partial model Base
    Real b = later;
  end Base;
  model Derived
    Real later = 3;
    extends Base;
  end Derived;
  partial model Closed
    Real c = 1;
  end Closed;
  model Alias = Closed;
  model Top
    Part parts[2];
    Part some if true;
    Derived derived;
    Alias alias;
    Real x = Open.k;
    Real y = parts[1].f(2);
    Real z = some.f(2);
  end Top;
end P;
