// status: 1
// error[MO0221] 9:31
// A depth that only a run knows: each call makes two more, and one of them is told.
model Numbers
  function fibonacci
    input Integer n;
    output Integer f;
  algorithm
    f := if n < 2 then n else fibonacci(n - 1) + fibonacci(n - 2);
  end fibonacci;
  Integer n = integer(5*time);
  Integer f = fibonacci(n);
end Numbers;
