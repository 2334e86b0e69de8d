within;
package Units "Types of physical quantities in SI units"
  // Every quantity of the library has one of these types; all values are in SI units.

  type Time                = Real(quantity = "Time", unit = "s");
  type Length              = Real(quantity = "Length", unit = "m");
  type Position            = Real(quantity = "Length", unit = "m");
  type Velocity            = Real(quantity = "Velocity", unit = "m/s");
  type Acceleration        = Real(quantity = "Acceleration", unit = "m/s2");
  type Mass                = Real(quantity = "Mass", unit = "kg", min = 0);
  type Force               = Real(quantity = "Force", unit = "N");
  type SpringStiffness     = Real(quantity = "TranslationalSpringConstant", unit = "N/m", min = 0);
  type QuadraticStiffness  = Real(quantity = "QuadraticStiffness", unit = "N/m2", nominal = 1e6)
    "Force per square of a deflection";
  type CubicStiffness      = Real(quantity = "CubicStiffness", unit = "N/m3", nominal = 1e9)
    "Force per cube of a deflection";
  type DampingCoefficient  = Real(quantity = "TranslationalDampingConstant", unit = "N.s/m", min = 0);
  type QuadraticDragCoefficient = Real(quantity = "QuadraticDragCoefficient", unit = "N.s2/m2", min = 0)
    "Drag per square of the speed";
  type ContactDamping      = Real(quantity = "ContactDamping", unit = "N.s/m2", min = 0)
    "Damping coefficient per depth of penetration";
  type Area                = Real(quantity = "Area", unit = "m2", min = 0);
  type EffectiveArea       = Real(quantity = "Area", unit = "m2", nominal = 1e-6)
    "Force per pressure difference, with a sign";
  type Volume              = Real(quantity = "Volume", unit = "m3", min = 0);
  type AbsolutePressure    = Real(quantity = "Pressure", unit = "Pa", min = 0, nominal = 1e5, displayUnit = "bar")
    "Pressure above vacuum";
  type PressureDifference  = Real(quantity = "Pressure", unit = "Pa", nominal = 1e5, displayUnit = "bar")
    "Difference of two pressures, also a gauge pressure";
  type MassFlowRate        = Real(quantity = "MassFlowRate", unit = "kg/s", nominal = 1e-3);
  type VolumeFlowRate      = Real(quantity = "VolumeFlowRate", unit = "m3/s");
  type Density             = Real(quantity = "Density", unit = "kg/m3", min = 0);
  type Temperature         = Real(quantity = "ThermodynamicTemperature", unit = "K", min = 0, nominal = 300);
  type SpecificGasConstant = Real(quantity = "SpecificHeatCapacity", unit = "J/(kg.K)", min = 0)
    "Gas constant R of one gas";
  type SonicConductance    = Real(quantity = "SonicConductance", unit = "m3/(s.Pa)", min = 0, nominal = 1e-8)
    "Sonic conductance C of ISO 6358";
  type LaminarConductance  = Real(quantity = "LaminarConductance", unit = "kg/(s.Pa2)", min = 0, nominal = 1e-15)
    "Mass flow per difference of the squares of two pressures";
  type FlowResistance      = Real(quantity = "FlowResistance", unit = "Pa.s/kg", min = 0, nominal = 1e7)
    "Pressure difference per mass flow";
  type PerPressure         = Real(quantity = "PerPressure", unit = "1/Pa")
    "Relative increase per pressure";
  type PerVelocity         = Real(quantity = "PerVelocity", unit = "s/m")
    "Relative decay per speed";
  type PerTime             = Real(quantity = "PerTime", unit = "1/s")
    "Rate of change of a fraction";
  type Fraction            = Real(quantity = "Fraction", unit = "1")
    "Part of a whole, 0 to 1";
  type Exponent            = Real(quantity = "Exponent", unit = "1");
  type Angle               = Real(quantity = "Angle", unit = "rad");
  type AngularVelocity     = Real(quantity = "AngularVelocity", unit = "rad/s");
  type AngularAcceleration = Real(quantity = "AngularAcceleration", unit = "rad/s2");
  type MomentOfInertia     = Real(quantity = "MomentOfInertia", unit = "kg.m2", min = 0);
  type Torque              = Real(quantity = "Torque", unit = "N.m");
  type RotationalStiffness = Real(quantity = "RotationalSpringConstant", unit = "N.m/rad", min = 0);
  type RotationalDamping   = Real(quantity = "RotationalDampingConstant", unit = "N.m.s/rad", min = 0);
  type QuadraticRotationalDrag = Real(quantity = "QuadraticRotationalDrag", unit = "N.m.s2/rad2", min = 0)
    "Torque per square of the speed";
  type Voltage             = Real(quantity = "ElectricPotential", unit = "V");
  type Current             = Real(quantity = "ElectricCurrent", unit = "A");
  type Resistance          = Real(quantity = "Resistance", unit = "Ohm", min = 0);
  type ElectricConductance = Real(quantity = "Conductance", unit = "S", min = 0);
  type Capacitance         = Real(quantity = "Capacitance", unit = "F", min = 0);
  type Inductance          = Real(quantity = "Inductance", unit = "H", min = 0);
  type FluxLinkage         = Real(quantity = "MagneticFlux", unit = "Wb")
    "Integral of a voltage";
  type CubicReluctance     = Real(quantity = "CubicReluctance", unit = "A/Wb3")
    "Current per cube of the flux linkage";
  type MotorConstant       = Real(quantity = "ElectricalTorqueConstant", unit = "N.m/A")
    "Torque per current, equal to the voltage per speed";
  type TemperatureDifference = Real(quantity = "TemperatureDifference", unit = "K");
  type HeatCapacity        = Real(quantity = "HeatCapacity", unit = "J/K", min = 0);
  type ThermalConductance  = Real(quantity = "ThermalConductance", unit = "W/K", min = 0);
  type HeatFlowRate        = Real(quantity = "HeatFlowRate", unit = "W");
end Units;
