within Pneumatics;
model AirSpring "Cylinder chamber fed from a source through a restriction"
  extends Translational.PartialActuator;
  parameter Units.AbsolutePressure p_supply            "Pressure of the source";
  parameter Units.AbsolutePressure p_start  = p_supply "Pressure in the chamber at the start";
  parameter Units.SonicConductance C                   "Sonic conductance of the restriction";
  parameter Units.Fraction         b        = 0.3      "Critical pressure ratio of the restriction";
  parameter Units.Volume           V_dead              "Dead volume: volume with the piston at s_empty";
  parameter Units.Area             A                   "Piston area";
  parameter Units.Position         s_empty   = 0       "Stroke at which only the dead volume remains";
  parameter Integer                direction = 1       "+1 if the air pushes the piston towards +s, -1 towards -s";

  Units.AbsolutePressure p = chamber.p "Pressure in the chamber";

  Source          source(p = p_supply);
  Restriction     feed(C = C, b = b);
  CylinderChamber chamber(V_dead = V_dead, A = A, s_empty = s_empty, direction = direction, p_start = p_start);
equation
  connect(source.port, feed.port_a);
  connect(feed.port_b, chamber.port);
  connect(chamber.flange, flange);
end AirSpring;
