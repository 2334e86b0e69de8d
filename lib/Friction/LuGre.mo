within Friction;
model LuGre "Friction of elastic bristles (Lund-Grenoble) with constant parameters"
  extends BristleShape;
  parameter Units.Force F_Coulomb  "Coulomb friction";
  parameter Units.Force F_Stribeck "Excess of static over Coulomb friction";
equation
  F_C = F_Coulomb;
  F_S = F_Stribeck;
end LuGre;
