//@ case misspelled_variable
//@ check
model Cart
  Real speed = 2*time;
  //@ error[MO0202] 18-21
  Real twice = 2*sped;
end Cart;

//@ case misspelled_class
//@ check
package Works
  model Wheel
    Real w = time;
  end Wheel;
  model Cart
    //@ error[MO0201] 5-10
    Wheell wheel;
  end Cart;
end Works;

//@ case misspelled_function
//@ check
model Cart
  //@ error[MO0288] 12-15
  Real v = sine(time);
end Cart;

//@ case function_with_too_many_arguments
//@ check
model Cart
  function drag
    input Real v;
    output Real F;
  algorithm
    F := 3*v;
  end drag;
  //@ error[MO0219] 12-24
  Real F = drag(time, 2);
end Cart;

//@ case modifier_of_unknown_element
//@ check
package Works
  model Wheel
    parameter Real r = 1;
  end Wheel;
  model Cart
    //@ error[MO0203] 17-22
    Wheel wheel(radius = 2);
  end Cart;
end Works;

//@ case string_for_a_number
//@ check
model Cart
  //@ error[MO0212] 22-24
  parameter Real m = "2";
  Real v = m*time;
end Cart;

//@ case boolean_equals_real
//@ check
model Cart
  Real v = 2*time;
  Boolean b;
equation
  //@ error[MO1220] 3-7
  b = v;
end Cart;

//@ case real_as_condition
//@ check
model Cart
  Real v = 2*time;
  //@ error[MO0212] 15-16
  Real w = if v then 1 else 2;
end Cart;

//@ case protected_element
//@ check
package Works
  model Wheel
  protected
    Real w = time;
  end Wheel;
  model Cart
    Wheel wheel;
    //@ error[MO0260] 22
    Real v = 2*wheel.w;
  end Cart;
end Works;

//@ case array_of_another_size
//@ check
model Cart
  //@ error[MO1229] 15-28
  Real x[3] = {time, 2*time};
end Cart;

//@ case subscript_out_of_bounds
//@ check
model Cart
  Real x[2] = {time, 2*time};
  //@ error[MO0216] 14
  Real v = x[3];
end Cart;

//@ case scalar_with_subscript
//@ check
model Cart
  Real x = time;
  //@ error[MO1240] 12-15
  Real v = x[1];
end Cart;

//@ case equality_of_reals
//@ check
model Cart
  Real x = sin(time);
  //@ error[MO0309] 11
  Boolean b = x == 0;
end Cart;

//@ case previous_value_of_a_continuous_variable
//@ check
model Cart
  Real x(start = 0, fixed = true);
  //@ error[MO0325] 8
  Real y = pre(x);
equation
  der(x) = 1;
end Cart;

//@ case derivative_divided_by_dt
//@ check
model Cart
  Real v(start = 1, fixed = true);
equation
  //@ error[MO0202] 10-11
  der(v)/dt = -v;
end Cart;

//@ case derivative_of_a_formula_in_a_function
//@ check
model Cart
  function slope
    input Real x;
    output Real y;
  algorithm
    //@ error[MO1297] 10-15
    y := der(x);
  end slope;
  Real v = slope(time);
end Cart;

//@ case assignment_to_a_parameter
//@ check
model Cart
  //@ error[MO0315] 18
  parameter Real m = 1;
  Real v = time;
algorithm
  m := 2;
end Cart;

//@ case parameter_of_a_variable
//@ check
model Cart
  Real v = time;
  //@ error[MO0268] 22
  parameter Real m = v;
end Cart;

//@ case parameters_in_a_circle
//@ check
model Cart
  //@ error[MO0301] 18
  parameter Real a = b;
  parameter Real b = a;
  Real v = a*time;
end Cart;

//@ case missing_base_class
//@ check
package Works
  model Cart
    //@ error[MO0201] 13-19
    extends Vehicle;
    Real w = 2*v;
  end Cart;
end Works;

//@ case missing_import
//@ check
package Works
  model Cart
    //@ error[MO0201] 12-25
    import Vehicles.Wheel;
    Wheel wheel;
  end Cart;
end Works;

//@ case component_of_itself
//@ check
model Cart
  Real v = time;
  //@ error[MO0294] 3-6
  Cart trailer;
end Cart;

//@ case record_without_a_field
//@ check
model Cart
  record Load
    Real mass;
    Real height;
  end Load;
  //@ error[MO1256] 15-28
  Load load = Load(mass = 3);
  Real v = load.height*time;
end Cart;

//@ case value_that_is_not_used
//@ check
model Cart
  Real x[2] = {time, 2*time};
equation
  //@ error[MO1293] 3-8
  sum(x);
end Cart;
