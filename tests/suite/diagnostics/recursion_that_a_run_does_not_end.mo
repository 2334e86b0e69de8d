// status: 3
// error[MO0907] 12:15
// A number that is stepped over.
model Steps
  function countDown
    input Integer n;
    output Integer steps;
  algorithm
    steps := if n == 0 then 0 else 1 + countDown(n - 2);
  end countDown;
  Integer n = integer(5*time);
  Integer k = countDown(2*n + 1);
end Steps;
