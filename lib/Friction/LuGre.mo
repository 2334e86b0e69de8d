within Friction;
model LuGre "Friction of elastic bristles (Lund-Grenoble) with constant parameters"
  //   |f| = F_Coulomb + F_Stribeck exp(-f_exp |v|) + F_prop |v| at constant speed
  // See BristleShape for the equations.
  // Source: Canudas de Wit, Olsson, Åström and Lischinsky (1995), "A New Model for Control of Systems with Friction",
  // IEEE Trans. Automatic Control 40(3).
  extends BristleShape;
  parameter Units.Force F_Coulomb  "Coulomb friction";
  parameter Units.Force F_Stribeck "Excess of static over Coulomb friction";
equation
  F_C = F_Coulomb;
  F_S = F_Stribeck;
end LuGre;
