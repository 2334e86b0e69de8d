//@ case values_slopes_and_jumps
//@ run stop=3 tolerance=1e-9
//@ snapshot flat
// Tables of an external object, as the library of tables declares it: values, slopes, and jumps in time.
package Tables
  type Smoothness = enumeration(Linear, Akima, Constant, FritschButland, Steffen, ModifiedAkima);
  type Extrapolation = enumeration(Hold, Linear, Periodic, Forbidden);
  type Events = enumeration(Always, AtJumps, Never);
  class Curve
    extends ExternalObject;
    function constructor
      input String tableName;
      input String fileName;
      input Real table[:, :];
      input Integer columns[:];
      input Smoothness smoothness;
      input Extrapolation extrapolation = Extrapolation.Linear;
      output Curve curve;
    external "C" curve = ModelicaStandardTables_CombiTable1D_init3(fileName, tableName, table, size(table, 1), size(table, 2), columns, size(columns, 1), smoothness, extrapolation, false, ",", 0);
    end constructor;
    function destructor
      input Curve curve;
    external "C" ModelicaStandardTables_CombiTable1D_close(curve);
    end destructor;
  end Curve;
  function at
    input Curve curve;
    input Integer column;
    input Real u;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTable1D_getValue(curve, column, u);
  end at;
  class Course
    extends ExternalObject;
    function constructor
      input Real table[:, :];
      input Real start;
      output Course course;
    external "C" course = ModelicaStandardTables_CombiTimeTable_init3("NoName", "NoName", table, size(table, 1), size(table, 2), start, {2}, 1, Smoothness.Linear, Extrapolation.Hold, start, Events.AtJumps, false, ",", 0);
    end constructor;
    function destructor
      input Course course;
    external "C" ModelicaStandardTables_CombiTimeTable_close(course);
    end destructor;
  end Course;
  function now
    input Course course;
    input Real t;
    input Real next;
    input Real before;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTimeTable_getValue(course, 1, t, next, before);
  end now;
  function next
    input Course course;
    input Real t;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTimeTable_nextTimeEvent(course, t);
  end next;
  model Spring
    parameter Real points[:, :] = [-1, -2; 0, 0; 1, 2; 2, 5];
    parameter Curve curve = Curve("NoName", "NoName", points, {2}, Smoothness.Linear, Extrapolation.Linear);
    parameter Course course = Course([0, 0; 1, 1; 1, 3; 2, 3], 0.5);
    discrete Real nextEvent(start = 0, fixed = true);
    Real x(start = 0.5, fixed = true);
    Real v(start = 0, fixed = true);
    Real drive;
    Real sum(start = 0, fixed = true);
  equation
    der(x) = v;
    der(v) = -at(curve, 1, x);
    when {time >= pre(nextEvent), initial()} then
      nextEvent = next(course, time);
    end when;
    drive = now(course, time, nextEvent, pre(nextEvent));
    der(sum) = drive;
  end Spring;
end Tables;
// The curve is a function; the value of the course, and its next event.
//@ expect flat has 1 "noEvent('$table1'(x))"
//@ expect flat has 1 "table("
//@ expect flat has 1 "nextTimeEvent("
// Between the points -1 and 1 the spring is linear with stiffness 2; the course rises from 0.5 s
// to 1 in 1 s, jumps to 3 and stays: 0.5 + 1.5 * 3.
//@ expect x = 0.5*cos(sqrt(2)*3) abs 1e-7
//@ expect sum = 5 abs 1e-7

//@ case start_found_by_initialization
//@ run stop=4 interval=0.125
// A table that repeats itself from a time that initialization determines. Before it, the table is 0.
package Moving
  type Smoothness = enumeration(Linear, Continuous, Constant, Monotone1, Monotone2, Modified);
  type Extrapolation = enumeration(Hold, Linear, Periodic, Forbidden);
  type Events = enumeration(Always, AtJumps, Never);
  class Course
    extends ExternalObject;
    function constructor
      input Real points[:, :];
      input Real start;
      input Real shift;
      output Course course;
    external "C" course = ModelicaStandardTables_CombiTimeTable_init3(
      "NoName", "NoName", points, size(points, 1), size(points, 2), start, {2}, 1,
      Smoothness.Linear, Extrapolation.Periodic, shift, Events.Always, false, ",", 0);
    end constructor;
    function destructor
      input Course course;
    external "C" ModelicaStandardTables_CombiTimeTable_close(course);
    end destructor;
  end Course;
  function now
    input Course course;
    input Real t;
    input Real next;
    input Real before;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTimeTable_getValue(course, 1, t, next, before);
  end now;
  function next
    input Course course;
    input Real t;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTimeTable_nextTimeEvent(course, t);
  end next;
  model Sawtooth
    parameter Real t0(fixed = false);
    parameter Course course = Course([0, 0; 1, 2], t0, t0);
    discrete Real nextEvent(start = 0, fixed = true);
    Real y;
    Real sum(start = 0, fixed = true);
  initial equation
    t0 = 0.5 + time;
  equation
    when {time >= pre(nextEvent), initial()} then
      nextEvent = next(course, time);
    end when;
    y = now(course, time, nextEvent, pre(nextEvent));
    der(sum) = y;
  end Sawtooth;
end Moving;
//@ expect y at 0.375, 0.75, 1.25, 3.375 = 0, 0.5, 1.5, 1.75 abs 1e-9
// Three whole teeth of area 1 and half of the width of another one, an area of a quarter.
//@ expect sum = 3.25 abs 1e-7
