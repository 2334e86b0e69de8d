within Friction;
model Dahl "Friction that depends on the path only: elastic at first, Coulomb friction in the end"
  //   df/dt = sigma_0 v (1 - f sgn(v)/F_Coulomb)
  // Written with |v|, so that it is smooth at v = 0. From f = 0 the force rises over the path s as
  //   f = F_Coulomb (1 - exp(-sigma_0 s/F_Coulomb))
  // at any speed. This is LuGre without Stribeck force and damping.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends Law(f_signed = f_z);
  parameter Units.Force           F_Coulomb "Coulomb friction";
  parameter Units.SpringStiffness sigma_0   "Initial stiffness";

  Units.Force f_z(start = 0, fixed = true) "Force of the bristles";
equation
  f_slide = 0;
  f_static = 0;
  der(f_z) = if closed then sigma_0*(v - speed*f_z/F_Coulomb) else 0;
  when not closed then
    reinit(f_z, 0);
  end when;
end Dahl;
