// status: 1
// error[MO0206] 11:16
// A scalar, an array and a record whose `inner` nobody declares.
model MissingInner
  record Air
    Real p = 1e5;
    Real T = 300;
  end Air;
  model Part
    outer Real ambient;
    outer Real levels[2];
    outer Air air;
    outer parameter Integer n;
    Real y = ambient + levels[1] + air.T + n;
  end Part;
  Part part;
end MissingInner;
