// status: 1
// error[MO0203] 6:34
// error[MO0203] 7:40
// error[MO0201] 8:17
model Misspelt
  Translational.Mass mass(m = 1, v_strat = 2);
  Translational.Spring spring(c = 100, s_rl0 = 0.1);
  Translational.Damper2 damper;
equation
  connect(mass.flange, spring.flange_a);
end Misspelt;
