// args: --method radau
// status: 3
// error[MO0902] 12:8
model Entropy
  function s
    input Real x;
    output Real y;
  algorithm
    y := x*log(x);
  end s;
  Real x(start = 1, fixed = true);
  Real y = s(x);
equation
  der(x) = -1;
end Entropy;
