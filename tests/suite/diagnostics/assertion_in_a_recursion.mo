// status: 3
// error[MO0906] 10:5
// What a function asserts that calls itself, with a text that the run puts together.
model Halves
  function steps
    input Real x;
    input Integer most;
    output Integer n = 0;
  algorithm
    assert(most > 0, "no end at x = " + String(x));
    if abs(x) > 0.1 then
      n := 1 + steps(x/2, most - 1);
    end if;
  end steps;
  Integer n(start = 0, fixed = true);
equation
  when {initial(), sample(0.5, 0.5)} then
    n = noEvent(steps(1 + 7*time, 3));
  end when;
end Halves;
