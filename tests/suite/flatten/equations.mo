//@ case wrong_type
model Switch
  Boolean on;
  Real x(start = 0);
equation
  //@ error[MO1220] 3-8
  on = 1;
  //@ error[MO0212] 15-16
  der(x) = if x then 1 else 2;
end Switch;

//@ case size_mismatch
model Sums
  Real a[3] = {1, 2, 3};
  Real b[2];
equation
  //@ error[MO0215] 3-7
  b = a;
end Sums;

//@ case values_that_stand_alone
model Room
  Real T(start = 290, fixed = true);
  Real x[2] = {T, 2*T};
equation
  der(T) = 300 - T;
  //@ error[MO1293] 3-8
  der(T);
  //@ error[MO1293] 3-8
  sum(x);
  //@ error[MO1293] 3-14
  sample(0, 1);
end Room;

//@ case integers_that_a_loop_of_a_function_gives
//@ run stop=2
// The order of three values, by a loop whose comparisons are no events: an event is where the result changes.
package Orders
  function largest
    input Real u[3];
    output Real y;
    output Integer k;
  protected
    Integer i;
  algorithm
    k := 1;
    i := 2;
    while i <= 3 loop
      if u[i] > u[k] then
        k := i;
      end if;
      i := i + 1;
    end while;
    y := u[k];
  end largest;
  model Race
    Real u[3] = {1.25, time, 2*time - 1};
    Real y;
    Integer k;
    Integer changes(start = 0, fixed = true);
  equation
    (y, k) = largest(u);
    when change(k) then
      changes = pre(changes) + 1;
    end when;
  end Race;
end Orders;
//@ expect y at 0.5, 1.2, 2 = 1.25, 1.4, 3 rel 1e-6
//@ expect k at 0.5, 1.1, 2 = 1, 1, 3
//@ expect changes = 1
