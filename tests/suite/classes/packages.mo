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
