within Pneumatics;
package Air "The air of the test stand"
  constant Units.SpecificGasConstant R         = 287.1  "Gas constant";
  constant Units.Temperature         T         = 293.15 "Temperature, constant";
  constant Units.Density             rho_0     = 1.185  "Density at the reference state of ISO 8778";
  constant Units.AbsolutePressure    p_ambient = 1.0e5  "Ambient pressure";
end Air;
