within Friction;
model LuGreDwellPressure "Friction of elastic bristles that grows with the time without operation and with pressure"
  // The magnitudes of StribeckDwellPressure in the equations of BristleShape: at constant speed both laws agree.
  extends BristleShape;
  parameter Units.Force       F_Coulomb      "Coulomb friction without pressure";
  parameter Units.PerPressure k_C            "Relative increase of F_Coulomb per pressure difference";
  parameter Units.Force       F_Stribeck_max "Stribeck force after infinite rest without pressure";
  parameter Units.PerPressure k_S            "Relative increase of the Stribeck force per pressure difference";
  parameter Units.Time        tau            "Time constant of the build-up";
  parameter Units.Exponent    n              "Exponent of the build-up";
equation
  F_C = F_Coulomb*(1 + k_C*dp);
  F_S = F_Stribeck_max*dwellSaturation(t_no, tau, n)*(1 + k_S*dp);
end LuGreDwellPressure;
