//@ case order_and_subscripts
model Gears
  type Gear = enumeration(First, Second, Third);
  parameter Gear gear = Gear.Second;
  parameter Real ratio[Gear] = {3.5, 2.1, 1.4};
  Real i = ratio[gear];
  Boolean low = gear < Gear.Third;
  Integer number = Integer(gear);
end Gears;
//@ run
//@ expect i, low, number = 2.1, 1, 2
//@ run set=gear=Gear.Third
//@ expect i, low, number = 1.4, 0, 3

//@ case least_and_greatest
//@ run interval=0.1
// Booleans and enumerations have an order (section 10.3.4).
model Least
  type E = enumeration(a, b, c);
  Boolean b[3] = {time > 0.25, time > 0.75, true};
  Boolean all = min(b), any = max(b), both = min(b[1], b[2]), none = max({false, false});
  E e[2] = {if time > 0.5 then E.c else E.a, E.b};
  E low = min(e), high = max(e), other = max(e[1], E.a);
end Least;
//@ expect all at 0.2, 0.5, 0.6, 0.9 = 0, 0, 0, 1
//@ expect each any = 1
//@ expect both at 0.2, 0.5, 0.6, 0.9 = 0, 0, 0, 1
//@ expect each none = 0
//@ expect low at 0.2, 0.4, 0.6, 0.9 = 1, 1, 2, 2
//@ expect high at 0.2, 0.4, 0.6, 0.9 = 2, 2, 3, 3
//@ expect other at 0.2, 0.4, 0.6, 0.9 = 1, 1, 3, 3

//@ case subscript_known_only_at_run_time
//@ run stop=3
// The literal that selects an element varies.
model Gearbox
  type Gear = enumeration(First, Second, Third);
  constant Real ratio[Gear] = {3.5, 2.0, 1.2};
  constant Gear next[Gear] = {Gear.Second, Gear.Third, Gear.Third};
  discrete Gear gear(start = Gear.First, fixed = true);
  Real speed = ratio[gear];
equation
  when sample(1, 1) then
    gear = next[pre(gear)];
  end when;
end Gearbox;
//@ expect speed at 0.5 = 3.5
//@ expect speed at 1.5 = 2
//@ expect speed at 2.5 = 1.2

//@ case enumerations_with_the_same_literals
// They are of one type, as section 6.7 of the specification says.
package Moved
  type Old = enumeration(Low, High);
  type New = enumeration(Low, High);
  model Switch
    parameter Old position = Old.Low;
    Real y = if position == Old.High then 2*time else time;
  end Switch;
  model User
    parameter New position = New.High;
    Switch switch(position = position);
  end User;
end Moved;
//@ expect switch.y = 2

//@ case values_by_number
//@ run also=flat
model ByNumber
  type E = enumeration(a, b, c);
  parameter E known = E(2);
  parameter E all[3] = E({3, 2, 1});
  Integer k(start = 1, fixed = true);
  E later = E(k);
  Integer back = Integer(E(k));
  Boolean same = known == E.b and all[1] == E.c and all[3] == E.a;
equation
  when time > 0.5 then
    k = 3;
  end when;
end ByNumber;
//@ expect same = 1
//@ expect later at 0.3, 1 = 1, 3
//@ expect back at 0.3, 1 = 1, 3

//@ case no_value_of_this_number
model TooFar
  type E = enumeration(a, b, c);
  Integer k(start = 1, fixed = true);
  //@ error[MO0912] 9-12
  E e = E(k);
equation
  when time > 0.5 then
    k = 4;
  end when;
end TooFar;
//@ status 3
