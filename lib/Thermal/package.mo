within;
package Thermal "Heat conduction and storage"
  // A positive heat flow enters the component that owns the port.

  constant Real stefanBoltzmann(unit = "W/(m2.K4)") = 5.670374419e-8 "Radiation of a black body per T^4";
end Thermal;
