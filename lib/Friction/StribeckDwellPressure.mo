within Friction;
model StribeckDwellPressure "Stribeck friction that grows with the time without operation and with pressure"
  //   F_C = F_Coulomb (1 + k_C dp)
  //   F_S = F_Stribeck_max (1 - exp(-(t_no/tau)^n)) (1 + k_S dp)
  // in place of the constants F_Coulomb and F_Stribeck of the law Stribeck.
  // Source: "Component-based Modular System Modelling of a Spool Valve", section 4.5.
  extends StribeckShape;
  parameter Units.Force       F_Coulomb      "Coulomb friction without pressure";
  parameter Units.PerPressure k_C            "Relative increase of F_Coulomb per pressure difference";
  parameter Units.Force       F_Stribeck_max "Stribeck force after infinite rest without pressure";
  parameter Units.PerPressure k_S            "Relative increase of the Stribeck force per pressure difference";
  parameter Units.Time        tau            "Time constant of the build-up";
  parameter Units.Exponent    n              "Exponent of the build-up";
equation
  F_C = F_Coulomb*(1 + k_C*dp);
  F_S = F_Stribeck_max*dwellSaturation(t_no, tau, n)*(1 + k_S*dp);
end StribeckDwellPressure;
