//@ case equality_of_real_numbers
//@ run stop=2 interval=0.25 also=flat
// Real numbers are compared for equality in functions only, so a function of the flat model does it.
model Sinc
  function sinc
    input Real x;
    output Real y;
  algorithm
    y := if x == 0 then 1 elseif x <> 1 then sin(x)/x else 2;
  end sinc;
  Real y = sinc(time - 1);
end Sinc;
//@ expect flat has "'$equal'(time - 1.0, 0.0)"
//@ expect flat has "not '$equal'"
//@ expect y at 1, 2 = 1, 2
//@ expect y at 1.5 = sin(0.5)/0.5 rel 1e-12
