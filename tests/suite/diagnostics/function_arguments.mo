// status: 1
// error[MO0219] 10:12
// error[MO0219] 11:12
// error[MO0219] 12:18
model Call
  function twice
    input Real x;
    output Real y = 2*x;
  end twice;
  Real a = twice();
  Real b = twice(1, 2);
  Real c = twice(z = 2);
end Call;
