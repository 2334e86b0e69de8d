within Friction;
model Stribeck "Stribeck friction with constant parameters"
  //   |f| = F_Coulomb + F_prop |v| + F_Stribeck exp(-f_exp |v|) while sliding
  //   |f| <= F_Coulomb + F_Stribeck at rest
  // Source: "Component-based Modular System Modelling of a Spool Valve", equation 1.
  extends StribeckShape;
  parameter Units.Force F_Coulomb  "Coulomb friction";
  parameter Units.Force F_Stribeck "Excess of static over Coulomb friction";
equation
  F_C = F_Coulomb;
  F_S = F_Stribeck;
end Stribeck;
