// status: 1
// error[MO0219] 10:7
model ReinitInAlgorithm
  Real z(start = 0, fixed = true);
equation
  der(z) = 1;
algorithm
  when time > 0.5 then
    if z > 0 then
      reinit(z, 1);
    end if;
  end when;
end ReinitInAlgorithm;
