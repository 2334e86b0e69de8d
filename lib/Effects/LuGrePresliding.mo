within Effects;
model LuGrePresliding "Friction of elastic bristles with Stribeck effect and damping (LuGre)"
  //   f = -F (z + tau_z exp(-(v/v_d)^2) dz/dt)
  //   delta dz/dt = v - |v| z/g,   g = 1 + r exp(-(v/v_s)^2)
  // In the symbols of LuGre: sigma_0 = F/delta, sigma_1 = F tau_z/delta, F_C = F, F_S = (1 + r) F. At constant speed
  // f = -F g(v) sgn(v). The state z is of order 1 and independent of F, so F = 0 is regular.
  // Source: Canudas de Wit, Olsson, Åström and Lischinsky (1995), IEEE Trans. Automatic Control 40(3).
  extends PartialDrag;
  parameter Units.Force    F     = 0     "Coulomb friction of the bristles";
  parameter Units.Length   delta = 10e-6 "Deflection of the bristles at which they slip";
  parameter Units.Fraction r     = 0.5   "Stribeck excess at rest, relative to F";
  parameter Units.Velocity v_s   = 0.05  "Speed at which 37 % of the excess remains";
  parameter Units.Time     tau_z = 1e-4  "Damping of the bristles, as a time";
  parameter Units.Velocity v_d   = 0.01  "Speed above which this damping fades";

  Units.Fraction        z(start = 0, fixed = true) "Deflection of the bristles in deltas, -(1 + r) to 1 + r";
  Units.PerTime         z_dot                      "Rate at which they bend";
  Units.Fraction        g                          "Deflection at constant speed";
  Units.SpringStiffness sigma_0                    "Stiffness at rest";
equation
  g = 1 + r*exp(-(v/v_s)^2);
  z_dot = (v - noEvent(abs(v))*z/g)/delta;
  der(z) = z_dot;
  f = -F*(z + tau_z*z_dot*exp(-(v/v_d)^2));
  sigma_0 = F/delta;

  annotation(__mocc(
    effect   = "amplitude=F>0; delta=5e-6,20e-6,80e-6; r=0.5; v_s=0.02*span(v),0.1*span(v)",
    law      = "f = -F (z + tau_z exp(-(v/v_d)^2) dz/dt)",
    explains = "Friction of elastic bristles (LuGre) acts on %at."));
end LuGrePresliding;
