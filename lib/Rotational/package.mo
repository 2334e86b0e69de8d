within;
package Rotational "Rotation about one axis: inertias, springs, dampers, gears"
  // The counterparts of Translational: angles instead of positions, torques instead of forces. A positive torque acts on
  // the component that owns the flange, as everywhere in the library.
end Rotational;
