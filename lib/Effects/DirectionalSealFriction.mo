within Effects;
model DirectionalSealFriction "Friction of all seals that differs between the two directions, at rest as well"
  //   f = -a F - d |v|,   F the dry friction of the body while it slides
  // Dry friction is (1 + a) F against +v and (1 - a) F against -v, as with lips whose flanks differ, and so is viscous
  // friction with d. At rest F is what holds, so the body breaks away towards -s more easily than towards +s.
  parameter Units.Fraction a = 0 "Half the difference between the two directions, relative to their mean";
  parameter Real d(unit = "N.s/m") = 0 "Half the difference between the damping coefficients";

  input Units.Force F "Dry friction of the body while it slides, as a magnitude";

  Units.Velocity v "Speed";

  Translational.SpoolFlange seals "The seals of the body";
equation
  v = seals.v;
  seals.f_slide = 0;
  seals.f_static = 0;
  seals.f_push = a*F + d*noEvent(abs(v));

  annotation(__mocc(
    effect   = "amplitude=a,d; host=seals; bind F=seals.f_slide",
    law      = "f = -a F - d |v|",
    explains = "The friction of %at is greater in one direction than in the other, in proportion."));
end DirectionalSealFriction;
