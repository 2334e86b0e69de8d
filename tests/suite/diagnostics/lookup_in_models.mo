// status: 1
// error[MO0263] 35:12
// error[MO0263] 36:12
// error[MO0261] 37:10
// error[MO0261] 42:19
// error[MO0201] 44:5
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
    import Units = Lookup.Others;
    import Lookup.Pump.Seal;
    Pump.Wheel wheel;
    Pump.Seal seal;
    Seal other;
    Catalogue.Speed v = 1;
    Real rho = Catalogue.density;
    Real n = Pump.poles;
    Real p = Units.bar;
    wheel second;
  end Plant;
end Lookup;
