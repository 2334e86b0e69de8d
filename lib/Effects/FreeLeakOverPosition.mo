within Effects;
model FreeLeakOverPosition "Leak past a seal as a free curve over the stroke"
  //   m_flow = iso6358(p_a, p_b, C(s), b)
  // C is a smooth curve through the n amplitudes C at n strokes, equally spaced from s_lo to s_hi (knotWeights). A
  // seal that opens early, late or only partly differs from its specification in this way.
  extends PartialLeak;
  parameter Integer                n    = 8        "Number of knots";
  parameter Units.SonicConductance C[n] = zeros(n) "Additional sonic conductance at each knot";
  parameter Units.Fraction         b    = 0.3      "Critical pressure ratio";
  parameter Units.Position         s_lo = 0        "First knot";
  parameter Units.Position         s_hi = 1        "Last knot";

  Units.Position s "Stroke";

  Translational.SpoolFlange spool "The spool";
equation
  s = spool.s;
  spool.f_slide = 0;
  spool.f_static = 0;
  spool.f_push = 0;
  m_flow = Pneumatics.iso6358(p_a, p_b, C*knotWeights((s - s_lo)/(s_hi - s_lo)*(n - 1), n), b);

  annotation(__mocc(
    effect   = "amplitude=C; host=spool,port_a,port_b; s_lo=min(s); s_hi=max(s)",
    law      = "m_flow = iso6358(p_a, p_b, C(s), b)",
    explains = "The opening of %at over the stroke differs from the model."));
end FreeLeakOverPosition;
