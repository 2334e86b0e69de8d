// status: 1
// error[MO0226] 9:15
// error[MO0226] 13:21
// error[MO0217] 20:12
// error[MO0217] 25:3
model Conditional
  parameter Boolean present = true;
  record Reading
    Real at = time;
    Real value;
  end Reading;
  function clock
    output Real t = time;
  algorithm
  end clock;
  model Part
    parameter Real p = 1;
  end Part;
  Part part(p = 2) if present;
  Real x = part.p;
  Real level if present;
  Reading reading(value = 1);
  Real now = clock();
equation
  level = 1;
end Conditional;
