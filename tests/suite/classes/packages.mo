//@ case constants_by_inherited_functions
//@ run stop=1
// The value of an inherited constant calls a function of the base, which reads a constant that only
// the extending package sets, and one that it redeclares.
package Media
  partial package Linear
    constant Real reference;
    constant Real slope;
    constant Real standard = enthalpy(20);
    function enthalpy
      input Real T;
      output Real h = reference + slope*T*factor();
    end enthalpy;
    replaceable function factor
      output Real f = 1;
    end factor;
  end Linear;
  package Water
    extends Linear(reference = 5, slope = 4);
    redeclare function factor
      output Real f = 2;
    end factor;
  end Water;
  model Vessel
    replaceable package Medium = Water constrainedby Linear;
    Real h = Medium.standard;
    Real now = Medium.enthalpy(time);
  end Vessel;
end Media;
//@ expect h = 5 + 4*20*2
//@ expect now at 1 = 5 + 4*2 abs 1e-12

//@ case types_modified_by_extends_clauses
//@ run stop=1
// The modification of a type that a package inherits holds for all variables of that type in the package, and
// outermost modifications win.
package Media
  partial package General
    type Temperature = Real(unit = "K", start = 300);
    replaceable record State
      Temperature T;
    end State;
    replaceable partial model Properties
      Temperature T(fixed = true);
    equation
      der(T) = 0;
    end Properties;
  end General;
  package Water
    extends General(Temperature(start = usual));
    constant Real usual = 350;
    redeclare replaceable record extends State
      Temperature surface;
    end State;
    redeclare replaceable model extends Properties
      Temperature inside(fixed = true);
    equation
      der(inside) = 0;
    end Properties;
  end Water;
  package Hot = Water(Temperature(start = 390));
  package Derived
    extends Water;
    type Difference = Temperature(min = 0);
  end Derived;
  model Vessel
    replaceable package Medium = Water;
    Medium.Temperature T(fixed = true);
    Medium.State state(T(fixed = true), surface(fixed = true));
    Medium.Properties properties;
    Medium.Temperature own(start = 1, fixed = true);
  equation
    der(T) = 0;
    der(own) = 0;
    der(state.T) = 0;
    der(state.surface) = 0;
  end Vessel;
  model Vessels
    Vessel water;
    Vessel hot(redeclare package Medium = Hot);
    Vessel derived(redeclare package Medium = Derived);
    General.Temperature T(fixed = true);
    Derived.Difference difference(fixed = true);
  equation
    der(T) = 0;
    der(difference) = 0;
  end Vessels;
end Media;
//@ expect water.T, water.state.T, water.state.surface = 350
//@ expect water.properties.T, water.properties.inside = 350
//@ expect derived.T, derived.state.T, derived.state.surface = 350
//@ expect derived.properties.T, derived.properties.inside = 350
//@ expect hot.T, hot.state.T, hot.state.surface = 390
//@ expect hot.properties.T, hot.properties.inside = 390
//@ expect water.own, hot.own = 1
//@ expect T = 300
//@ expect difference = 350
