// status: 1
// error[MO0219] 13:29
// error[MO0219] 15:26
// error[MO0200] 17:12
// error[MO0219] 18:12
model DerivedFunctions
  function f
    input Real x;
    input Real u[2];
    output Real y = x + u[1];
  algorithm
  end f;
  function by_what = der(f, z);
  function by_array = der(f, u);
  function of_what = der(Real, x);
  Real a = by_what(time, {1, 2});
  Real b = by_array(time, {1, 2});
  Real c = of_what(time);
end DerivedFunctions;
