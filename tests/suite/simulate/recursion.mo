//@ case too_deep
//@ status 3
// A number that is stepped over.
model Steps
  function countDown
    input Integer n;
    output Integer steps;
  algorithm
    steps := if n == 0 then 0 else 1 + countDown(n - 2);
  end countDown;
  Integer n = integer(5*time);
  //@ error[MO0907] 15-32
  Integer k = countDown(2*n + 1);
end Steps;
