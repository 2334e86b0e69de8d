within;
package Pneumatics "Air in volumes and restrictions, isothermal"

  // The roles of components in the animation of a report.
  annotation(__mocc(view =
    "piston.area = A; piston.pressure = p|port.p; piston.direction = direction; port.pressure = p"));
end Pneumatics;
