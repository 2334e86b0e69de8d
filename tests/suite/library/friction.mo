//@ case coulomb_friction_stops_a_body
// F = 2 N against m = 0.5 kg at 3 m/s: rest after v m/F = 0.75 s and v^2 m/(2 F) = 1.125 m.
model Slide
  model Rubber = Friction.Coulomb(F_Coulomb = 2);
  Translational.StopMass body(m = 0.5, s_min = -1, s_max = 10, s_start = 0, v_start = 3,
    mode_start = Translational.Motion.Forward);
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Rubber);
  Pneumatics.Ambient ambient;
equation
  connect(seal.spool, body.seals);
  connect(seal.port_a, ambient.port);
  connect(seal.port_b, ambient.port);
  annotation(experiment(StopTime = 2));
end Slide;
//@ expect events = 1 at 0.75 rel 1e-9
//@ expect body.s = 1.125 rel 1e-9
//@ expect body.v = 0
//@ expect body.t_no = 1.25 rel 1e-9

//@ case bristles
//@ run stop=1 tolerance=1e-9
// LuGre and Dahl driven at constant speed, and a body on bristles under a constant load that they can bear.
model Bristles
  constant Real v = 2e-3;
  constant Real g = 3 + 2*exp(-6*v);
  Friction.LuGre lugre(v = v, dp = 0, t_no = 0, F_Coulomb = 3, F_Stribeck = 2, F_prop = 10, f_exp = 6,
    sigma_0 = 1e5, sigma_1 = 30, v_d = 0.01);
  Friction.Dahl dahl(v = v, dp = 0, t_no = 0, F_Coulomb = 3, sigma_0 = 1e5);
  // The bristles bend as g/sigma_0 (1 - exp(-sigma_0 v t/g)); their damping dies away with dz/dt.
  Real lugre_exact = g + 10*v + (30*v*exp(-(v/0.01)^2) - g)*exp(-1e5*v*time/g);
  Real dahl_exact = 3*(1 - exp(-1e5*v*time/3));

  Translational.StopMass body(m = 1, s_min = -1, s_max = 1, s_start = 0,
    mode_start = Translational.Motion.Locked);
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Friction.LuGre(
    F_Coulomb = 3, F_Stribeck = 2, F_prop = 10, f_exp = 6, sigma_0 = 1e5, sigma_1 = 30));
  Translational.Force load(f = 0.05);
  Pneumatics.Ambient ambient;
equation
  connect(seal.spool, body.seals);
  connect(seal.port_a, ambient.port);
  connect(seal.port_b, ambient.port);
  connect(load.flange, body.flange);
end Bristles;
//@ expect each lugre.f_signed = lugre_exact abs 1e-8
//@ expect each dahl.f_signed = dahl_exact abs 1e-8
// Stribeck: F_C + F_S exp(-f_exp v) + F_prop v.
//@ expect lugre.f_signed = 3 + 2*exp(-6*2e-3) + 10*2e-3 rel 1e-9
// A load of 1 % of what the bristles bear bends them by f/sigma_0 (1 + O(1 %)), counting the first swing, and
// there the body stays: no creeping on, no switching to and fro.
//@ expect seal.friction.f_z = 0.05 rel 1e-6
//@ expect body.v = 0 abs 1e-10
//@ expect body.s = 0.05/1e5 rel 0.15
// The first reversal of the speed, after which it moves freely.
//@ expect events = 1

//@ case coulomb_friction_stops_a_mass
//@ run stop=0.1
// A body comes to rest after m v^2/(2 F).
model Slide
  Seals.MassWithStopAndFriction body(m = 0.03, s_max = 1, v_start = 2,
    mode_start = Translational.Motion.Forward,
    redeclare model FrictionLaw = Friction.Coulomb(F_Coulomb = 7));
end Slide;
//@ expect body.s = 0.03*2*2/(2*7) rel 1e-9
//@ expect event[1] = 0.03*2/7 rel 1e-9

//@ case coasting_valve
//@ used by valve.rs
model Coasting
  model Rubber = Friction.Stribeck(F_Coulomb = 7, F_Stribeck = 0, F_prop = 0, f_exp = 6);
  Seals.MassWithStopAndFriction spool(m = 0.030, s_min = -1, s_max = 1, s_start = 0, v_start = 0.8,
    mode_start = Translational.Motion.Forward, redeclare model FrictionLaw = Rubber);
  Translational.Force none(f = 0);
equation
  connect(none.flange, spool.flange);
  annotation(experiment(StopTime = 0.01));
end Coasting;

//@ case balance_of_forces
//@ used by valve.rs
model Balance
  model Rubber = Friction.Stribeck(F_Coulomb = 0, F_Stribeck = 0, F_prop = 20, f_exp = 6);
  Seals.MassWithStopAndFriction spool(m = 0.030, s_min = -5e-3, s_max = 5e-3, s_start = 0,
    mode_start = Translational.Motion.Forward, redeclare model FrictionLaw = Rubber);
  Pneumatics.AirSpring drive(p_supply = 4e5, C = 0, V_dead = 0.9e-6, A = 2.01e-4);
  Pneumatics.AirSpring back(p_supply = 7e5, C = 0, V_dead = 1.6e-6, A = 1.13e-4, direction = -1);
equation
  connect(drive.flange, spool.flange);
  connect(back.flange, spool.flange);
  annotation(experiment(StopTime = 0.5));
end Balance;
