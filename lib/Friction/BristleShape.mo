within Friction;
partial model BristleShape "Friction of elastic bristles (LuGre) with two magnitudes given by the law"
  //   dz/dt = v - sigma_0 |v|/g(v) z,   g(v) = F_C + F_S exp(-f_exp |v|)
  //   f     = sigma_0 z + sigma_1 exp(-(v/v_d)^2) dz/dt + F_prop v
  // The surfaces touch through bristles that bend by z before they slip. At constant speed f is the Stribeck curve
  // g(v) sgn(v) + F_prop v; at rest the spool sits on a spring of stiffness sigma_0, which bends in proportion to the
  // load. The state is the elastic force f_z = sigma_0 z in newton, which is of order 1, rather than the deflection z
  // of some micrometres, and g is the only divisor. It relaxes over the path g/sigma_0, so at speed v within
  // g/(sigma_0 |v|), some microseconds, and the spool oscillates on the bristles with sqrt(sigma_0/m): a stiff
  // integrator resolves this while it moves and steps over it once it has settled. Without sigma_1 the oscillation at
  // rest is hardly damped; 2 sqrt(sigma_0 m) is critical. The damping of the bristles fades above v_d; otherwise
  // friction at speed would not be passive.
  // Source: Canudas de Wit, Olsson, Åström and Lischinsky (1995), "A New Model for Control of Systems with Friction",
  // IEEE Trans. Automatic Control 40(3); the fading sigma_1 and passivity: Olsson (1996), "Control Systems with
  // Friction", Lund.
  extends Law(f_signed = f_z + sigma_1*exp(-(v/v_d)^2)*v_z + F_prop*v);
  parameter Units.SpringStiffness    sigma_0        "Stiffness of the bristles";
  parameter Units.DampingCoefficient sigma_1        "Damping of the bristles";
  parameter Units.Velocity           v_d     = 0.01 "Speed above which this damping fades";
  parameter Units.DampingCoefficient F_prop         "Viscous friction per speed";
  parameter Units.PerVelocity        f_exp          "Decay of the Stribeck force with speed";

  Units.Force    F_C "Coulomb friction in the present state";
  Units.Force    F_S "Stribeck force in the present state: excess of static over Coulomb friction";
  Units.Force    g   "Force that the bristles can carry at the present speed";
  Units.Force    f_z(start = 0, fixed = true) "Elastic force of the bristles";
  Units.Velocity v_z "Speed at which they bend: dz/dt";
equation
  f_slide = 0;
  f_static = 0;
  g = F_C + F_S*exp(-f_exp*speed);
  // A seal that has left the housing has straight bristles, which bend again when it meets the housing.
  v_z = if closed then v - speed*f_z/g else 0;
  der(f_z) = sigma_0*v_z;
  when not closed then
    reinit(f_z, 0);
  end when;
end BristleShape;
