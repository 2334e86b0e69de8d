within Effects;
model FreeLeakOverPosition "Leak past a seal over the stroke as a free curve"
  // m_flow after ISO 6358; the conductance runs smoothly through the n amplitudes C at n strokes, equally spaced from s_lo
  // to s_hi (knotWeights). A seal that opens early, late, or not all the way differs from the sheet in this way.
  extends PartialLeak;
  parameter Integer                n    = 8        "Number of knots";
  parameter Units.SonicConductance C[n] = zeros(n) "Sonic conductance at each knot, beside what the model has";
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
    explains = "%at lets air through in another way over the stroke than the model says."));
end FreeLeakOverPosition;
