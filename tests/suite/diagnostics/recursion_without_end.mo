// status: 1
// error[MO0221] 11:31
// A depth that only a run knows, of vectors that get shorter: such a function has no sizes of its own.
model Sums
  function sum
    input Real x;
    input Real v[:];
    output Real s;
  algorithm
    // It never looks whether there are elements left.
    s := if x < 0 then 0 else sum(x - 1, v[2:end]) + sum(x - 2, cat(1, v, {x}));
  end sum;
  Real s = sum(time, {1, 2, 3});
end Sums;
