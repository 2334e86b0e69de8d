//@ case unknown_class
model Shaft
  //@ error[MO0201] 17-22
  Translational.Sprnig spring(c = 100);
end Shaft;

//@ case unknown_name
model Motion
  parameter Real friction = 0.1;
  Real speed(start = 1, fixed = true);
equation
  //@ error[MO0202] 17-23
  der(speed) = -fricton*speed;
end Motion;

//@ case unknown_member
model Shaft
  Translational.Spring spring(c = 100);
  Translational.Fixed wall;
  Translational.Mass mass(m = 1);
equation
  connect(wall.flange, spring.flange_a);
  //@ error[MO0283] 18-24
  connect(spring.flangeb, mass.flange);
end Shaft;

//@ case lookup_in_models
package Lookup
  model Pump
    Real speed = 1;
    constant Real poles = 2;
    model Wheel
      Real radius = 0.1;
    end Wheel;
    encapsulated model Seal
      Real leak = 0;
    end Seal;
  end Pump;

  // Nothing but classes and constants: as good as a package.
  model Catalogue
    constant Real density = 1000;
    type Speed = Real(unit = "m/s");
  end Catalogue;

  encapsulated package Units
    constant Real bar = 1e5;
  end Units;

  encapsulated package Others
    constant Real bar = 1;
  end Others;

  model Plant
    import Lookup.Units;
    //@ error[MO1216] 12-16
    import Units = Lookup.Others;
    //@ error[MO1217] 12-27
    import Lookup.Pump.Seal;
    //@ error[MO0261] 10-14
    Pump.Wheel wheel;
    Pump.Seal seal;
    Seal other;
    Catalogue.Speed v = 1;
    Real rho = Catalogue.density;
    //@ error[MO0261] 19-23
    Real n = Pump.poles;
    Real p = Units.bar;
    //@ error[MO0282] 5-9
    wheel second;
  end Plant;
end Lookup;

//@ case lookup_in_partial
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
    //@ error[MO0202] 14-18
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
    //@ error[MO0208] 5-9
    Alias alias;
    //@ error[MO1201] 19
    Real x = Open.k;
    //@ error[MO0286] 14-23
    Real y = parts[1].f(2);
    //@ error[MO0217] 14-17
    Real z = some.f(2);
  end Top;
end P;

//@ case imports_in_conflict
package P
  package A
    constant Real k = 1;
  protected
    constant Real hidden = 3;
  end A;
  package B
    constant Real k = 2;
  end B;
  model Top
    import P.A.*;
    //@ error[MO0263] 12-14
    import P.B.*;
    //@ error[MO0260] 12-21
    import P.A.hidden;
    Real x = k;
    Real y = hidden;
  end Top;
end P;

//@ case names_of_predefined_types
model NamesOfPredefinedTypes
  //@ error[MO1280] 9-22
  model ExternalObject
    Real x = 1;
  end ExternalObject;
  //@ error[MO1280] 8-14
  type Integer = Real;
  //@ error[MO1280] 8-18
  Real StateSelect = 1;
  //@ error[MO1280] 8-14
  Real Boolean = 2;
  ExternalObject x;
end NamesOfPredefinedTypes;

//@ case functions_hide_predefined_ones
//@ run model=Hiding.Test
package Hiding
  function sum
    input Real u[:];
    output Real y = 42;
  algorithm
  end sum;
  function abs
    input Real u;
    output Real y;
  algorithm
    y := 10 + .abs(u);
  end abs;
  package Deeper
    function matrix
      input Real u;
      output Real y;
    algorithm
      y := abs(u) + 1;
    end matrix;
  end Deeper;
  model Test
    function max
      input Real a;
      input Real b;
      output Real y;
    algorithm
      y := a;
    end max;
    function scalar = Deeper.matrix;
    import Hiding.Deeper.matrix;
    Real s = sum({1, 2});
    Real m = matrix(-1);
    Real a = max(1, 2);
    Real f = scalar(-2);
    Real p = .sum({1, 2}) + min(1, 2) + product({2, 3});
  end Test;
end Hiding;
//@ expect s, m, a, f, p = 42, 12, 1, 13, 10

//@ case qualified_imports_come_first
package P
  package A
    constant Real k = 2;
    constant Real only = 7;
  end A;
  package B
    constant Real k = 4;
  end B;
  model Named
    import P.A.*;
    import P.B.k;
    Real y = k + only;
  end Named;
  model Own
    import P.A.*;
    Real k = 10;
    Real y = k;
  end Own;
  model Top
    Named named;
    Own own;
  end Top;
end P;
//@ expect named.y, own.y = 11, 10

//@ case an_import_of_a_package_that_is_missing
// Nothing uses it, but the reader believes that it is there.
model Tank
  //@ error[MO0201] 10-22
  import Vessels.Walls;
  Real level(start = 1, fixed = true);
equation
  der(level) = -level;
end Tank;

//@ case own_classes_by_the_name_of_the_class
// A model may look into itself by its own name, although it is not a package.
package Cells
  model Cell
    model Substance
      Real n(start = 1, fixed = true);
    equation
      der(n) = -n;
    end Substance;
    Cell.Substance calcium(n(start = 2));
    Real x = 1;
  end Cell;
end Cells;
//@ run stop=1
//@ expect calcium.n = 2*exp(-1) rel 1e-5
