// status: 3
// error[MO0906] 13:7
// What is asserted in a loop whose length only a run knows.
model Newton
  function root
    input Real a;
    output Real x = 1;
  protected
    Integer turns = 0;
  algorithm
    while abs(x*x - a) > 1e-12 loop
      turns := turns + 1;
      assert(turns < 4, "no root of " + String(a) + " is found");
      x := (x + a/x)/2;
    end while;
  end root;
  Real y = root(4 + time);
  annotation(experiment(StopTime = 3));
end Newton;
