//@ case missing_end_of_a_class
// One omission, one error: the following classes are read as they were meant.
package Plant
  model Tank
    Real h(start = 1, fixed = true);
  equation
    der(h) = -h;

  //@ error[MO0006] 3-7
  model Valve
    parameter Real k = 1;
    Real q;
  equation
    q = k*time;
    if time > 1 then
      assert(q > 0, "no flow");
    end if;
  end Valve;

  model System
    Tank tank;
    Valve valve;
  end System;
end Plant;

//@ case missing_end_before_a_function
package Tools
  block Gain
    Real y;
  equation
    y = twice(time);
  //@ error[MO0006] 3-10
  function twice
    input Real u;
    output Real y;
  algorithm
    y := 2*u;
  end twice;
end Tools;

//@ case decimal_comma
model Wall
  //@ error[MO0037] 22-25
  parameter Real G = 12,5;
  //@ error[MO0037] 16-19
  Real x(start=0,05);
end Wall;

//@ case keyword_as_name
model Device
  //@ error[MO0038] 8-12
  Real model = 1;
  //@ error[MO0038] 8-13
  Real output(start = 2);
  Real x = time;
end Device;

//@ case end_as_name
model Travel
  //@ error[MO0038] 8-10
  Real end = 1;
  Real x;
equation
  x = time;
end Travel;

//@ case string_without_an_end
// The string swallows the next lines up to the next quote; the error is where it begins.
model Tank
  //@ error[MO0012] 25
  parameter Real C(unit="J/K) = 4.2e4;
  parameter Real k(unit="W/K") = 12;
  Real T(start = 293, unit="K");
equation
  C*der(T) = -k*T;
end Tank;

//@ case conditional_operator
model Choice
  Real y;
equation
  //@ error[MO0010] 18
  y = (time > 1) ? 1 : time;
end Choice;

//@ case division_by_dt
model Cooling
  Real T(start = 1, fixed = true);
equation
  //@ error[MO0202] 10-11
  der(T)/dt = -T;
end Cooling;
