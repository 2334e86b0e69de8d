within Friction;
partial model StribeckShape "Stribeck curve with two magnitudes given by the law"
  //   |f| = F_C + F_S exp(-f_exp |v|) + F_prop |v| while sliding
  extends Law(f_signed = F_prop*v);
  parameter Units.DampingCoefficient F_prop "Viscous friction per speed";
  parameter Units.PerVelocity        f_exp  "Decay of the Stribeck force with speed";

  Units.Force F_C "Coulomb friction in the present state";
  Units.Force F_S "Stribeck force in the present state: excess of static over Coulomb friction";
equation
  f_static = F_C + F_S;
  f_slide = F_C + F_S*exp(-f_exp*speed);
end StribeckShape;
