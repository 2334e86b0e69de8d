// Every effect of lib/Effects twice, read by tests/checks/effects.rs.
//
// Present: with an amplitude, on something so simple that a closed form is known; `found` must follow `exact`.
// Absent:  on a valve's spool, piston and seal, with amplitudes of 0; it must move as the same without the effect.
// A model is named after its effect, and an effect without its models fails the test.
package EffectTests

  partial model Check "What is compared"
    parameter Integer n = 1 "How many values";
    Real found[n] "By simulation";
    Real exact[n] "Closed form";
    Boolean compared = true "Whether the closed form holds now";
  end Check;

  model Store "What holds a capacity times its potential"
    parameter Real C = 1 "Capacity";
    parameter Real e_start = 1 "Potential at the start";
    Real e(start = e_start, fixed = true) "Potential";
    Effects.AnyPort port;
  equation
    port.e = e;
    C*der(e) = port.f;
  end Store;

  partial model OnStore "A store that empties"
    extends Check;
    Store store(C = 2);
  equation
    found = {store.e};
  end OnStore;

  partial model BetweenStores "Two stores that become equal"
    extends Check(n = 2);
    Store upper;
    Store lower(e_start = 0);
    Real difference "Of the potentials";
  equation
    found = {upper.e, lower.e};
    exact = {(1 + difference)/2, (1 - difference)/2};
  end BetweenStores;

  partial model OnMass "A free mass"
    extends Check;
    parameter Real s_0 = 0 "Position at the start, m";
    parameter Real v_0 = 0 "Speed at the start, m/s";
    parameter Real m   = 2 "Mass, kg";
    Translational.Mass mass(m = m, s_start = s_0, v_start = v_0);
    Real s = mass.s;
    Real v = mass.v;
  end OnMass;

  partial model TwoMasses "Two masses that leave each other"
    extends Check(n = 1);
    Translational.Mass body(m = 2, v_start = -1);
    Translational.Mass other(m = 2, v_start = 1);
    constant Real omega = sqrt(200) "Of a spring of 200 N/m between them, rad/s";
  end TwoMasses;

  partial model OnSpool "A body between stops that are far away, sliding"
    extends Check;
    parameter Real v_0 = 1 "Speed at the start, m/s";
    parameter Real m   = 2 "Mass, kg";
    Translational.StopMass spool(m = m, s_min = -10, s_max = 10, s_start = 0, v_start = v_0,
      mode_start = if v_0 > 0 then Translational.Motion.Forward else Translational.Motion.Locked);
    Real s = spool.s;
    Real v = spool.v;
  end OnSpool;

  partial model OnVessel "A vessel of 1 l"
    extends Check;
    parameter Real p_1 = 1e6  "Pressure at the start, Pa";
    parameter Real V   = 1e-3 "Volume, m3";
    constant Real RT    = 287.1*293.15;
    constant Real rho_0 = 1.185;
    Pneumatics.Volume vessel(V_0 = V, p_start = p_1);
    Real p = vessel.p;
  end OnVessel;

  partial model Filled "A vessel that is filled at a constant rate: choked"
    extends OnVessel(p_1 = 1e5);
    parameter Real C = 1e-9 "Sonic conductance";
    Pneumatics.Source      supply(p = 7e5);
    Pneumatics.Restriction line(C = C, b = 0.5);
    Real slope = C*rho_0*7e5*RT "dp/dt times the volume";
  equation
    connect(supply.port, line.port_a);
    connect(line.port_b, vessel.port);
  end Filled;

  package Present
    model ConstantForce
      extends OnMass;
      Effects.ConstantForce effect(F = 3);
    equation
      connect(effect.flange, mass.flange);
      found = {s};
      exact = {3*time^2/(2*m)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ConstantForce;

    model ExtraSpring
      extends OnMass(s_0 = 0.1);
      Effects.ExtraSpring effect(c = 200, F_0 = 4, s_0 = 0.01);
      Real s_rest = 0.01 - 4/200 "Where the spring is slack";
    equation
      connect(effect.flange, mass.flange);
      found = {s};
      exact = {s_rest + (0.1 - s_rest)*cos(sqrt(200/m)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ExtraSpring;

    model StiffeningSpring
      // What the spring holds it gives back: the motion keeps its energy.
      extends OnMass(s_0 = 0.1);
      Effects.StiffeningSpring effect(c_2 = 500, c_3 = 2e4, s_0 = 0.02);
      Real x = s - 0.02;
    equation
      connect(effect.flange, mass.flange);
      found = {m*v^2/2};
      exact = {500*(0.08^3 - x^3)/3 + 2e4*(0.08^4 - x^4)/4};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end StiffeningSpring;

    model Overflow
      // Half of it is lost, half falls into a tank below.
      Tanks.Tank  upper(A = 2, h_start = 1.5);
      Tanks.Tank  lower(A = 1, h_start = 0);
      Effects.Overflow effect(k_in = 0.5, k_out = 0.5, h_max = 0.5);
      Real found[2] = {upper.h, lower.h};
      Real exact[2] = {0.5 + 1/(1 + time/4)^2, 1 - 1/(1 + time/4)^2};
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
      annotation(experiment(StopTime = 4, Tolerance = 1e-9));
    end Overflow;

    model LaminarOutflow
      Tanks.Tank  upper(A = 2, h_start = 1);
      Tanks.Tank  lower(A = 1, h_start = 0);
      Effects.LaminarOutflow effect(k = 0.6);
      Real found[2] = {upper.h, lower.h};
      Real exact[2] = {exp(-0.3*time), 2*(1 - exp(-0.3*time))};
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
      annotation(experiment(StopTime = 4, Tolerance = 1e-9));
    end LaminarOutflow;

    model ViscousDrag
      extends OnMass(v_0 = 1);
      Effects.ViscousDrag effect(d = 3);
    equation
      connect(effect.flange, mass.flange);
      found = {v};
      exact = {exp(-3/m*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end ViscousDrag;

    model PositionDrag
      extends OnMass(v_0 = 1);
      Effects.PositionDrag effect(d = 3, s_lo = -1, s_hi = 1);
    equation
      connect(effect.flange, mass.flange);
      // m dv = -d (s + 1)/2 ds
      found = {v};
      exact = {1 - 3/(2*m)*(s^2/2 + s)};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9));
    end PositionDrag;

    model DryDrag
      extends OnMass(v_0 = 1);
      // z = 1 - exp(-s/delta) while the body slides: what it loses is the work of the friction.
      Effects.DryDrag effect(F = 3, delta = 0.01);
    equation
      connect(effect.flange, mass.flange);
      found = {m*v^2/2};
      exact = {m/2 - 3*(s - 0.01*(1 - exp(-s/0.01)))};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9));
    end DryDrag;

    model SmoothDrag
      extends OnMass(v_0 = 1);
      Effects.SmoothDrag effect(F = 3, v_0 = 0.5);
    equation
      connect(effect.flange, mass.flange);
      // m dv/dt = -F tanh(v/v_0): sinh(v/v_0) decays exponentially.
      found = {sinh(v/0.5)};
      exact = {sinh(1/0.5)*exp(-3/(m*0.5)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SmoothDrag;

    model QuadraticDrag
      extends OnMass(v_0 = -1);
      Effects.QuadraticDrag effect(k = 3);
    equation
      connect(effect.flange, mass.flange);
      found = {v};
      exact = {-1/(1 + 3/m*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end QuadraticDrag;

    model DirectionalDrag
      // The same coefficient brakes one way and drives the other.
      extends OnMass(v_0 = 1, n = 2);
      Effects.DirectionalDrag effect(d = 3);
      Effects.DirectionalDrag against(d = 3);
      Translational.Mass back(m = m, s_start = 0, v_start = -1);
    equation
      connect(effect.flange, mass.flange);
      connect(against.flange, back.flange);
      found = {v, back.v};
      exact = {exp(-3/m*time), -exp(3/m*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end DirectionalDrag;

    model AddedMass
      extends OnMass;
      Effects.AddedMass effect(m = 1);
      Translational.Force force(f = 6);
    equation
      connect(effect.flange, mass.flange);
      connect(force.flange, mass.flange);
      found = {s};
      exact = {6*time^2/(2*(m + 1))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end AddedMass;

    model BellForce
      extends OnMass(v_0 = 1, compared = s > 1);
      // The work of the whole bell is F w sqrt(pi).
      Effects.BellForce effect(F = 30, s_0 = 0.5, w = 0.05);
    equation
      connect(effect.flange, mass.flange);
      found = {v};
      exact = {sqrt(1 + 2/m*30*0.05*sqrt(3.14159265358979323846))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end BellForce;

    model Detent
      extends OnMass(v_0 = 2, compared = s > 0.6);
      // The work from its middle to far away is F w sqrt(e).
      Effects.Detent effect(F = 30, s_0 = 0, w = 0.05);
    equation
      connect(effect.flange, mass.flange);
      found = {v};
      exact = {sqrt(2^2 - 2/m*30*0.05*exp(0.5))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end Detent;

    model MagneticForce
      extends OnMass(s_0 = 1);
      // Its potential is F d/(1 + x/d) with the way x left to the end.
      Effects.MagneticForce effect(F = 30, d = 0.2, side = -1, s_lo = 0.1, s_hi = 2);
      Real x = s - 0.1;
    equation
      connect(effect.flange, mass.flange);
      found = {m*v^2/2};
      exact = {30*0.2*(1/(1 + x/0.2) - 1/(1 + 0.9/0.2))};
      annotation(experiment(StopTime = 0.9, Tolerance = 1e-9));
    end MagneticForce;

    model EndCushion
      extends OnMass(v_0 = 1);
      // Over the way its integral is d w/3 (1 - x/w)^3.
      Effects.EndCushion effect(d = 6, w = 0.3, side = 1, s_lo = 0, s_hi = 1);
      Real x = 1 - s;
    equation
      connect(effect.flange, mass.flange);
      found = {v};
      exact = {if x > 0.3 then 1 else 1 - 6/m*0.3/3*(1 - x/0.3)^3};
      annotation(experiment(StopTime = 0.95, Tolerance = 1e-9));
    end EndCushion;

    model OneWayCushion
      extends OnMass(n = 2, v_0 = 1);
      // Towards the end like EndCushion, and freely away from it.
      Effects.OneWayCushion effect(d = 6, w = 0.3, side = 1, s_lo = 0, s_hi = 1);
      Translational.Mass leaving(m = m, s_start = 0.99, v_start = -0.5);
      Effects.OneWayCushion behind(d = 6, w = 0.3, side = 1, s_lo = 0, s_hi = 1);
      Real x = 1 - s;
    equation
      connect(effect.flange, mass.flange);
      connect(behind.flange, leaving.flange);
      found = {v, leaving.v};
      exact = {if x > 0.3 then 1 else 1 - 6/m*0.3/3*(1 - x/0.3)^3, -0.5};
      annotation(experiment(StopTime = 0.95, Tolerance = 1e-9));
    end OneWayCushion;

    model CompliantStop
      extends Check(n = 2);
      // Springing back: half a sine. Only damped: the speed falls with the square of the depth.
      Translational.Mass mass(m = 2, s_start = 0, v_start = 1);
      Translational.Mass damped(m = 2, s_start = 0, v_start = -1);
      Effects.CompliantStop effect(c = 800, w = 0.4, side = 1, s_lo = 0, s_hi = 0.5);
      Effects.CompliantStop damper(d = 60, w = 0.4, side = -1, s_lo = -0.5, s_hi = 0);
      Real t = time - 0.1 "Since contact";
      Real omega = sqrt(800/2);
      constant Real pi = 3.14159265358979323846;
    equation
      connect(effect.flange, mass.flange);
      connect(damper.flange, damped.flange);
      found = {mass.s, damped.v};
      exact = {if t < 0 then time elseif t < pi/omega then 0.1 + sin(omega*t)/omega else 0.1 - (t - pi/omega),
        if damped.s > -0.1 then -1 else -(1 - 60/2*(damped.s + 0.1)^2/2)};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9));
    end CompliantStop;

    model DahlPresliding
      extends Check(n = 2);
      Translational.ConstantSpeed drive(v_0 = 1e-3);
      Effects.DahlPresliding effect(F = 3, delta = 1e-5);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.f, effect.sigma_0};
      exact = {-3*(1 - exp(-1e-3*time/1e-5)), 3e5};
      annotation(experiment(StopTime = 0.1, Tolerance = 1e-9));
    end DahlPresliding;

    model LuGrePresliding
      extends Check(n = 2);
      // At a constant speed it creeps from presliding to the Stribeck curve F g(v).
      constant Real v = 2e-3;
      constant Real g = 1 + 0.5*exp(-(v/0.01)^2);
      Translational.ConstantSpeed drive(v_0 = v);
      Effects.LuGrePresliding effect(F = 3, delta = 1e-5, r = 0.5, v_s = 0.01, tau_z = 1e-3, v_d = 0.02);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.f, effect.sigma_0};
      exact = {-3*(g + (1e-3*v/1e-5*exp(-(v/0.02)^2) - g)*exp(-v*time/(g*1e-5))), 3e5};
      annotation(experiment(StopTime = 0.1, Tolerance = 1e-9));
    end LuGrePresliding;

    model BoucWenHysteresis
      extends Check(n = 2);
      // Backwards from a force forwards: as stiff as from rest with b = 1/2, and twice as stiff near z = 1 with b = 1.
      Translational.ConstantSpeed drive(v_0 = -1e-3);
      Effects.BoucWenHysteresis effect(F = 3, delta = 1e-5, z(start = 0.5));
      Effects.BoucWenHysteresis dahl(F = 3, delta = 1e-5, b = 1, z(start = 0.5));
    equation
      connect(effect.flange, drive.flange);
      connect(dahl.flange, drive.flange);
      found = {effect.f, dahl.f};
      exact = {-3*(0.5 - 100*time), -3*(1.5*exp(-100*time) - 1)};
      annotation(experiment(StopTime = 0.004, Tolerance = 1e-9));
    end BoucWenHysteresis;

    model StretchSpring
      extends TwoMasses;
      // From the distance of rest, against each other with sqrt(2 c/m).
      Effects.StretchSpring effect(c = 200, F_0 = 4);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.s_rel};
      exact = {-0.02 + 0.02*cos(omega*time) + 2/omega*sin(omega*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end StretchSpring;

    model StretchStiffening
      extends TwoMasses;
      // What it holds it gives back: the motion keeps its energy.
      Effects.StretchStiffening effect(c_2 = 30, c_3 = 200, l_0 = 0.1);
      Real x = effect.s_rel - 0.1;
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {other.v^2};
      exact = {1 - (30*(x^3 + 0.1^3)/3 + 200*(x^4 - 0.1^4)/4)/2};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end StretchStiffening;

    model StretchDamping
      extends TwoMasses;
      Effects.StretchDamping effect(d = 3);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.v_rel};
      exact = {2*exp(-3*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end StretchDamping;

    model StretchOrifice
      extends TwoMasses;
      Effects.StretchOrifice effect(k = 3);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.v_rel};
      exact = {1/(1/2 + 3*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end StretchOrifice;

    model StretchFriction
      extends TwoMasses;
      // z = 1 - exp(-s_rel/delta) while they slide: what they lose is the work of the friction.
      Effects.StretchFriction effect(F = 1, delta = 0.01);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {other.v^2};
      exact = {1 - (effect.s_rel - 0.01*(1 - exp(-effect.s_rel/0.01)))/2};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end StretchFriction;

    model StretchStop
      extends TwoMasses(n = 2);
      // The potential c w^2/(n + 1) (x/w)^(n + 1) of half the relative motion; no force before the contact, and on the other side.
      Effects.StretchStop effect(c = 50, n = 2, w = 0.2, l_0 = 0.3, side = 1);
      Translational.ConstantSpeed still(v_0 = 0);
      Translational.ConstantSpeed near(v_0 = -1);
      Effects.StretchStop below(c = 50, n = 1, w = 0.2, l_0 = -0.1, side = -1);
      Real x = noEvent(max(0, effect.s_rel - 0.3));
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      connect(below.flange_a, still.flange);
      connect(below.flange_b, near.flange);
      found = {other.v^2, below.f};
      // The power is smoothed for depths of a thousandth of w.
      exact = {1 - 50/0.2*((x^2 + 2e-4^2)^1.5 - 2e-4^3)/3/2, if time < 0.1 then 0 else -50*(time - 0.1)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end StretchStop;

    model StretchPlay
      extends Check;
      // With a spring and a damper of the same size, nothing acts within the play but for the ends.
      Translational.ConstantSpeed body(v_0 = 1);
      Translational.ConstantSpeed other(v_0 = 2, s_0 = -0.5);
      Effects.StretchPlay effect(c = 200, d = 3, b = 0.1, l_0 = 0.05);
      Translational.Spring spring(c = 200);
      Translational.Damper damper(d = 3);
      Real x = time - 0.5 - 0.05 "Distance from the middle";
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      connect(spring.flange_a, body.flange);
      connect(spring.flange_b, other.flange);
      connect(damper.flange_a, body.flange);
      connect(damper.flange_b, other.flange);
      found = {spring.f + damper.f + effect.f};
      exact = {200*0.05 + (if x < -0.1 then 200*(x + 0.1) + 3 elseif x > 0.1 then 200*(x - 0.1) + 3
        elseif abs(x) > 0.09 then 3*(1 - 10*(1 - abs(x)/0.1)) else 0)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end StretchPlay;

    model FreeForceOverStretch
      extends TwoMasses;
      // Values on a straight line: a spring.
      Effects.FreeForceOverStretch effect(F = {-200, 0, 200}, n = 3, s_lo = -1, s_hi = 1);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.s_rel};
      exact = {2/omega*sin(omega*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end FreeForceOverStretch;

    model FreeForceOverStretchRate
      extends TwoMasses;
      // Values on a straight line: a damper.
      Effects.FreeForceOverStretchRate effect(F = {-9, 0, 9}, n = 3, v_lo = -3, v_hi = 3);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.v_rel};
      exact = {2*exp(-3*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeForceOverStretchRate;

    model FreeForceOverPosition
      extends OnMass(s_0 = 0.1);
      // Values on a straight line make a spring.
      Effects.FreeForceOverPosition effect(n = 5, F = {40, 20, 0, -20, -40}, s_lo = -0.2, s_hi = 0.2);
    equation
      connect(effect.flange, mass.flange);
      found = {s};
      exact = {0.1*cos(sqrt(200/m)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeForceOverPosition;

    model FreeForceOverVelocity
      extends OnSpool;
      // Values on a straight line make a damper.
      Effects.FreeForceOverVelocity effect(n = 5, F = {0, 1, 2, 3, 4}, v_hi = 1.5);
    equation
      connect(effect.spool, spool.seals);
      found = {v};
      exact = {exp(-4/1.5/m*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeForceOverVelocity;

    model CoulombDrag
      extends OnSpool;
      Effects.CoulombDrag effect(F = 4);
    equation
      connect(effect.spool, spool.seals);
      found = {s};
      exact = {if time < m/4 then time - 4/m*time^2/2 else m/(2*4)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end CoulombDrag;

    model PositionFriction
      extends OnSpool(v_0 = 2, compared = s > 1);
      // The work of the whole bell is F w sqrt(pi).
      Effects.PositionFriction effect(F = 30, s_0 = 0.5, w = 0.05);
    equation
      connect(effect.spool, spool.seals);
      found = {v};
      exact = {sqrt(2^2 - 2/m*30*0.05*sqrt(3.14159265358979323846))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end PositionFriction;

    model FlowForceEdge
      extends OnSpool(v_0 = 2, compared = s > 1);
      // Choked; the work of the whole bell is k m_flow v w sqrt(pi).
      Pneumatics.Source high(p = 7e5);
      Pneumatics.Source low(p = 1e5);
      Effects.FlowForceEdge effect(k = 0.3, w = 0.05, m_flow = -1e-3, s_ce = 0.5);
      constant Real jet = sqrt(2*1.4/2.4*287.1*293.15);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, high.port);  connect(effect.port_b, low.port);
      found = {v};
      exact = {sqrt(2^2 + 2/m*0.3*1e-3*jet*0.05*sqrt(3.14159265358979323846))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FlowForceEdge;

    model FlowForceJet
      extends OnSpool(v_0 = 0);
      // Choked: the speed of the jet is that of sound at the throat.
      Pneumatics.Source high(p = 7e5);
      Pneumatics.Source low(p = 1e5);
      Effects.FlowForceJet effect(k = 0.3, m_flow = -1e-3);
      constant Real w = sqrt(2*1.4/2.4*287.1*293.15);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, high.port);  connect(effect.port_b, low.port);
      found = {s};
      exact = {0.3*1e-3*w*time^2/(2*m)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FlowForceJet;

    model FlowForcePressure
      extends OnSpool(v_0 = 0);
      Pneumatics.Source high(p = 7e5);
      Pneumatics.Source low(p = 1e5);
      Effects.FlowForcePressure effect(A = 1e-5, opening = 0.4);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, high.port);  connect(effect.port_b, low.port);
      found = {s};
      exact = {1e-5*0.4*6e5*time^2/(2*m)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FlowForcePressure;

    model FlowForceStream
      extends OnSpool(v_0 = 0);
      Pneumatics.Source high(p = 7e5);
      Pneumatics.Source low(p = 1e5);
      Effects.FlowForceStream effect(w = -200, m_flow = 0.01);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, high.port);  connect(effect.port_b, low.port);
      found = {s};
      exact = {-200*0.01*time^2/(2*m)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FlowForceStream;

    model SealPressureForce
      extends OnSpool(v_0 = 0);
      Pneumatics.Source high(p = 7e5);
      Pneumatics.Source low(p = 1e5);
      Effects.SealPressureForce effect(A = -1e-5);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, high.port);  connect(effect.port_b, low.port);
      found = {s};
      exact = {-1e-5*6e5*time^2/(2*m)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SealPressureForce;

    model SealPressureFriction
      extends OnSpool;
      Pneumatics.Source high(p = 7e5);
      Pneumatics.Source low(p = 1e5);
      Effects.SealPressureFriction effect(A = 1e-5);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, high.port);  connect(effect.port_b, low.port);
      found = {s};
      exact = {if time < m/6 then time - 6/m*time^2/2 else m/(2*6)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SealPressureFriction;

    model LeakLaminar
      extends OnVessel;
      Pneumatics.Ambient ambient;
      Effects.LeakLaminar effect(G = 1e-14);
      Real k = 1e-14*RT/V;
      Real y = (1e6 - 1e5)/(1e6 + 1e5)*exp(-2*k*1e5*time);
    equation
      connect(effect.port_a, vessel.port);  connect(effect.port_b, ambient.port);
      found = {p};
      exact = {1e5*(1 + y)/(1 - y)};
      annotation(experiment(StopTime = 10, Tolerance = 1e-9));
    end LeakLaminar;

    model LeakPorous
      extends Check(n = 2);
      // p_a^2 - p_b^2 = 2 p_t^2, where viscous friction and inertia take the same share: m_flow = G p_t^2.
      Pneumatics.Source high(p = 3e5);
      Pneumatics.Source low(p = 1e5);
      Effects.LeakPorous effect(G = 1e-14, p_t = 2e5);
      Effects.LeakPorous reversed(G = 1e-14, p_t = 2e5);
    equation
      connect(effect.port_a, high.port);   connect(effect.port_b, low.port);
      connect(reversed.port_a, low.port);  connect(reversed.port_b, high.port);
      found = {effect.m_flow, reversed.m_flow};
      exact = {4e-4, -4e-4};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end LeakPorous;

    model LeakOrifice
      extends OnVessel(compared = p > 4e5);
      // Choked down to 1 bar/b.
      Pneumatics.Ambient ambient;
      Effects.LeakOrifice effect(C = 1e-9, b = 0.25);
    equation
      connect(effect.port_a, vessel.port);  connect(effect.port_b, ambient.port);
      found = {p};
      exact = {1e6*exp(-1e-9*rho_0*RT/V*time)};
      annotation(experiment(StopTime = 10, Tolerance = 1e-9));
    end LeakOrifice;

    model FreeFlow
      extends OnVessel;
      // Values on a straight line make a flow in proportion to the pressure difference.
      Pneumatics.Ambient ambient;
      Effects.FreeFlow effect(n = 3, Q = {1e-4, 2e-4, 3e-4}, dp_hi = 1e6);
    equation
      connect(effect.port_a, vessel.port);  connect(effect.port_b, ambient.port);
      found = {p};
      exact = {1e5 + 9e5*exp(-3e-10*RT/V*time)};
      annotation(experiment(StopTime = 50, Tolerance = 1e-9));
    end FreeFlow;

    model LineInertia
      extends OnVessel;
      // A vessel that a flow of time leaves, behind a lag.
      Effects.LineInertia effect(m_host = 1e-6*time, tau = 0.2, tau_min = 1e-9);
      Pneumatics.Ambient ambient;
    equation
      connect(effect.port_a, vessel.port);
      connect(effect.port_b, ambient.port);
      found = {effect.m_flow};
      exact = {-0.2e-6*(1 - exp(-time/0.2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end LineInertia;

    model LineLag
      extends OnVessel;
      // As LineInertia, but for the share T/tau.
      Effects.LineLag effect(m_host = 1e-6*time, T = 0.3, tau = 0.2);
      Pneumatics.Ambient ambient;
    equation
      connect(effect.port_a, vessel.port);
      connect(effect.port_b, ambient.port);
      found = {effect.m_flow};
      exact = {-0.3e-6*(1 - exp(-time/0.2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end LineLag;

    model DeadVolume
      extends Filled;
      Effects.DeadVolume effect(V = 0.5e-3);
    equation
      connect(effect.port, vessel.port);
      found = {p};
      exact = {p_1 + slope/(V + 0.5e-3)*time};
      annotation(experiment(StopTime = 3, Tolerance = 1e-9));
    end DeadVolume;

    model PolytropicStorage
      extends Filled;
      Effects.PolytropicStorage effect(k = 0.2, V = vessel.V);
    equation
      connect(effect.port, vessel.port);
      found = {p};
      exact = {p_1 + slope/(V*(1 - 0.2))*time};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end PolytropicStorage;

    model WallHeat
      extends Filled;
      // Without heat transfer theta = (kappa - 1)/kappa ln(p/p_1), and the mass within grows at the rate of the filling.
      Effects.WallHeat effect(k = 1, tau = 1e12, V = vessel.V);
      Real p_iso = p*(1 - 0.4/1.4*log(p/p_1)) "What the same mass would have at T";
    equation
      connect(effect.port, vessel.port);
      found = {p_iso};
      exact = {p_1 + slope/V*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end WallHeat;

    model DirectionalFriction
      // With as much friction both ways: twice one way, none the other.
      extends OnSpool(n = 2);
      Effects.DirectionalFriction effect(F = 3, v_0 = 1e-6);
      Effects.CoulombDrag drag(F = 3);
      Translational.StopMass back(m = m, s_min = -10, s_max = 10, s_start = 0, v_start = -1,
        mode_start = Translational.Motion.Backward);
      Effects.DirectionalFriction effect_back(F = 3, v_0 = 1e-6);
      Effects.CoulombDrag drag_back(F = 3);
    equation
      connect(effect.spool, spool.seals);
      connect(drag.spool, spool.seals);
      connect(effect_back.spool, back.seals);
      connect(drag_back.spool, back.seals);
      found = {v, back.v};
      exact = {1 - 6/m*time, -1};
      annotation(experiment(StopTime = 0.3, Tolerance = 1e-9));
    end DirectionalFriction;

    model DirectionalSealFriction
      // Of a friction of 3, 4 acts against +v and 2 against -v, at rest as well.
      extends OnSpool(n = 4);
      Effects.DirectionalSealFriction effect(a = 1/3, F = spool.seals.f_slide);
      Effects.CoulombDrag drag(F = 3);
      Translational.StopMass back(m = m, s_min = -10, s_max = 10, s_start = 0, v_start = -1,
        mode_start = Translational.Motion.Backward);
      Effects.DirectionalSealFriction effect_back(a = 1/3, F = back.seals.f_slide);
      Effects.CoulombDrag drag_back(F = 3);
      Translational.StopMass held(m = m, s_min = -10, s_max = 10, s_start = 0, mode_start = Translational.Motion.Locked);
      Effects.DirectionalSealFriction effect_held(a = 1/3, F = held.seals.f_slide);
      Effects.CoulombDrag drag_held(F = 3);
      Effects.ConstantForce push(F = 3.5);
      Translational.StopMass slips(m = m, s_min = -10, s_max = 10, s_start = 0, mode_start = Translational.Motion.Locked);
      Effects.DirectionalSealFriction effect_slips(a = 1/3, F = slips.seals.f_slide);
      Effects.CoulombDrag drag_slips(F = 3);
      Effects.ConstantForce pull(F = -2.5);
    equation
      connect(effect.seals, spool.seals);
      connect(drag.spool, spool.seals);
      connect(effect_back.seals, back.seals);
      connect(drag_back.spool, back.seals);
      connect(effect_held.seals, held.seals);
      connect(drag_held.spool, held.seals);
      connect(push.flange, held.flange);
      connect(effect_slips.seals, slips.seals);
      connect(drag_slips.spool, slips.seals);
      connect(pull.flange, slips.flange);
      found = {v, back.v, held.v, slips.v};
      exact = {1 - 4/m*time, -(1 - 2/m*time), 0, -0.5/m*time};
      annotation(experiment(StopTime = 0.3, Tolerance = 1e-9));
    end DirectionalSealFriction;

    model FreeLeakOverPosition
      // Values on a straight line under a spool at constant speed: choked, the pressure falls with the square of time.
      extends OnVessel(compared = p > 4e5);
      Pneumatics.Ambient ambient;
      Translational.GuidedSpool spool(s = 0.1*time);
      Effects.FreeLeakOverPosition effect(n = 5, C = {0, 1e-9, 2e-9, 3e-9, 4e-9}, b = 0.25, s_lo = 0, s_hi = 1);
    equation
      connect(effect.spool, spool.seals);
      connect(effect.port_a, vessel.port);  connect(effect.port_b, ambient.port);
      found = {p};
      exact = {1e6*exp(-4e-9*rho_0*RT/V*0.1*time^2/2)};
      annotation(experiment(StopTime = 8, Tolerance = 1e-9));
    end FreeLeakOverPosition;

    model PilotValve
      // It opens at 0.1 s with tau = 0.05 s, and closes from 0.1 + 0.02 s after the switch on with 0.08 s.
      extends Check;
      Signals.SwitchSignal switch(t_off = 1);
      Signals.PilotValve effect(on = switch.on, t_delay = 0.1, tau = 0.05, t_off_more = 0.02, tau_off_more = 0.03);
      Real t_close = 1 + 0.1 + 0.02;
    equation
      found = {effect.x};
      exact = {if time < 0.1 then 0 elseif time < t_close then 1 - exp(-(time - 0.1)/0.05)
        else (1 - exp(-(t_close - 0.1)/0.05))*exp(-(time - t_close)/0.08)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end PilotValve;

    model Restriction
      // Choked: a fifth of the conductance is missing.
      extends Filled(line(blocked = 0.2));
    equation
      found = {p};
      exact = {p_1 + 0.8*slope/V*time};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9));
    end Restriction;

    model VariableRestriction
      extends OnVessel(p_1 = 1e5);
      Pneumatics.Source supply(p = 7e5);
      // Opens linearly, and is wider than its sheet says: by a tenth.
      Pneumatics.VariableRestriction effect(C = 1e-9, b = 0.5, x = time, blocked = -0.1);
    equation
      connect(supply.port, effect.port_a);
      connect(effect.port_b, vessel.port);
      found = {p};
      exact = {p_1 + 1.1*1e-9*rho_0*7e5*RT/V*time^2/2};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9));
    end VariableRestriction;

    model Source
      extends Check;
      // A choked hole draws in proportion to the pressure before it, C rho_0 p: K = R C rho_0.
      Pneumatics.Source      effect(p = 8e5, has_line = true, R_line = 2e8, tau_line = 0.05);
      Pneumatics.Restriction hole(C = 1e-9, b = 0.4);
      Pneumatics.Ambient     ambient;
      constant Real K = 2e8*1e-9*1.185;
    equation
      connect(effect.port, hole.port_a);
      connect(hole.port_b, ambient.port);
      found = {effect.port.p};
      exact = {8e5*(1 - K/(1 + K)*(1 - exp(-(1 + K)*time/0.05)))};
      annotation(experiment(StopTime = 0.2, Tolerance = 1e-9));
    end Source;

    model ConstantOutflow
      extends OnStore;
      Effects.ConstantOutflow effect(F = 0.4);
    equation
      connect(effect.port, store.port);
      exact = {1 - 0.2*time};
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end ConstantOutflow;

    model LinearOutflow
      extends OnStore;
      Effects.LinearOutflow effect(k = 0.6);
    equation
      connect(effect.port, store.port);
      exact = {exp(-0.3*time)};
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end LinearOutflow;

    model QuadraticOutflow
      extends OnStore;
      Effects.QuadraticOutflow effect(k = 0.6);
    equation
      connect(effect.port, store.port);
      exact = {1/(1 + 0.3*time)};
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end QuadraticOutflow;

    model RootOutflow
      extends OnStore;
      Effects.RootOutflow effect(k = 0.6, delta = 1e-12);
    equation
      connect(effect.port, store.port);
      exact = {(1 - 0.15*time)^2};
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end RootOutflow;

    model FreeOutflow
      extends OnStore;
      // Knots on a straight line.
      Effects.FreeOutflow effect(F = 0.1*{0, 1, 2, 3, 4, 5, 6});
    equation
      connect(effect.port, store.port);
      exact = {exp(-0.3*time)};
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end FreeOutflow;

    model LinearBypass
      extends BetweenStores;
      Effects.LinearBypass effect(k = 0.3);
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
      difference = exp(-0.6*time);
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end LinearBypass;

    model QuadraticBypass
      extends BetweenStores;
      Effects.QuadraticBypass effect(k = 0.3);
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
      difference = 1/(1 + 0.6*time);
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end QuadraticBypass;

    model RootBypass
      extends BetweenStores;
      Effects.RootBypass effect(k = 0.2, delta = 1e-12);
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
      difference = (1 - 0.2*time)^2;
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end RootBypass;

    model FreeBypass
      extends BetweenStores;
      // Knots on a straight line.
      Effects.FreeBypass effect(F = 0.05*{0, 1, 2, 3, 4, 5, 6});
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
      difference = exp(-0.6*time);
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end FreeBypass;

    model SensorDrift
      extends Check;
      Effects.SensorDrift effect(r = 0.3, u = 2);
    equation
      found = {effect.y};
      exact = {2 + 0.3*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorDrift;

    model SensorOffset
      extends Check;
      Effects.SensorOffset effect(offset = 0.3, u = time);
    equation
      found = {effect.y};
      exact = {time + 0.3};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorOffset;

    model LinearVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.LinearVariation effect(a = 0.5, x = time, x_lo = 0, x_hi = 2);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*(time + 0.125*time^2))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end LinearVariation;

    model OtherStart
      extends Check;
      parameter Real T_0 = 2;
      Real T(start = T_0, fixed = true);
      Effects.OtherStart effect(d = 0.5);
    equation
      der(T) = -2*T;
      found = {T};
      exact = {2.5*exp(-2*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(starts = "T = effect.d"));
    end OtherStart;

    model OtherValue
      extends Check;
      parameter Real k = 2;
      parameter Real twice = 2*k;
      Real T(start = 1, fixed = true);
      Effects.OtherValue effect(a = log(1.5));
    equation
      der(T) = -twice*T;
      found = {T};
      exact = {exp(-6*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end OtherValue;

    model PowerVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.PowerVariation effect(e = 0.5, x = -1 - time, x_0 = 2);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-4/3/sqrt(2)*((1 + time)^1.5 - 1))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end PowerVariation;

    model ExponentialVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.ExponentialVariation effect(k = -1.5, x_lo = 0, x_hi = 3, x = time);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-4*(1 - exp(-0.5*time)))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end ExponentialVariation;

    model DirectionalVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.DirectionalVariation effect(a = 0.5, x = 1 - time);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {if time < 1 then exp(-3*time) else exp(-2 - time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end DirectionalVariation;

    model RateVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.RateVariation effect(a = 0.3, x = time - 1, x_0 = 0.5);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*(time + 0.15*(log(cosh((time - 1)/0.5)) - log(cosh(2)))))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end RateVariation;

    model ArrheniusVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      // With this x, the factor is exp(time).
      Effects.ArrheniusVariation effect(b = 2, x = 3/(1 - time/2), x_0 = 3);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*(exp(time) - 1))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end ArrheniusVariation;

    model SaturationVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.SaturationVariation effect(k = 4, m = 1.5, x = time, x_0 = 2);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*time/sqrt(1 + time^2))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end SaturationVariation;

    model HarmonicVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.HarmonicVariation effect(A = 0.3, B = 0.2, N = 3, x = time);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*(time + 0.3*(1 - cos(3*time))/3 + 0.2*sin(3*time)/3))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end HarmonicVariation;

    model AccumulationVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.AccumulationVariation effect(a = 0.4, x = -2, x_0 = 1, T = 4);
    equation
      der(T) = -k*T;
      found = {T};
      // e = time/2.
      exact = {exp(-2*(time + 0.1*time^2))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end AccumulationVariation;

    model ExposureVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.ExposureVariation effect(k = -0.5, x = -2, x_0 = 1, T = 4);
    equation
      der(T) = -k*T;
      found = {T};
      // e = time/2.
      exact = {exp(-8*(1 - exp(-time/4)))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end ExposureVariation;

    model WaveVariation
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.WaveVariation effect(A = 0.3, B = 0.2, x = time, L = 2);
      constant Real pi = 3.14159265358979324;
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*(time + 0.3*(1 - cos(pi*time))/pi + 0.2*sin(pi*time)/pi))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end WaveVariation;

    model OptimumVariation
      extends Check;
      // u = time - 1
      Effects.OptimumVariation effect(a = 0.6, b = -0.9, x = time, x_hi = 2);
    equation
      found = {effect.factor};
      exact = {exp(0.6*(time - 1) - 0.9*(time - 1)^2)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11));
    end OptimumVariation;

    model StepVariation
      extends Check(n = 2);
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.StepVariation before(a = 0.5, x = 5, x_s = 5.5);
      Effects.StepVariation effect(a = 0.5, x = 6, x_s = 5.5);
    equation
      der(T) = -k*T;
      found = {T, before.factor};
      exact = {exp(-3*time), 1};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end StepVariation;

    model LaggedVariation
      extends Check;
      Effects.LaggedVariation effect(a = 0.5, tau = 0.2, x = time, x_lo = 0, x_hi = 2);
    equation
      found = {effect.factor};
      exact = {1 + 0.25*(time - 0.2*(1 - exp(-time/0.2)))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-10));
    end LaggedVariation;

    model HeatingVariation
      extends Check;
      Effects.HeatingVariation effect(a = 0.125, tau = 0.2, x = -2);
    equation
      found = {effect.factor};
      // (x/x_0)^2 = 4, so a halves the rate at which z settles, and z settles at 8.
      exact = {1 + (1 - exp(-0.5*time/0.2))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-10));
    end HeatingVariation;

    model FreeVariation
      extends Check;
      // Knots on a straight line.
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
      Effects.FreeVariation effect(f = {0.1, 0.2, 0.3, 0.4, 0.5}, x = time, x_lo = 0, x_hi = 2);
    equation
      der(T) = -k*T;
      found = {T};
      exact = {exp(-2*(time + 0.125*time^2))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(varies = "k = effect.factor"));
    end FreeVariation;

    partial model Equation "A state whose equation may lack a term"
      extends Check;
      parameter Real k = 2;
      Real T(start = 1, fixed = true);
    equation
      der(T) = -k*T;
    end Equation;

    model ConstantTerm
      extends Equation;
      Effects.ConstantTerm effect(a = 3);
    equation
      found = {T};
      exact = {1.5 - 0.5*exp(-2*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end ConstantTerm;

    model LinearTerm
      extends Equation;
      Effects.LinearTerm effect(a = 3, x = time);
    equation
      found = {T};
      exact = {1.75*exp(-2*time) + 3*(time/2 - 0.25)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end LinearTerm;

    model ProductTerm
      extends Equation;
      Effects.ProductTerm effect(a = 3, x = time, y = T);
    equation
      found = {T};
      exact = {exp(-2*time + 1.5*time^2)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end ProductTerm;

    model SaturatingTerm
      extends Equation;
      Effects.SaturatingTerm effect(A = 2, K = 1, x = T);
    equation
      // T' = -2 T + 2 T/(1 + T) = -2 T^2/(1 + T)
      found = {log(T) - 1/T};
      exact = {-1 - 2*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end SaturatingTerm;

    model MonodTerm
      extends Equation;
      Effects.MonodTerm effect(A = 2, K = 1, x = T, y = time);
    equation
      found = {T};
      exact = {1/(1 + time)^2};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end MonodTerm;

    model LateTerm
      extends Equation;
      Effects.LateTerm effect(T = 0.5, T_min = 0, x = -k*T);
    equation
      found = {T};
      exact = {exp(-time)*(cos(sqrt(3)*time) - sin(sqrt(3)*time)/sqrt(3))};
      annotation(experiment(StopTime = 3, Tolerance = 1e-10), __mocc(adds = "der(T) = effect.term"));
    end LateTerm;

    model RelaxationTerm
      extends Equation;
      Effects.RelaxationTerm effect(a = 3, tau = 0.25, x = 1);
    equation
      found = {T};
      exact = {1.5 - 2*exp(-2*time) + 1.5*exp(-4*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(adds = "der(T) = effect.term"));
    end RelaxationTerm;

    model HysteresisTerm
      extends Check;
      // Up until 1, then down.
      Real x(start = 0, fixed = true);
      constant Real T = 1e-3 "Lag of the path";
      Effects.HysteresisTerm effect(A = 3, w = 0.1, T_min = T, x = x);
      Real path = if time < 1 then time - T*(1 - exp(-time/T)) else 2 - time + T - 2*T*exp(-(time - 1)/T);
      constant Real peak = 1 - T*log(2) "Where the path turns, by so much later than x";
      Real z = if time < 1 + T*log(2) then 1 - exp(-path/0.1) else -1 + (2 - exp(-peak/0.1))*exp((path - peak)/0.1);
    equation
      der(x) = if time < 1 then 1 else -1;
      found = {effect.term};
      exact = {3*z};
      annotation(experiment(StopTime = 2, Tolerance = 1e-10));
    end HysteresisTerm;

    model StoredTerm
      extends Equation;
      Effects.StoredTerm effect(T = 0.5, T_min = 0, x = -k*T);
    equation
      found = {T};
      exact = {exp(-time)*(cos(sqrt(3)*time) + sin(sqrt(3)*time)/sqrt(3))};
      annotation(experiment(StopTime = 3, Tolerance = 1e-10), __mocc(adds = "der(T) = effect.term"));
    end StoredTerm;

    model FreeTerm
      extends Equation;
      // Knots on a straight line.
      Effects.FreeTerm effect(f = {0, 1, 2, 3, 4, 5, 6}, x = time, x_lo = 0, x_hi = 2);
    equation
      found = {T};
      exact = {1.75*exp(-2*time) + 3*(time/2 - 0.25)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end FreeTerm;

    partial model Rotor "A free rotor"
      extends Check;
      parameter Real J = 2;
      Real phi(start = 0, fixed = true, unit = "rad");
      Real w(start = 1, fixed = true);
    equation
      der(phi) = w;
      J*der(w) = 0;
    end Rotor;

    model QuadraticTerm
      extends Rotor;
      Effects.QuadraticTerm effect(a = -0.5, x = w);
    equation
      found = {w};
      exact = {1/(1 + 0.25*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(w) = effect.term"));
    end QuadraticTerm;

    model SquareTerm
      extends Equation;
      Effects.SquareTerm effect(a = 3, x = time);
    equation
      found = {T};
      exact = {0.25*exp(-2*time) + 1.5*time^2 - 1.5*time + 0.75};
      annotation(experiment(StopTime = 2, Tolerance = 1e-11), __mocc(adds = "der(T) = effect.term"));
    end SquareTerm;

    model CubicTerm
      extends Rotor;
      Effects.CubicTerm effect(a = -1, x = w);
    equation
      found = {w};
      exact = {1/sqrt(1 + time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(w) = effect.term"));
    end CubicTerm;

    model DryTerm
      extends Rotor;
      // z = 1 - exp(-phi/delta) while the rotor turns: what it loses is the work of the friction.
      Effects.DryTerm effect(F = 3, delta = 0.01, x = w);
    equation
      found = {J*w^2/2};
      exact = {J/2 - 3*(phi - 0.01*(1 - exp(-phi/0.01)))};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9), __mocc(adds = "der(w) = effect.term"));
    end DryTerm;

    model StribeckTerm
      extends Check;
      Real x = 1 + time;
      Effects.StribeckTerm effect(F = 3, F_s = 2, x_s = 1.5, delta = 0.01, x = x);
    equation
      found = {effect.term};
      exact = {-(3 + 2*exp(-(x/1.5)^2))*(1 - exp(-(time + time^2/2)/0.01))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end StribeckTerm;

    model SmoothStribeckTerm
      extends Check;
      Real x = 1 + time;
      Effects.SmoothStribeckTerm effect(F = 3, F_s = 2, x_s = 1.5, x_0 = 0.8, x = x);
    equation
      found = {effect.term};
      exact = {-(3 + 2*exp(-(x/1.5)^2))*tanh(x/0.8)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end SmoothStribeckTerm;

    model SmoothDryTerm
      extends Rotor;
      Effects.SmoothDryTerm effect(F = 3, x_0 = 0.5, x = w);
    equation
      // sinh(w/x_0) decays exponentially.
      found = {sinh(w/0.5)};
      exact = {sinh(1/0.5)*exp(-3/(J*0.5)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(w) = effect.term"));
    end SmoothDryTerm;

    model PeriodicTerm
      extends Check;
      parameter Real J = 2;
      Real phi(start = 0, fixed = true, unit = "rad");
      Real w(start = 1, fixed = true);
      Effects.PeriodicTerm effect(A = 3, B = 4, x = phi);
    equation
      der(phi) = 5;
      J*der(w) = 0;
      found = {w};
      exact = {1 + (3*(1 - cos(5*time)) + 4*sin(5*time))/(5*J)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(w) = effect.term"));
    end PeriodicTerm;

    model ExchangeTerm
      extends Check;
      Real T(start = 500, fixed = true, unit = "K");
      Effects.ExchangeTerm effect(a = 2, x_0 = 300, x = T);
    equation
      der(T) = 0;
      found = {T};
      exact = {300 + 200*exp(-2*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end ExchangeTerm;

    model RadiationTerm
      extends Check;
      Real T(start = 500, fixed = true, unit = "K");
      Effects.RadiationTerm effect(a = 1e-9, x_0 = 0, x = T);
    equation
      der(T) = 0;
      found = {T};
      exact = {(500^(-3) + 3e-9*time)^(-1/3)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(adds = "der(T) = effect.term"));
    end RadiationTerm;

    partial model Driven "An input that is integrated"
      extends Check;
      input Real u(start = 2);
      Real x(start = 0, fixed = true) "Integral of what acts";
    equation
      der(x) = u;
      found = {x};
    end Driven;

    model ActuatorGain
      extends Driven;
      Effects.ActuatorGain effect(g = 0.1, u = u);
    equation
      exact = {2.2*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(through = "u = effect.y"));
    end ActuatorGain;

    model ActuatorOffset
      extends Driven;
      Effects.ActuatorOffset effect(offset = 0.3, u = u);
    equation
      exact = {2.3*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9), __mocc(through = "u = effect.y"));
    end ActuatorOffset;

    model ActuatorLag
      extends Check(n = 2);
      // A ramp; T_min makes the lag longer where it is not short.
      Effects.ActuatorLag effect(T = 0.2, u = time);
      Effects.ActuatorLag blurred(T = 0.03, T_min = 0.04, u = time);
    equation
      found = {effect.y, blurred.y};
      exact = {time - 0.2*(1 - exp(-time/0.2)), time - 0.03*(1 - exp(-time/0.05))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ActuatorLag;

    model ActuatorEmptyStore
      extends Check(n = 2);
      // T_min makes the lag longer where it is not short.
      Effects.ActuatorEmptyStore effect(T = 0.2, T_min = 0, u = 2);
      Effects.ActuatorEmptyStore blurred(T = 0.03, T_min = 0.04, u = 2);
    equation
      found = {effect.y, blurred.y};
      exact = {2*(1 - exp(-time/0.2)), 2 - 1.2*exp(-time/0.05)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end ActuatorEmptyStore;

    model ActuatorPartialLag
      extends Check(n = 2);
      // A ramp acts T late; with T = tau it is the lag of first order.
      Effects.ActuatorPartialLag effect(T = 0.05, tau = 0.2, u = time);
      Effects.ActuatorPartialLag lag(T = 0.2, tau = 0.2, u = time);
    equation
      found = {effect.y, lag.y};
      exact = {time - 0.05*(1 - exp(-time/0.2)), time - 0.2*(1 - exp(-time/0.2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ActuatorPartialLag;

    model ActuatorRateLimit
      extends Check(n = 2);
      // A ramp that is too fast, and a parabola that becomes so at 0.25; before, it is followed T_min late.
      Effects.ActuatorRateLimit effect(a = 0.5, r_max = 2, T_min = 1e-8, u = 3*time);
      Effects.ActuatorRateLimit late(a = 1, r_max = 1, T_min = 1e-8, u = 2*time^2);
    equation
      found = {effect.y, late.y};
      exact = {2.5*time, if time < 0.25 then 2*time^2 - 4e-8*time else 0.125 - 1e-8 + (time - 0.25)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ActuatorRateLimit;

    model ActuatorDelay
      extends Check;
      // A ramp.
      Effects.ActuatorDelay effect(t_d = 0.19, T_min = 0.01, u = time);
    equation
      found = {effect.y};
      exact = {max(0, time - 0.2)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ActuatorDelay;

    model ActuatorHysteresis
      extends Check;
      // Up until 1, then down.
      Real u = if time < 1 then time else 2 - time;
      Real x(start = 0, fixed = true) "The same, as a state";
      constant Real T = 1e-3 "Lag of the path";
      Effects.ActuatorHysteresis effect(h = 0.02, w = 0.1, T_min = T, u = x);
      Real path = if time < 1 then time - T*(1 - exp(-time/T)) else 2 - time + T - 2*T*exp(-(time - 1)/T);
      constant Real peak = 1 - T*log(2) "Where the path turns, by so much later than u";
      Real z = if time < 1 + T*log(2) then 1 - exp(-path/0.1) else -1 + (2 - exp(-peak/0.1))*exp((path - peak)/0.1);
    equation
      der(x) = if time < 1 then 1 else -1;
      found = {effect.y};
      exact = {u - 0.02*z};
      annotation(experiment(StopTime = 2, Tolerance = 1e-10));
    end ActuatorHysteresis;

    model ActuatorBacklash
      extends Check(n = 2);
      Real x(start = 0, fixed = true) "A ramp, as a state";
      constant Real T = 1e-3 "Lag of the path";
      Effects.ActuatorBacklash effect(h = 0.02, w = 0.1, T_min = T, u = x);
      Real jumping = if time < 0.04 then 0 else 1 + time;
      Effects.ActuatorBacklash behind(h = 0.02, w = 0.01, T_min = 1e-6, u = jumping);
      Real z = (x - effect.y)/0.02;
    equation
      der(x) = 1;
      // The integral of dz/(1 - z^19), as a series.
      // After a jump by much more than w, the play is crossed.
      found = {z + z^20/20 + z^39/39 + z^58/58 + z^77/77 + z^96/96, if time < 0.06 then -0.02 else behind.y - jumping};
      exact = {(time - T*(1 - exp(-time/T)))/0.1, -0.02};
      annotation(experiment(StopTime = 0.088, Tolerance = 1e-10));
    end ActuatorBacklash;

    model FreeActuator
      extends Check;
      // Knots on a straight line.
      Effects.FreeActuator effect(f = 0.1*{-3, -2, -1, 0, 1, 2, 3}, u_lo = -3, u_hi = 3, u = time);
    equation
      found = {effect.y};
      exact = {1.1*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeActuator;

    model ActuatorSaturation
      extends Check;
      Effects.ActuatorSaturation effect(k = 0.25, u = time);
    equation
      found = {effect.y};
      exact = {2*time/sqrt(4 + time^2)};
      annotation(experiment(StopTime = 5, Tolerance = 1e-9));
    end ActuatorSaturation;

    model ActuatorTanh
      extends Check;
      Effects.ActuatorTanh effect(k = 0.25, u = time);
    equation
      found = {effect.y};
      exact = {2*tanh(time/2)};
      annotation(experiment(StopTime = 5, Tolerance = 1e-9));
    end ActuatorTanh;

    model SensorTanh
      extends Check;
      Effects.SensorTanh effect(k = 0.25, u = -time);
    equation
      found = {effect.y};
      exact = {-2*tanh(time/2)};
      annotation(experiment(StopTime = 5, Tolerance = 1e-9));
    end SensorTanh;

    model SensorSaturation
      extends Check;
      Effects.SensorSaturation effect(k = 0.25, u = -time);
    equation
      found = {effect.y};
      exact = {-2*time/sqrt(4 + time^2)};
      annotation(experiment(StopTime = 5, Tolerance = 1e-9));
    end SensorSaturation;

    model ActuatorLimit
      extends Check;
      Effects.ActuatorLimit effect(a = 0.75, y_max = 2, u = time - 3);
    equation
      found = {effect.y};
      exact = {if time < 1 then -2 + 0.25*(time - 1) elseif time < 5 then time - 3 else 2 + 0.25*(time - 5)};
      annotation(experiment(StopTime = 6, Tolerance = 1e-9));
    end ActuatorLimit;

    model ActuatorUpperLimit
      extends Check;
      Effects.ActuatorUpperLimit effect(a = 0.75, y_max = 2, delta = 1e-9, u = time - 3);
    equation
      found = {effect.y};
      exact = {if time < 5 then time - 3 else 2 + 0.25*(time - 5)};
      annotation(experiment(StopTime = 6, Tolerance = 1e-9));
    end ActuatorUpperLimit;

    model ActuatorLowerLimit
      extends Check;
      Effects.ActuatorLowerLimit effect(a = 0.75, y_min = -2, u = time - 3);
    equation
      found = {effect.y};
      exact = {if time < 1 then -2 + 0.25*(time - 1) else time - 3};
      annotation(experiment(StopTime = 6, Tolerance = 1e-9));
    end ActuatorLowerLimit;

    model SensorLimit
      extends Check;
      Effects.SensorLimit effect(a = 1, y_max = 2, u = 3 - time);
    equation
      found = {effect.y};
      exact = {if time < 1 then 2 elseif time < 5 then 3 - time else -2};
      annotation(experiment(StopTime = 6, Tolerance = 1e-9));
    end SensorLimit;

    model ActuatorDeadZone
      extends Check;
      Effects.ActuatorDeadZone effect(a = 1, b = 0.5, u = time - 3);
    equation
      found = {effect.y};
      exact = {if time < 2.5 then time - 2.5 elseif time < 3.5 then 0 else time - 3.5};
      annotation(experiment(StopTime = 6, Tolerance = 1e-9));
    end ActuatorDeadZone;

    model FreeSensor
      extends Check;
      // Knots on a straight line.
      Effects.FreeSensor effect(f = 0.1*{-5, -3, -1, 1, 3, 5}, u_lo = -5, u_hi = 5, u = time);
    equation
      found = {effect.y};
      exact = {1.1*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeSensor;

    model SensorGain
      extends Check;
      Effects.SensorGain effect(g = 0.1, u = time);
    equation
      found = {effect.y};
      exact = {1.1*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorGain;

    model SensorGainFromZero
      extends Check;
      Effects.SensorGainFromZero effect(g = 0.1, u = time, u_0 = 0.5);
    equation
      found = {effect.y};
      exact = {time + 0.1*(time - 0.5)};
      annotation(experiment(StopTime = 1));
    end SensorGainFromZero;

    model SensorMagnitude
      extends Check;
      Effects.SensorMagnitude effect(m = 1, u = 1 - 2*time);
    equation
      found = {effect.y};
      exact = {if time < 0.5 then 1 - 2*time else 2*time - 1};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorMagnitude;

    model SensorLag
      extends Check(n = 2);
      // A ramp is read T late; with T = tau it is the first-order lag.
      Effects.SensorLag effect(T = 0.05, tau = 0.2, u = time);
      Effects.SensorLag lag(T = 0.2, tau = 0.2, u = time);
    equation
      found = {effect.y, lag.y};
      exact = {time - 0.05*(1 - exp(-time/0.2)), time - 0.2*(1 - exp(-time/0.2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorLag;

    model SensorTimeConstant
      extends Check(n = 2);
      // A ramp; T_min makes the lag longer where it is not short.
      Effects.SensorTimeConstant effect(T = 0.2, u = time);
      Effects.SensorTimeConstant blurred(T = 0.03, T_min = 0.04, u = time);
    equation
      found = {effect.y, blurred.y};
      exact = {time - 0.2*(1 - exp(-time/0.2)), time - 0.03*(1 - exp(-time/0.05))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorTimeConstant;

    model SensorDeadTime
      extends Check(n = 2, compared = time > 2);
      // A ramp arrives exactly late; of a sine the phase follows from the sections: 8 atan(omega t_d/8).
      Effects.SensorDeadTime ramp(t_d = 0.2, u = time);
      Effects.SensorDeadTime sine(t_d = 0.2, u = sin(5*time));
    equation
      found = {ramp.y, sine.y};
      exact = {time - 0.2, sin(5*time - 8*atan(5*0.2/8))};
      annotation(experiment(StopTime = 4, Tolerance = 1e-10));
    end SensorDeadTime;

    model SensorDelay
      extends Check;
      // Of a parabola Taylor leaves the square of the delay.
      Effects.SensorDelay effect(t_d = 0.01, u = time^2);
    equation
      found = {effect.y};
      exact = {(time - 0.01)^2 - 0.01^2};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SensorDelay;

    model SensorCrossTalk
      extends Check;
      Effects.SensorCrossTalk effect(a = 0.5, x_0 = 1, u = time, x = time^2);
    equation
      found = {effect.y};
      exact = {time + 0.5*time^2 - 0.5};
    end SensorCrossTalk;

    model SensorHysteresis
      extends Check;
      // Up until 1, then down.
      Real u = if time < 1 then time else 2 - time;
      Real x(start = 0, fixed = true) "The same, as a state";
      Effects.SensorHysteresis effect(h = 0.02, w = 0.1, u = x);
      constant Real z_1 = 1 - exp(-1/0.1);
    equation
      der(x) = if time < 1 then 1 else -1;
      found = {effect.y};
      exact = {if time < 1 then u - 0.02*(1 - exp(-u/0.1)) else u - 0.02*(-1 + (1 + z_1)*exp(-(time - 1)/0.1))};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end SensorHysteresis;

    model SensorBacklash
      extends Check;
      Real x(start = 0, fixed = true) "A ramp, as a state";
      Effects.SensorBacklash effect(h = 0.02, w = 0.1, u = x);
      Real z = (x - effect.y)/0.02;
    equation
      der(x) = 1;
      // The integral of dz/(1 - z^4).
      found = {log((1 + z)/(1 - z))/4 + atan(z)/2};
      exact = {time/0.1};
      annotation(experiment(StopTime = 0.2, Tolerance = 1e-10));
    end SensorBacklash;

    model ConstantTorque
      extends Check;
      Rotational.Inertia body(J = 2);
      Effects.ConstantTorque effect(M = 3);
    equation
      connect(effect.flange, body.flange);
      found = {body.phi};
      exact = {3*time^2/(2*2)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ConstantTorque;

    model ExtraTorsionSpring
      extends Check;
      Rotational.Inertia body(J = 2, phi_start = 0.1);
      Effects.ExtraTorsionSpring effect(c = 200, M_0 = 4, phi_0 = 0.01);
      Real phi_rest = 0.01 - 4/200 "Where the spring is slack";
    equation
      connect(effect.flange, body.flange);
      found = {body.phi};
      exact = {phi_rest + (0.1 - phi_rest)*cos(sqrt(200/2)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ExtraTorsionSpring;

    model AddedInertia
      extends Check;
      Rotational.Inertia body(J = 2);
      Effects.AddedInertia effect(J = 1);
      Rotational.Torque drive(tau = 6);
    equation
      connect(effect.flange, body.flange);
      connect(drive.flange, body.flange);
      found = {body.phi};
      exact = {6*time^2/(2*(2 + 1))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end AddedInertia;

    model BearingDamping
      extends Check;
      Rotational.Inertia body(J = 2, w_start = 1);
      Effects.BearingDamping effect(d = 3);
    equation
      connect(effect.flange, body.flange);
      found = {body.w};
      exact = {exp(-3/2*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end BearingDamping;

    model AngleDrag
      extends Check;
      Rotational.Inertia body(J = 2, w_start = 1);
      Effects.AngleDrag effect(d = 3, side = -1, phi_lo = -1, phi_hi = 1);
    equation
      connect(effect.flange, body.flange);
      // J dw = -d (1 - phi)/2 dphi
      found = {body.w};
      exact = {1 - 3/4*(body.phi - body.phi^2/2)};
      annotation(experiment(StopTime = 0.5, Tolerance = 1e-9));
    end AngleDrag;

    model FanDrag
      extends Check;
      Rotational.Inertia body(J = 2, w_start = -1);
      Effects.FanDrag effect(k = 3);
    equation
      connect(effect.flange, body.flange);
      found = {body.w};
      exact = {-1/(1 + 3/2*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end FanDrag;

    model BearingFriction
      extends Check;
      Rotational.ConstantSpeed drive(w_0 = 1e-3);
      Effects.BearingFriction effect(M = 3, delta = 1e-5);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.tau};
      exact = {-3*(1 - exp(-1e-3*time/1e-5))};
      annotation(experiment(StopTime = 0.1, Tolerance = 1e-9));
    end BearingFriction;

    model SmoothBearingFriction
      extends Check;
      Rotational.ConstantSpeed drive(w_0 = -2);
      Effects.SmoothBearingFriction effect(M = 3, w_0 = 4);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.tau};
      exact = {3*(exp(0.5) - exp(-0.5))/(exp(0.5) + exp(-0.5))};
      annotation(experiment(StopTime = 0.1, Tolerance = 1e-9));
    end SmoothBearingFriction;

    model BearingStribeck
      extends Check;
      Rotational.ConstantSpeed drive(w_0 = -2e-3);
      Effects.BearingStribeck effect(M = 3, M_s = 2, delta = 1e-5, w_s = 3e-3);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.tau};
      exact = {(3 + 2*exp(-(2/3)^2))*(1 - exp(-2e-3*time/1e-5))};
      annotation(experiment(StopTime = 0.05, Tolerance = 1e-9));
    end BearingStribeck;

    model Cogging
      extends Check;
      Rotational.ConstantSpeed drive(w_0 = 2);
      Effects.Cogging effect(M_s = 3, M_c = 0.5, N = 4);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.tau};
      exact = {3*sin(8*time) + 0.5*cos(8*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end Cogging;

    model FreeTorqueOverAngle
      extends Check;
      // Values on a straight line make a spring.
      Rotational.Inertia body(J = 2, phi_start = 0.1);
      Effects.FreeTorqueOverAngle effect(n = 5, M = {40, 20, 0, -20, -40}, phi_lo = -0.2, phi_hi = 0.2);
    equation
      connect(effect.flange, body.flange);
      found = {body.phi};
      exact = {0.1*cos(sqrt(200/2)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeTorqueOverAngle;

    model FreeTorqueOverSpeed
      extends Check;
      Rotational.ConstantSpeed drive(w_0 = 1.3);
      Effects.FreeTorqueOverSpeed effect(n = 5, M = {0, 1, 2, 3, 4}, w_hi = 2, delta = 0.1);
    equation
      connect(effect.flange, drive.flange);
      found = {effect.tau};
      exact = {-2.6*(1 - exp(-1.3*time/0.1))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeTorqueOverSpeed;

    model TwistSpring
      extends Check;
      Rotational.Inertia body(J = 2, phi_start = -0.1);
      Rotational.Inertia other(J = 2, phi_start = 0.1);
      Effects.TwistSpring effect(c = 200, M_0 = 4);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.phi_rel};
      exact = {-4/200 + (0.2 + 4/200)*cos(sqrt(2*200/2)*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end TwistSpring;

    model TwistStiffening
      extends Check;
      // What it holds it gives back: the motion keeps its energy.
      Rotational.Fixed body;
      Rotational.Inertia other(J = 2, phi_start = 0.5);
      Effects.TwistStiffening effect(c_3 = 200);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {2*other.w^2/2};
      exact = {200*(0.5^4 - other.phi^4)/4};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end TwistStiffening;

    model TwistDamping
      extends Check;
      Rotational.Inertia body(J = 2, w_start = -1);
      Rotational.Inertia other(J = 2, w_start = 1);
      Effects.TwistDamping effect(d = 3);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.w_rel};
      exact = {2*exp(-2*3/2*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end TwistDamping;

    model Backlash
      extends Check;
      // With a spring and a damper of the same size, nothing acts within the play but for the ends.
      Rotational.ConstantSpeed body(w_0 = 1);
      Rotational.ConstantSpeed other(w_0 = 2, phi_0 = -0.5);
      Effects.Backlash effect(c = 200, d = 3, b = 0.1, phi_0 = 0.05);
      Rotational.Spring spring(c = 200);
      Rotational.Damper damper(d = 3);
      Real x = time - 0.5 - 0.05 "Twist from the middle";
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      connect(spring.flange_a, body.flange);
      connect(spring.flange_b, other.flange);
      connect(damper.flange_a, body.flange);
      connect(damper.flange_b, other.flange);
      found = {spring.tau + damper.tau + effect.tau};
      exact = {200*0.05 + (if x < -0.1 then 200*(x + 0.1) + 3 elseif x > 0.1 then 200*(x - 0.1) + 3
        elseif abs(x) > 0.09 then 3*(1 - 10*(1 - abs(x)/0.1)) else 0)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end Backlash;

    model TwistFriction
      extends Check;
      Rotational.Inertia body(J = 2, w_start = -1);
      Rotational.Inertia other(J = 2, w_start = 1);
      // As between two masses: what they lose is the work of the friction.
      Effects.TwistFriction effect(M = 1, delta = 0.01);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {other.w^2};
      exact = {1 - (effect.phi_rel - 0.01*(1 - exp(-effect.phi_rel/0.01)))/2};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end TwistFriction;

    model FreeTorqueOverTwist
      extends Check;
      Rotational.Inertia body(J = 2, w_start = -1);
      Rotational.Inertia other(J = 2, w_start = 1);
      // Values on a straight line: a torsion spring.
      Effects.FreeTorqueOverTwist effect(M = {-200, 0, 200}, n = 3, phi_lo = -1, phi_hi = 1);
      Real omega = sqrt(200);
    equation
      connect(effect.flange_a, body.flange);
      connect(effect.flange_b, other.flange);
      found = {effect.phi_rel};
      exact = {2/omega*sin(omega*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-10));
    end FreeTorqueOverTwist;

    model LeakConductance
      extends Check;
      Electrical.Ground ground;
      Electrical.Capacitor store(C = 2, v_start = 1);
      Effects.LeakConductance effect(G = 3);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      found = {store.v};
      exact = {exp(-3/2*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end LeakConductance;

    model VoltageDrop
      extends Check;
      Electrical.Ground ground;
      Electrical.Voltage store(v_0 = 10*time - 5);
      Effects.VoltageDrop effect(G = 3, V = 2);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      found = {effect.i};
      exact = {if time < 0.3 then 6 elseif time > 0.7 then -6 else -3*(10*time - 5)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end VoltageDrop;

    model DiodeDrop
      extends Check(n = 2);
      Electrical.Ground ground;
      Electrical.Voltage store(v_0 = 10*time - 5);
      Effects.DiodeDrop effect(G = 3, V = 2);
      Effects.DiodeDrop back(G = 3, V = 2, side = -1);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      connect(back.p, store.p);
      connect(back.n, store.n);
      found = {effect.i, back.i};
      exact = {if time > 0.7 then -6 else -3*(10*time - 5), if time < 0.3 then 6 else -3*(10*time - 5)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end DiodeDrop;

    model ClampDiode
      extends Check(n = 2);
      Electrical.Ground ground;
      Electrical.Voltage store(v_0 = 10*time - 5);
      Effects.ClampDiode effect(G = 3, V = 2);
      Effects.ClampDiode back(G = 3, V = 2, side = -1);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      connect(back.p, store.p);
      connect(back.n, store.n);
      found = {effect.i, back.i};
      exact = {if time > 0.7 then 3*(10*time - 7) else 0, if time < 0.3 then 3*(10*time - 3) else 0};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ClampDiode;

    model RelaxationBranch
      extends Check;
      Electrical.Ground ground;
      Electrical.Voltage store(v_0 = 4*time + 1);
      Effects.RelaxationBranch effect(C = 3, tau = 0.2);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      found = {effect.i};
      exact = {4*3*(1 - exp(-time/0.2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end RelaxationBranch;

    model InductorSaturation
      extends Check;
      Electrical.Ground ground;
      Electrical.Voltage store(v_0 = 2);
      Effects.InductorSaturation effect(a = 3);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      found = {effect.i};
      exact = {3*(2*time)^3};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end InductorSaturation;

    model SeriesLag
      extends Check;
      Electrical.Ground ground;
      Electrical.Voltage store(v_0 = 2);
      Effects.SeriesLag effect(i_host = time, tau = 0.2, tau_min = 1e-9);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      found = {effect.i};
      exact = {-0.2*(1 - exp(-time/0.2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SeriesLag;

    model OffsetCurrent
      extends Check;
      Electrical.Ground ground;
      Electrical.Capacitor store(C = 2);
      Effects.OffsetCurrent effect(I = 3);
    equation
      connect(effect.p, store.p);
      connect(store.n, ground.p);
      found = {store.v};
      exact = {3*time/2};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end OffsetCurrent;

    model FreeCurrentOverVoltage
      extends Check;
      // Values on a straight line make a conductance.
      Electrical.Ground ground;
      Electrical.Capacitor store(C = 2, v_start = 1);
      Effects.FreeCurrentOverVoltage effect(m = 5, I = {-6, -3, 0, 3, 6}, v_lo = -2, v_hi = 2);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
      connect(store.n, ground.p);
      found = {store.v};
      exact = {exp(-3/2*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeCurrentOverVoltage;

    model Voltage
      extends Check;
      Electrical.Ground ground;
      Electrical.Voltage effect(v_0 = 12 + time, R = 2);
      Electrical.Resistor load(R = 4);
    equation
      connect(effect.p, load.p);
      connect(effect.n, load.n);
      connect(effect.n, ground.p);
      found = {load.v};
      exact = {(12 + time)*4/(4 + 2)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end Voltage;

    model Capacitor
      extends Check;
      Electrical.Ground ground;
      Electrical.Capacitor effect(C = 2, R = 3);
      Electrical.Current supply(i = 4);
    equation
      connect(effect.p, supply.p);
      connect(effect.n, supply.n);
      connect(effect.n, ground.p);
      found = {effect.v};
      exact = {4*(3 + time/2)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end Capacitor;

    model Inductor
      extends Check;
      Electrical.Ground ground;
      Electrical.Inductor effect(L = 2, R = 3);
      Electrical.Voltage supply(v_0 = 6);
    equation
      connect(effect.p, supply.p);
      connect(effect.n, supply.n);
      connect(effect.n, ground.p);
      found = {effect.i};
      exact = {2*(1 - exp(-3*time/2))};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end Inductor;

    model ConstantHeatFlow
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Effects.ConstantHeatFlow effect(P = 30);
    equation
      connect(effect.port, body.port);
      found = {body.T};
      exact = {400 + 3*time};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end ConstantHeatFlow;

    model HeatLoss
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Effects.HeatLoss effect(G = 3, T_0 = 300);
    equation
      connect(effect.port, body.port);
      found = {body.T};
      exact = {300 + 100*exp(-0.3*time)};
      annotation(experiment(StopTime = 5, Tolerance = 1e-9));
    end HeatLoss;

    model ConvectionLoss
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Effects.ConvectionLoss effect(k = 3, T_0 = 300, dT_min = 0);
    equation
      connect(effect.port, body.port);
      found = {body.T};
      exact = {300 + (100^(-0.25) + 3/10*time/4)^(-4)};
      annotation(experiment(StopTime = 5, Tolerance = 1e-9));
    end ConvectionLoss;

    model RadiationLoss
      extends Check;
      // To surroundings at 0 K.
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Effects.RadiationLoss effect(A = 10, T_0 = 0);
    equation
      connect(effect.port, body.port);
      found = {body.T};
      exact = {(400^(-3) + 3*5.670374419e-8*10/10*time)^(-1/3)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end RadiationLoss;

    model HeatLeak
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Thermal.HeatCapacity other(C = 5, T_start = 300);
      Effects.HeatLeak effect(G = 3);
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, other.port);
      found = {effect.dT};
      exact = {100*exp(-3*(1/10 + 1/5)*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end HeatLeak;

    model ConvectionExchange
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Thermal.HeatCapacity other(C = 5, T_start = 300);
      Effects.ConvectionExchange effect(k = 3, dT_min = 0);
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, other.port);
      found = {effect.dT};
      exact = {(100^(-0.25) + 3*(1/10 + 1/5)*time/4)^(-4)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end ConvectionExchange;

    model FreeHeatExchange
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Thermal.HeatCapacity other(C = 5, T_start = 300);
      // Knots on a straight line.
      Effects.FreeHeatExchange effect(Q = 60*{0, 1, 2, 3, 4, 5, 6}, dT_hi = 120);
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, other.port);
      found = {effect.dT};
      exact = {100*exp(-3*(1/10 + 1/5)*time)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end FreeHeatExchange;

    model RadiationExchange
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Thermal.Ambient other(T = 0);
      Effects.RadiationExchange effect(A = 10);
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, other.port);
      found = {body.T};
      exact = {(400^(-3) + 3*5.670374419e-8*10/10*time)^(-1/3)};
      annotation(experiment(StopTime = 2, Tolerance = 1e-9));
    end RadiationExchange;

    model SecondHeatStore
      extends Check;
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Thermal.HeatSource heater(Q_flow = 30);
      Effects.SecondHeatStore effect(C = 5, tau = 0.3);
      Real rate = (1 + 5/10)/0.3 "At which the two come together";
    equation
      connect(effect.port, body.port);
      connect(heater.port, body.port);
      found = {body.T};
      exact = {400 + 3*time - 5/10/0.3*3/rate*(time - (1 - exp(-rate*time))/rate)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end SecondHeatStore;

    model FreeHeatFlowOverTemperature
      extends Check;
      // Values on a straight line make a linear loss.
      Thermal.HeatCapacity body(C = 10, T_start = 400);
      Effects.FreeHeatFlowOverTemperature effect(n = 5, P = {300, 0, -300, -600, -900}, T_lo = 200, T_hi = 600);
    equation
      connect(effect.port, body.port);
      found = {body.T};
      exact = {300 + 100*exp(-0.3*time)};
      annotation(experiment(StopTime = 1, Tolerance = 1e-9));
    end FreeHeatFlowOverTemperature;
  end Present;

  model Base "A piston, a pilot, a seal at an edge, and a working volume"
    Translational.StopMass         spool(m = 0.03, s_max = 3.5e-3, t_no_start = 1);
    Translational.Spring           spring(c = 3e3, f_0 = 8);
    Translational.Fixed            housing;
    Seals.FlowSeal                 seal(contact = Seals.Contact.CloseToOpen, s_ce = 1.8e-3, F_ce = 1.2, w = 0.16e-3,
                                     C = 2e-8, w_t = 0.12e-3, redeclare model FrictionLaw = Rubber);
    Pneumatics.Source              supply(p = 7e5);
    Pneumatics.Ambient             ambient;
    Signals.SwitchSignal           switch(t_off = 0.02);
    Signals.PilotValve             pilot(on = switch.on, t_delay = 1e-3, tau = 1e-3);
    Pneumatics.VariableRestriction fill(C = 5e-10, x = pilot.x);
    Pneumatics.VariableRestriction vent(C = 5e-10, x = 1 - pilot.x);
    Pneumatics.CylinderChamber     chamber(A = 2e-4, V_dead = 1e-6);
    Pneumatics.Volume              work(V_0 = 20e-6);
    Pneumatics.Restriction         line(C = 2e-8);
    Pneumatics.Volume              tank(V_0 = 10e-6);
    Units.Position         s   = spool.s;
    Units.Velocity         v   = spool.v;
    Units.AbsolutePressure p   = chamber.p;
    Units.AbsolutePressure p_2 = work.p;

    model Rubber = Friction.StribeckDwellPressure(F_Coulomb = 4, k_C = 0.2e-5, F_Stribeck_max = 10, k_S = 0.12e-5,
        tau = 1500, n = 0.3, F_prop = 6, f_exp = 6);
  equation
    connect(chamber.flange, spool.flange);
    connect(spring.flange_a, housing.flange);
    connect(spring.flange_b, spool.flange);
    connect(seal.spool, spool.seals);
    connect(supply.port, fill.port_a);
    connect(fill.port_b, chamber.port);
    connect(vent.port_a, chamber.port);
    connect(vent.port_b, ambient.port);
    connect(supply.port, seal.port_a);
    connect(seal.port_b, work.port);
    connect(work.port, line.port_a);
    connect(line.port_b, tank.port);

    annotation(experiment(StopTime = 0.08, Interval = 1e-4, Tolerance = 1e-9));
  end Base;

  model BesideStores "The same, and two stores that become equal, twice"
    extends Base;
    Store upper(C = 2);
    Store lower(e_start = 0);
    Store upper_2(C = 2);
    Store lower_2(e_start = 0);
    Effects.LinearBypass channel(k = 20);
    Effects.LinearBypass channel_2(k = 20);
    Real observed = lower.e;
    Real twin     = lower_2.e;
  equation
    connect(channel.port_a, upper.port);      connect(channel.port_b, lower.port);
    connect(channel_2.port_a, upper_2.port);  connect(channel_2.port_b, lower_2.port);
  end BesideStores;

  model BesideTanks "The same, and two tanks"
    extends Base;
    Tanks.Tank   upper(h_start = 2);
    Tanks.Tank   lower(h_start = 0.1);
    Tanks.Outlet outlet;
    Tanks.Outlet drainage;
    Tanks.Drain  drain;
    Units.Position observed = lower.h + 1e3*upper.h;
  equation
    connect(outlet.port_a, upper.port);    connect(outlet.port_b, lower.port);
    connect(drainage.port_a, lower.port);  connect(drainage.port_b, drain.port);
  end BesideTanks;

  model BesideShafts "The same, and an elastic shaft, twice"
    extends Base;
    Rotational.Torque  drive(tau = 0.1);
    Rotational.Inertia motor(J = 1e-3);
    Rotational.Spring  shaft(c = 20);
    Rotational.Inertia load(J = 2e-3, phi_start = 0.01);
    Rotational.Torque  drive_2(tau = 0.1);
    Rotational.Inertia motor_2(J = 1e-3);
    Rotational.Spring  shaft_2(c = 20);
    Rotational.Inertia load_2(J = 2e-3, phi_start = 0.01);
    Units.Angle observed = load.phi;
    Units.Angle twin     = load_2.phi;
  equation
    connect(drive.flange, motor.flange);        connect(drive_2.flange, motor_2.flange);
    connect(motor.flange, shaft.flange_a);      connect(motor_2.flange, shaft_2.flange_a);
    connect(shaft.flange_b, load.flange);       connect(shaft_2.flange_b, load_2.flange);
  end BesideShafts;

  model BesideCircuit "The same, and a circuit, twice"
    extends Base;
    Electrical.Ground    ground;
    Electrical.Voltage   battery(v_0 = 2);
    Electrical.Resistor  wire(R = 10);
    Electrical.Capacitor store(C = 1e-3, v_start = 0.1);
    Electrical.Voltage   battery_2(v_0 = 2);
    Electrical.Resistor  wire_2(R = 10);
    Electrical.Capacitor store_2(C = 1e-3, v_start = 0.1);
    Units.Voltage observed = store.v;
    Units.Voltage twin     = store_2.v;
  equation
    connect(battery.p, wire.p);  connect(battery_2.p, wire_2.p);
    connect(wire.n, store.p);   connect(wire_2.n, store_2.p);
    connect(store.n, battery.n); connect(store_2.n, battery_2.n);
    connect(ground.p, battery.n); connect(ground.p, battery_2.n);
  end BesideCircuit;

  model BesideBodies "The same, and two bodies, twice"
    extends Base;
    Thermal.HeatCapacity body(C = 2, T_start = 310);
    Thermal.Conductance  wall(G = 10);
    Thermal.HeatCapacity cover(C = 1, T_start = 290);
    Thermal.HeatCapacity body_2(C = 2, T_start = 310);
    Thermal.Conductance  wall_2(G = 10);
    Thermal.HeatCapacity cover_2(C = 1, T_start = 290);
    Units.Temperature observed = body.T;
    Units.Temperature twin     = body_2.T;
  equation
    connect(body.port, wall.port_a);   connect(body_2.port, wall_2.port_a);
    connect(wall.port_b, cover.port);  connect(wall_2.port_b, cover_2.port);
  end BesideBodies;

  package Absent
    model ConstantForce
      extends Base;
      Effects.ConstantForce effect;
    equation
      connect(effect.flange, spool.flange);
    end ConstantForce;

    model ExtraSpring
      extends Base;
      Effects.ExtraSpring effect;
    equation
      connect(effect.flange, spool.flange);
    end ExtraSpring;

    model StiffeningSpring
      extends Base;
      Effects.StiffeningSpring effect;
    equation
      connect(effect.flange, spool.flange);
    end StiffeningSpring;

    model Overflow
      extends BesideTanks;
      Effects.Overflow effect(h_max = 0.5);
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
    end Overflow;

    model LaminarOutflow
      extends BesideTanks;
      Effects.LaminarOutflow effect;
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
    end LaminarOutflow;

    model ViscousDrag
      extends Base;
      Effects.ViscousDrag effect;
    equation
      connect(effect.flange, spool.flange);
    end ViscousDrag;

    model PositionDrag
      extends Base;
      Effects.PositionDrag effect;
    equation
      connect(effect.flange, spool.flange);
    end PositionDrag;

    model DryDrag
      extends Base;
      Effects.DryDrag effect;
    equation
      connect(effect.flange, spool.flange);
    end DryDrag;

    model SmoothDrag
      extends Base;
      Effects.SmoothDrag effect;
    equation
      connect(effect.flange, spool.flange);
    end SmoothDrag;

    model QuadraticDrag
      extends Base;
      Effects.QuadraticDrag effect;
    equation
      connect(effect.flange, spool.flange);
    end QuadraticDrag;

    model DirectionalDrag
      extends Base;
      Effects.DirectionalDrag effect;
    equation
      connect(effect.flange, spool.flange);
    end DirectionalDrag;

    model AddedMass
      extends Base;
      Effects.AddedMass effect;
    equation
      connect(effect.flange, spool.flange);
    end AddedMass;

    model BellForce
      extends Base;
      Effects.BellForce effect(s_0 = 1e-3);
    equation
      connect(effect.flange, spool.flange);
    end BellForce;

    model Detent
      extends Base;
      Effects.Detent effect(s_0 = 1e-3);
    equation
      connect(effect.flange, spool.flange);
    end Detent;

    model MagneticForce
      extends Base;
      Effects.MagneticForce effect(s_lo = 0, s_hi = 3.5e-3);
    equation
      connect(effect.flange, spool.flange);
    end MagneticForce;

    model EndCushion
      extends Base;
      Effects.EndCushion effect(s_lo = 0, s_hi = 3.5e-3);
    equation
      connect(effect.flange, spool.flange);
    end EndCushion;

    model OneWayCushion
      extends Base;
      Effects.OneWayCushion effect(s_lo = 0, s_hi = 3.5e-3);
    equation
      connect(effect.flange, spool.flange);
    end OneWayCushion;

    partial model BesideMasses "The valve beside two masses with a spring between them"
      extends Base;
      Translational.Mass   near(m = 1, v_start = 1);
      Translational.Mass   far(m = 2);
      Translational.Spring between(c = 4e4);
      Translational.Mass   near_twin(m = 1, v_start = 1);
      Translational.Mass   far_twin(m = 2);
      Translational.Spring between_twin(c = 4e4);
      Real observed = near.v;
      Real twin = near_twin.v;
    equation
      connect(near.flange, between.flange_a);
      connect(between.flange_b, far.flange);
      connect(near_twin.flange, between_twin.flange_a);
      connect(between_twin.flange_b, far_twin.flange);
    end BesideMasses;

    model StretchSpring
      extends BesideMasses;
      Effects.StretchSpring effect;
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchSpring;

    model StretchStiffening
      extends BesideMasses;
      Effects.StretchStiffening effect(l_0 = 1e-3);
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchStiffening;

    model StretchDamping
      extends BesideMasses;
      Effects.StretchDamping effect;
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchDamping;

    model StretchOrifice
      extends BesideMasses;
      Effects.StretchOrifice effect;
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchOrifice;

    model StretchFriction
      extends BesideMasses;
      Effects.StretchFriction effect(delta = 1e-6);
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchFriction;

    model StretchStop
      extends BesideMasses;
      Effects.StretchStop effect(l_0 = 1e-3, w = 1e-4);
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchStop;

    model StretchPlay
      extends BesideMasses;
      Effects.StretchPlay effect(b = 1e-5);
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end StretchPlay;

    model FreeForceOverStretch
      extends BesideMasses;
      Effects.FreeForceOverStretch effect(s_lo = -3.5e-3, s_hi = 3.5e-3);
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end FreeForceOverStretch;

    model FreeForceOverStretchRate
      extends BesideMasses;
      Effects.FreeForceOverStretchRate effect;
    equation
      connect(effect.flange_a, near.flange);
      connect(effect.flange_b, far.flange);
    end FreeForceOverStretchRate;

    model CompliantStop
      extends Base;
      Effects.CompliantStop effect(s_lo = 0, s_hi = 3.5e-3);
    equation
      connect(effect.flange, spool.flange);
    end CompliantStop;

    model DahlPresliding
      extends Base;
      Effects.DahlPresliding effect;
    equation
      connect(effect.flange, spool.flange);
    end DahlPresliding;

    model LuGrePresliding
      extends Base;
      Effects.LuGrePresliding effect;
    equation
      connect(effect.flange, spool.flange);
    end LuGrePresliding;

    model BoucWenHysteresis
      extends Base;
      Effects.BoucWenHysteresis effect;
    equation
      connect(effect.flange, spool.flange);
    end BoucWenHysteresis;

    model FreeForceOverPosition
      extends Base;
      Effects.FreeForceOverPosition effect(s_lo = 0, s_hi = 3.5e-3);
    equation
      connect(effect.flange, spool.flange);
    end FreeForceOverPosition;

    model CoulombDrag
      extends Base;
      Effects.CoulombDrag effect;
    equation
      connect(effect.spool, spool.seals);
    end CoulombDrag;

    model PositionFriction
      extends Base;
      Effects.PositionFriction effect(s_0 = 1e-3);
    equation
      connect(effect.spool, spool.seals);
    end PositionFriction;

    model FreeForceOverVelocity
      extends Base;
      Effects.FreeForceOverVelocity effect;
    equation
      connect(effect.spool, spool.seals);
    end FreeForceOverVelocity;

    model FlowForceEdge
      extends Base;
      Effects.FlowForceEdge effect(m_flow = seal.gap.m_flow, s_ce = seal.s_ce);
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end FlowForceEdge;

    model FlowForceJet
      extends Base;
      Effects.FlowForceJet effect(m_flow = seal.gap.m_flow);
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end FlowForceJet;

    model FlowForcePressure
      extends Base;
      Effects.FlowForcePressure effect(opening = seal.gap.opening);
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end FlowForcePressure;

    model FlowForceStream
      extends Base;
      Effects.FlowForceStream effect(m_flow = seal.gap.m_flow);
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end FlowForceStream;

    model SealPressureForce
      extends Base;
      Effects.SealPressureForce effect;
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end SealPressureForce;

    model SealPressureFriction
      extends Base;
      Effects.SealPressureFriction effect;
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end SealPressureFriction;

    model LeakLaminar
      extends Base;
      Effects.LeakLaminar effect;
    equation
      connect(effect.port_a, chamber.port);  connect(effect.port_b, ambient.port);
    end LeakLaminar;

    model LeakPorous
      extends Base;
      Effects.LeakPorous effect;
    equation
      connect(effect.port_a, chamber.port);  connect(effect.port_b, ambient.port);
    end LeakPorous;

    model LeakOrifice
      extends Base;
      Effects.LeakOrifice effect;
    equation
      connect(effect.port_a, chamber.port);  connect(effect.port_b, ambient.port);
    end LeakOrifice;

    model FreeFlow
      extends Base;
      Effects.FreeFlow effect(dp_hi = 6e5);
    equation
      connect(effect.port_a, chamber.port);  connect(effect.port_b, ambient.port);
    end FreeFlow;

    model LineInertia
      extends Base;
      Effects.LineInertia effect(m_host = line.m_flow);
    equation
      connect(effect.port_a, line.port_a);
      connect(effect.port_b, line.port_b);
    end LineInertia;

    model LineLag
      extends Base;
      Effects.LineLag effect(m_host = line.m_flow);
    equation
      connect(effect.port_a, line.port_a);
      connect(effect.port_b, line.port_b);
    end LineLag;

    model DeadVolume
      extends Base;
      Effects.DeadVolume effect;
    equation
      connect(effect.port, chamber.port);
    end DeadVolume;

    model PolytropicStorage
      extends Base;
      Effects.PolytropicStorage effect(V = chamber.V);
    equation
      connect(effect.port, chamber.port);
    end PolytropicStorage;

    model WallHeat
      extends Base;
      Effects.WallHeat effect(V = chamber.V);
    equation
      connect(effect.port, chamber.port);
    end WallHeat;

    model ConstantOutflow
      extends BesideStores;
      Effects.ConstantOutflow effect;
    equation
      connect(effect.port, lower.port);
    end ConstantOutflow;

    model LinearOutflow
      extends BesideStores;
      Effects.LinearOutflow effect;
    equation
      connect(effect.port, lower.port);
    end LinearOutflow;

    model QuadraticOutflow
      extends BesideStores;
      Effects.QuadraticOutflow effect;
    equation
      connect(effect.port, lower.port);
    end QuadraticOutflow;

    model RootOutflow
      extends BesideStores;
      Effects.RootOutflow effect;
    equation
      connect(effect.port, lower.port);
    end RootOutflow;

    model FreeOutflow
      extends BesideStores;
      Effects.FreeOutflow effect;
    equation
      connect(effect.port, lower.port);
    end FreeOutflow;

    model LinearBypass
      extends BesideStores;
      Effects.LinearBypass effect;
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
    end LinearBypass;

    model QuadraticBypass
      extends BesideStores;
      Effects.QuadraticBypass effect;
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
    end QuadraticBypass;

    model RootBypass
      extends BesideStores;
      Effects.RootBypass effect;
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
    end RootBypass;

    model FreeBypass
      extends BesideStores;
      Effects.FreeBypass effect;
    equation
      connect(effect.port_a, upper.port);  connect(effect.port_b, lower.port);
    end FreeBypass;

    model SensorDrift
      extends Base;
      Effects.SensorDrift effect(u = s);
    end SensorDrift;

    model SensorOffset
      extends Base;
      Effects.SensorOffset effect(u = s);
    end SensorOffset;

    model LinearVariation
      extends Base;
      Effects.LinearVariation effect(x = s, x_hi = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end LinearVariation;

    model OtherStart
      extends Base;
      Effects.OtherStart effect;
      annotation(__mocc(starts = "spool.s = effect.d"));
    end OtherStart;

    model OtherValue
      extends Base;
      Effects.OtherValue effect;
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end OtherValue;

    model PowerVariation
      extends Base;
      Effects.PowerVariation effect(x = s, x_0 = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end PowerVariation;

    model ExponentialVariation
      extends Base;
      Effects.ExponentialVariation effect(x = v);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end ExponentialVariation;

    model DirectionalVariation
      extends Base;
      Effects.DirectionalVariation effect(x = v);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end DirectionalVariation;

    model RateVariation
      extends Base;
      Effects.RateVariation effect(x = der(s), x_0 = 1e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end RateVariation;

    model ArrheniusVariation
      extends Base;
      Effects.ArrheniusVariation effect(x = s, x_0 = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end ArrheniusVariation;

    model SaturationVariation
      extends Base;
      Effects.SaturationVariation effect(x = s, x_0 = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end SaturationVariation;

    model HarmonicVariation
      extends Base;
      Effects.HarmonicVariation effect(x = s/1e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end HarmonicVariation;

    model AccumulationVariation
      extends Base;
      Effects.AccumulationVariation effect(x = s, x_0 = 3.5e-3, T = 0.1);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end AccumulationVariation;

    model ExposureVariation
      extends Base;
      Effects.ExposureVariation effect(x = s, x_0 = 3.5e-3, T = 0.1);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end ExposureVariation;

    model WaveVariation
      extends Base;
      Effects.WaveVariation effect(x = s, L = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end WaveVariation;

    model OptimumVariation
      extends Base;
      Effects.OptimumVariation effect(x = s, x_hi = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end OptimumVariation;

    model StepVariation
      extends Base;
      Effects.StepVariation effect(x = s, x_s = 1e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end StepVariation;

    model LaggedVariation
      extends Base;
      Effects.LaggedVariation effect(x = s, x_hi = 3.5e-3, tau = 0.01);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end LaggedVariation;

    model HeatingVariation
      extends Base;
      Effects.HeatingVariation effect(x = s, x_0 = 3.5e-3, tau = 0.01);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end HeatingVariation;

    model FreeVariation
      extends Base;
      Effects.FreeVariation effect(x = s, x_hi = 3.5e-3);
      annotation(__mocc(varies = "spring.c = effect.factor"));
    end FreeVariation;

    partial model Equation "The valve beside a state with an equation of its own"
      extends Base;
      Real angle(start = 0, fixed = true, unit = "rad");
      Real observed(start = 1, fixed = true);
      Real twin(start = 1, fixed = true);
    equation
      der(angle) = 100*observed;
      der(observed) = -10*observed;
      der(twin) = -10*twin;
    end Equation;

    model ConstantTerm
      extends Equation;
      Effects.ConstantTerm effect;
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end ConstantTerm;

    model LateTerm
      extends Equation;
      Effects.LateTerm effect(x = -10*observed, T_min = 1e-4);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end LateTerm;

    model RelaxationTerm
      extends Equation;
      Effects.RelaxationTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end RelaxationTerm;

    model HysteresisTerm
      extends Equation;
      Effects.HysteresisTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end HysteresisTerm;

    model StoredTerm
      extends Equation;
      Effects.StoredTerm effect(x = -10*observed, T_min = 1e-4);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end StoredTerm;

    model LinearTerm
      extends Equation;
      Effects.LinearTerm effect(x = s);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end LinearTerm;

    model QuadraticTerm
      extends Equation;
      Effects.QuadraticTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end QuadraticTerm;

    model SquareTerm
      extends Equation;
      Effects.SquareTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end SquareTerm;

    model CubicTerm
      extends Equation;
      Effects.CubicTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end CubicTerm;

    model DryTerm
      extends Equation;
      Effects.DryTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end DryTerm;

    model StribeckTerm
      extends Equation;
      Effects.StribeckTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end StribeckTerm;

    model SmoothStribeckTerm
      extends Equation;
      Effects.SmoothStribeckTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end SmoothStribeckTerm;

    model SmoothDryTerm
      extends Equation;
      Effects.SmoothDryTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end SmoothDryTerm;

    model PeriodicTerm
      extends Equation;
      Effects.PeriodicTerm effect(x = angle);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end PeriodicTerm;

    model ProductTerm
      extends Equation;
      Effects.ProductTerm effect(x = s, y = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end ProductTerm;

    model SaturatingTerm
      extends Equation;
      Effects.SaturatingTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end SaturatingTerm;

    model MonodTerm
      extends Equation;
      Effects.MonodTerm effect(x = s, y = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end MonodTerm;

    model FreeTerm
      extends Equation;
      Effects.FreeTerm effect(x = s, x_hi = 3.5e-3);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end FreeTerm;

    model ExchangeTerm
      extends Equation;
      Effects.ExchangeTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end ExchangeTerm;

    model RadiationTerm
      extends Equation(observed(unit = "K"));
      Effects.RadiationTerm effect(x = observed);
      annotation(__mocc(adds = "der(observed) = effect.term"));
    end RadiationTerm;

    partial model Driven "The valve beside an input that is integrated"
      extends Base;
      input Real u(start = 2);
      Real observed(start = 0, fixed = true);
      Real twin(start = 0, fixed = true);
    equation
      der(observed) = u;
      der(twin) = 2;
    end Driven;

    model ActuatorGain
      extends Driven;
      Effects.ActuatorGain effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorGain;

    model ActuatorOffset
      extends Driven;
      Effects.ActuatorOffset effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorOffset;

    model ActuatorLag
      extends Base;
      Effects.ActuatorLag effect(u = s, T_min = 1e-5);
    end ActuatorLag;

    model ActuatorEmptyStore
      extends Base;
      Effects.ActuatorEmptyStore effect(u = s, T_min = 1e-5);
    end ActuatorEmptyStore;

    model ActuatorPartialLag
      extends Base;
      Effects.ActuatorPartialLag effect(u = s);
    end ActuatorPartialLag;

    model ActuatorRateLimit
      extends Base;
      Effects.ActuatorRateLimit effect(u = s, T_min = 1e-5);
    end ActuatorRateLimit;

    model ActuatorDelay
      extends Driven;
      Effects.ActuatorDelay effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorDelay;

    model ActuatorHysteresis
      extends Base;
      Effects.ActuatorHysteresis effect(u = s, w = 1e-4);
    end ActuatorHysteresis;

    model ActuatorBacklash
      extends Base;
      Effects.ActuatorBacklash effect(u = s, w = 1e-4);
    end ActuatorBacklash;

    model FreeActuator
      extends Driven;
      Effects.FreeActuator effect(u = u, u_lo = 2, u_hi = 3);
      annotation(__mocc(through = "u = effect.y"));
    end FreeActuator;

    model ActuatorSaturation
      extends Driven;
      Effects.ActuatorSaturation effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorSaturation;

    model ActuatorTanh
      extends Driven;
      Effects.ActuatorTanh effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorTanh;

    model SensorTanh
      extends Base;
      Effects.SensorTanh effect(u = v);
    end SensorTanh;

    model SensorSaturation
      extends Base;
      Effects.SensorSaturation effect(u = v);
    end SensorSaturation;

    model ActuatorLimit
      extends Driven;
      Effects.ActuatorLimit effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorLimit;

    model ActuatorUpperLimit
      extends Driven;
      Effects.ActuatorUpperLimit effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorUpperLimit;

    model ActuatorLowerLimit
      extends Driven;
      Effects.ActuatorLowerLimit effect(u = u, y_min = 3);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorLowerLimit;

    model SensorLimit
      extends Base;
      Effects.SensorLimit effect(u = v, y_max = 1e-3);
    end SensorLimit;

    model ActuatorDeadZone
      extends Driven;
      Effects.ActuatorDeadZone effect(u = u);
      annotation(__mocc(through = "u = effect.y"));
    end ActuatorDeadZone;

    model FreeSensor
      extends Base;
      Effects.FreeSensor effect(u = s, u_lo = 0, u_hi = 3.5e-3);
    end FreeSensor;

    model SensorGain
      extends Base;
      Effects.SensorGain effect(u = s);
    end SensorGain;

    model SensorGainFromZero
      extends Base;
      Effects.SensorGainFromZero effect(u = s, u_0 = 1e-3);
    end SensorGainFromZero;

    model SensorMagnitude
      extends Base;
      Effects.SensorMagnitude effect(u = v);
    end SensorMagnitude;

    model SensorLag
      extends Base;
      Effects.SensorLag effect(u = s);
    end SensorLag;

    model SensorTimeConstant
      extends Base;
      Effects.SensorTimeConstant effect(u = s, T_min = 1e-5);
    end SensorTimeConstant;

    model SensorDeadTime
      extends Base;
      Effects.SensorDeadTime effect(u = s, T_min = 1e-5);
    end SensorDeadTime;

    model SensorDelay
      extends Base;
      Effects.SensorDelay effect(u = s);
    end SensorDelay;

    model SensorCrossTalk
      extends Base;
      Effects.SensorCrossTalk effect(u = s, x = p);
    end SensorCrossTalk;

    model SensorHysteresis
      extends Base;
      Effects.SensorHysteresis effect(u = s, w = 1e-4);
    end SensorHysteresis;

    model SensorBacklash
      extends Base;
      Effects.SensorBacklash effect(u = s, w = 1e-4);
    end SensorBacklash;

    model DirectionalFriction
      extends Base;
      Effects.DirectionalFriction effect;
    equation
      connect(effect.spool, spool.seals);
    end DirectionalFriction;

    model DirectionalSealFriction
      extends Base;
      Effects.DirectionalSealFriction effect(F = spool.seals.f_slide);
    equation
      connect(effect.seals, spool.seals);
    end DirectionalSealFriction;

    model FreeLeakOverPosition
      extends Base;
      Effects.FreeLeakOverPosition effect(s_lo = 0, s_hi = 3.5e-3);
    equation
      connect(effect.spool, seal.spool);  connect(effect.port_a, seal.port_a);  connect(effect.port_b, seal.port_b);
    end FreeLeakOverPosition;

    model PilotValve
      extends Base;
    end PilotValve;

    model Restriction
      extends Base(line(blocked = 0));
    end Restriction;

    model VariableRestriction
      extends Base(fill(blocked = 0));
    end VariableRestriction;

    model Source
      extends Base(supply(has_line = true));
    end Source;

    model ConstantTorque
      extends BesideShafts;
      Effects.ConstantTorque effect;
    equation
      connect(effect.flange, load.flange);
    end ConstantTorque;

    model ExtraTorsionSpring
      extends BesideShafts;
      Effects.ExtraTorsionSpring effect;
    equation
      connect(effect.flange, load.flange);
    end ExtraTorsionSpring;

    model AddedInertia
      extends BesideShafts;
      Effects.AddedInertia effect;
    equation
      connect(effect.flange, load.flange);
    end AddedInertia;

    model BearingDamping
      extends BesideShafts;
      Effects.BearingDamping effect;
    equation
      connect(effect.flange, load.flange);
    end BearingDamping;

    model AngleDrag
      extends BesideShafts;
      Effects.AngleDrag effect;
    equation
      connect(effect.flange, load.flange);
    end AngleDrag;

    model FanDrag
      extends BesideShafts;
      Effects.FanDrag effect;
    equation
      connect(effect.flange, load.flange);
    end FanDrag;

    model BearingFriction
      extends BesideShafts;
      Effects.BearingFriction effect(delta = 0.01);
    equation
      connect(effect.flange, load.flange);
    end BearingFriction;

    model SmoothBearingFriction
      extends BesideShafts;
      Effects.SmoothBearingFriction effect;
    equation
      connect(effect.flange, load.flange);
    end SmoothBearingFriction;

    model BearingStribeck
      extends BesideShafts;
      Effects.BearingStribeck effect(delta = 0.01);
    equation
      connect(effect.flange, load.flange);
    end BearingStribeck;

    model Cogging
      extends BesideShafts;
      Effects.Cogging effect(N = 3);
    equation
      connect(effect.flange, load.flange);
    end Cogging;

    model FreeTorqueOverAngle
      extends BesideShafts;
      Effects.FreeTorqueOverAngle effect;
    equation
      connect(effect.flange, load.flange);
    end FreeTorqueOverAngle;

    model FreeTorqueOverSpeed
      extends BesideShafts;
      Effects.FreeTorqueOverSpeed effect(w_hi = 50);
    equation
      connect(effect.flange, load.flange);
    end FreeTorqueOverSpeed;

    model TwistSpring
      extends BesideShafts;
      Effects.TwistSpring effect;
    equation
      connect(effect.flange_a, motor.flange);
      connect(effect.flange_b, load.flange);
    end TwistSpring;

    model TwistStiffening
      extends BesideShafts;
      Effects.TwistStiffening effect;
    equation
      connect(effect.flange_a, motor.flange);
      connect(effect.flange_b, load.flange);
    end TwistStiffening;

    model TwistDamping
      extends BesideShafts;
      Effects.TwistDamping effect;
    equation
      connect(effect.flange_a, motor.flange);
      connect(effect.flange_b, load.flange);
    end TwistDamping;

    model Backlash
      extends BesideShafts;
      Effects.Backlash effect(b = 1e-3);
    equation
      connect(effect.flange_a, motor.flange);
      connect(effect.flange_b, load.flange);
    end Backlash;

    model TwistFriction
      extends BesideShafts;
      Effects.TwistFriction effect(delta = 1e-5);
    equation
      connect(effect.flange_a, motor.flange);
      connect(effect.flange_b, load.flange);
    end TwistFriction;

    model FreeTorqueOverTwist
      extends BesideShafts;
      Effects.FreeTorqueOverTwist effect;
    equation
      connect(effect.flange_a, motor.flange);
      connect(effect.flange_b, load.flange);
    end FreeTorqueOverTwist;

    model LeakConductance
      extends BesideCircuit;
      Effects.LeakConductance effect;
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end LeakConductance;

    model VoltageDrop
      extends BesideCircuit;
      Effects.VoltageDrop effect;
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end VoltageDrop;

    model DiodeDrop
      extends BesideCircuit;
      Effects.DiodeDrop effect;
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end DiodeDrop;

    model ClampDiode
      extends BesideCircuit;
      Effects.ClampDiode effect(V = 0.2);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end ClampDiode;

    model RelaxationBranch
      extends BesideCircuit;
      Effects.RelaxationBranch effect(tau = 0.01);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end RelaxationBranch;

    model InductorSaturation
      extends BesideCircuit;
      Effects.InductorSaturation effect;
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end InductorSaturation;

    model SeriesLag
      extends BesideCircuit;
      Effects.SeriesLag effect(i_host = store.i, tau_min = 1e-6);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end SeriesLag;

    model FreeCurrentOverVoltage
      extends BesideCircuit;
      Effects.FreeCurrentOverVoltage effect(v_lo = 0, v_hi = 2);
    equation
      connect(effect.p, store.p);
      connect(effect.n, store.n);
    end FreeCurrentOverVoltage;

    model OffsetCurrent
      extends BesideCircuit;
      Effects.OffsetCurrent effect;
    equation
      connect(effect.p, store.p);
    end OffsetCurrent;

    model ConstantHeatFlow
      extends BesideBodies;
      Effects.ConstantHeatFlow effect;
    equation
      connect(effect.port, body.port);
    end ConstantHeatFlow;

    model HeatLoss
      extends BesideBodies;
      Effects.HeatLoss effect;
    equation
      connect(effect.port, body.port);
    end HeatLoss;

    model ConvectionLoss
      extends BesideBodies;
      Effects.ConvectionLoss effect;
    equation
      connect(effect.port, body.port);
    end ConvectionLoss;

    model RadiationLoss
      extends BesideBodies;
      Effects.RadiationLoss effect;
    equation
      connect(effect.port, body.port);
    end RadiationLoss;

    model SecondHeatStore
      extends BesideBodies;
      Effects.SecondHeatStore effect(tau = 0.01);
    equation
      connect(effect.port, body.port);
    end SecondHeatStore;

    model FreeHeatFlowOverTemperature
      extends BesideBodies;
      Effects.FreeHeatFlowOverTemperature effect(T_lo = 305, T_hi = 310);
    equation
      connect(effect.port, body.port);
    end FreeHeatFlowOverTemperature;

    model HeatLeak
      extends BesideBodies;
      Effects.HeatLeak effect;
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, cover.port);
    end HeatLeak;

    model ConvectionExchange
      extends BesideBodies;
      Effects.ConvectionExchange effect;
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, cover.port);
    end ConvectionExchange;

    model FreeHeatExchange
      extends BesideBodies;
      Effects.FreeHeatExchange effect(dT_lo = 12, dT_hi = 20);
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, cover.port);
    end FreeHeatExchange;

    model RadiationExchange
      extends BesideBodies;
      Effects.RadiationExchange effect;
    equation
      connect(effect.port_a, body.port);
      connect(effect.port_b, cover.port);
    end RadiationExchange;

    model Voltage
      extends Base;
      Electrical.Voltage effect(v_0 = 3);
      Electrical.Voltage battery(v_0 = 1);
      Electrical.Resistor load(R = 10);
      Electrical.Ground ground;
      Units.Current observed = load.i;
    equation
      connect(battery.p, load.p);  connect(load.n, effect.p);  connect(effect.n, battery.n);  connect(battery.n, ground.p);
    end Voltage;

    model Capacitor
      extends Base;
      Electrical.Capacitor effect(C = 1e-3, v_start = 0.2);
      Electrical.Voltage battery(v_0 = 1);
      Electrical.Resistor load(R = 10);
      Electrical.Ground ground;
      Units.Current observed = load.i;
    equation
      connect(battery.p, load.p);  connect(load.n, effect.p);  connect(effect.n, battery.n);  connect(battery.n, ground.p);
    end Capacitor;

    model Inductor
      extends Base;
      Electrical.Inductor effect(L = 0.1);
      Electrical.Voltage battery(v_0 = 1);
      Electrical.Resistor load(R = 10);
      Electrical.Ground ground;
      Units.Current observed = load.i;
    equation
      connect(battery.p, load.p);  connect(load.n, effect.p);  connect(effect.n, battery.n);  connect(battery.n, ground.p);
    end Inductor;
  end Absent;
end EffectTests;
