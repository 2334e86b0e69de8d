within Friction;
model StribeckDwell "Stribeck friction that grows with the time without operation"
  //   F_S = F_Stribeck_max (1 - exp(-(t_no/tau)^n))
  // in place of the constant F_Stribeck of the law Stribeck.
  // Source: "Component-based Modular System Modelling of a Spool Valve", section 4.3.
  extends StribeckShape;
  parameter Units.Force    F_Coulomb      "Coulomb friction";
  parameter Units.Force    F_Stribeck_max "Stribeck force after infinite rest";
  parameter Units.Time     tau            "Time constant of the build-up";
  parameter Units.Exponent n              "Exponent of the build-up";
equation
  F_C = F_Coulomb;
  F_S = F_Stribeck_max*dwellSaturation(t_no, tau, n);
end StribeckDwell;
