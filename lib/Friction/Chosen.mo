within Friction;
model Chosen "A law selected by a parameter, all laws with the parameters of one data sheet"
  // Only the selected law is part of the model: each law is an array of one instance or of none, and a sum over none
  // is 0. Laws without dwell use the Stribeck force after infinite rest, laws without pressure that at dp = 0.
  extends Law(f_signed = sum(stribeck.f_signed) + sum(stribeck_dwell.f_signed) + sum(stribeck_dwell_pressure.f_signed)
    + sum(lugre.f_signed) + sum(lugre_dwell_pressure.f_signed) + sum(dahl.f_signed));
  parameter Kind                     kind           "The selected law";
  parameter Units.Force              F_Coulomb      "Coulomb friction without pressure";
  parameter Units.PerPressure        k_C            "Relative increase of F_Coulomb per pressure difference";
  parameter Units.Force              F_Stribeck_max "Stribeck force after infinite rest without pressure";
  parameter Units.PerPressure        k_S            "Relative increase of the Stribeck force per pressure difference";
  parameter Units.Time               tau            "Time constant of the build-up";
  parameter Units.Exponent           n              "Exponent of the build-up";
  parameter Units.DampingCoefficient F_prop         "Viscous friction per speed";
  parameter Units.PerVelocity        f_exp          "Decay of the Stribeck force with speed";
  parameter Units.SpringStiffness    sigma_0 = 1e5  "Bristles: stiffness";
  parameter Units.DampingCoefficient sigma_1 = 40   "Bristles: damping";
  parameter Units.Velocity           v_0     = 1e-3 "Smoothed law: speed at which 76 % of it acts";

  Coulomb coulomb[if kind == Kind.Coulomb then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb);
  Stribeck stribeck[if kind == Kind.Stribeck then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb,
    each F_Stribeck = F_Stribeck_max, each F_prop = F_prop, each f_exp = f_exp);
  StribeckDwell stribeck_dwell[if kind == Kind.StribeckDwell then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb,
    each F_Stribeck_max = F_Stribeck_max, each tau = tau, each n = n, each F_prop = F_prop, each f_exp = f_exp);
  StribeckDwellPressure stribeck_dwell_pressure[if kind == Kind.StribeckDwellPressure then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb, each k_C = k_C,
    each F_Stribeck_max = F_Stribeck_max, each k_S = k_S, each tau = tau, each n = n, each F_prop = F_prop,
    each f_exp = f_exp);
  LuGre lugre[if kind == Kind.LuGre then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb,
    each F_Stribeck = F_Stribeck_max, each F_prop = F_prop, each f_exp = f_exp, each sigma_0 = sigma_0,
    each sigma_1 = sigma_1);
  LuGreDwellPressure lugre_dwell_pressure[if kind == Kind.LuGreDwellPressure then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb, each k_C = k_C,
    each F_Stribeck_max = F_Stribeck_max, each k_S = k_S, each tau = tau, each n = n, each F_prop = F_prop,
    each f_exp = f_exp, each sigma_0 = sigma_0, each sigma_1 = sigma_1);
  Dahl dahl[if kind == Kind.Dahl then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb,
    each sigma_0 = sigma_0);
  TanhRegularised smoothed[if kind == Kind.TanhRegularised then 1 else 0](
    each v = v, each dp = dp, each t_no = t_no, each closed = closed, each F_Coulomb = F_Coulomb, each v_0 = v_0);
equation
  f_slide = sum(coulomb.f_slide) + sum(stribeck.f_slide) + sum(stribeck_dwell.f_slide)
    + sum(stribeck_dwell_pressure.f_slide) + sum(smoothed.f_slide);
  f_static = sum(coulomb.f_static) + sum(stribeck.f_static) + sum(stribeck_dwell.f_static)
    + sum(stribeck_dwell_pressure.f_static);
end Chosen;
