within Pneumatics;
model PistonForce "Force of the air on one face of a piston"
  parameter Units.EffectiveArea A "Area, positive if the air pushes towards +s";
  Port                port;
  Translational.Flange flange;
equation
  port.m_flow = 0;
  flange.f = -A*(port.p - Air.p_ambient);
end PistonForce;
