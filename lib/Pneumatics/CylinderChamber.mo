within Pneumatics;
model CylinderChamber "Isothermal air behind a piston with ambient pressure on its other side"
  //   m = p V/(R T),   V = V_dead +- A (s - s_empty),   f = +- A (p - p_ambient)
  parameter Units.Volume           V_dead    "Dead volume: volume with the piston at s_empty";
  parameter Units.Area             A         "Piston area";
  parameter Units.Position         s_empty   = 0 "Stroke at which only the dead volume remains";
  parameter Integer                direction = 1 "+1 if the air pushes the piston towards +s, -1 towards -s";
  parameter Units.AbsolutePressure p_ambient = Air.p_ambient "Pressure on the other side of the piston";
  extends PartialVolume(final V_nominal = V_dead);

  Translational.Flange flange "The piston";
equation
  V = V_dead + direction*A*(flange.s - s_empty);
  flange.f = -direction*A*(p - p_ambient);
  assert(direction == 1 or direction == -1, "CylinderChamber: direction must be +1 or -1");
end CylinderChamber;
