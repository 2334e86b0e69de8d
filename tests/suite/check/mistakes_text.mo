//@ case semicolon_after_equation
//@ check
model Cart
  Real v(start = 1, fixed = true);
equation
  //@ error[MO0003] 14
  der(v) = -v
end Cart;

//@ case semicolon_after_declaration
//@ check
model Cart
  //@ error[MO0003] 23
  parameter Real m = 2
  Real v(start = 1, fixed = true);
equation
  m*der(v) = -v;
end Cart;

//@ case assignment_in_equations
//@ check
model Cart
  Real v;
equation
  //@ error[MO0007] 5-6
  v := 2*time;
end Cart;

//@ case equation_in_algorithm
//@ check
model Cart
  Real v;
algorithm
  //@ error[MO0008] 5
  v = 2*time;
end Cart;

//@ case double_equals
//@ check
model Cart
  Real v;
equation
  //@ error[MO0032] 5-6
  v == 2*time;
end Cart;

//@ case not_equal_of_c
//@ check
model Cart
  Real v = 2*time;
  //@ error[MO0011] 21-22
  Boolean moves = v != 0;
end Cart;

//@ case and_of_c
//@ check
model Cart
  Real v = 2*time;
  //@ error[MO0011] 27-28
  Boolean cruises = v > 1 && v < 2;
end Cart;

//@ case conditional_of_c
//@ check
model Cart
  Real u = sin(time);
  //@ error[MO0010] 18
  Real v = u > 0 ? u : 0;
end Cart;

//@ case power_of_python
//@ check
model Cart
  //@ error[MO0011] 18-19
  Real v = 2*time**2;
end Cart;

//@ case decimal_comma
//@ check
model Cart
  //@ error[MO0037] 22-25
  parameter Real m = 12,5;
  Real v = m*time;
end Cart;

//@ case keyword_as_name
//@ check
model Cart
  //@ error[MO0038] 8-12
  Real model = 2*time;
end Cart;

//@ case letters_outside_of_ascii
//@ check
model Cart
  //@ error[MO0033] 8-11
  Real höhe = 2*time;
end Cart;

//@ case string_without_end
//@ check
model Cart
  //@ error[MO0012] 28
  parameter String label = "light cart;
  Real v = 2*time;
end Cart;

//@ case comment_without_end
//@ check
model Cart
  //@ error[MO0013] 3-4
  /* the speed
  Real v = 2*time;
end Cart;

//@ case end_of_another_name
//@ check
model Cart
  Real v = 2*time;
//@ error[MO0005] 5-8
end Card;

//@ case end_of_inner_class_missing
//@ check
package Works
  model Cart
    Real v = 2*time;
  model Train
    Cart cart;
  end Train;
//@ error[MO0006] 5-9
end Works;

//@ case end_if_missing
//@ check
model Cart
  Real v;
equation
  if time > 1 then
    v = 1;
  else
    v = 2;
//@ error[MO0031] 1-3
end Cart;

//@ case bracket_missing
//@ check
model Cart
  //@ error[MO0004] 23
  Real v = 2*(time + 1;
end Cart;

//@ case bracket_too_many
//@ check
model Cart
  //@ error[MO0030] 24
  Real v = 2*(time + 1));
end Cart;

//@ case if_expression_without_else
//@ check
model Cart
  //@ error[MO0001] 30
  Real v = if time > 1 then 2;
end Cart;

//@ case misspelled_keyword
//@ check
model Cart
  //@ error[MO0020] 3-10
  paramter Real m = 2;
  Real v = m*time;
end Cart;

//@ case index_in_parentheses
//@ check
model Cart
  Real x[2] = {time, 2*time};
  //@ error[MO0288] 12
  Real v = x(1);
end Cart;

//@ case else_if_in_two_words
//@ check
model Cart
  Real v;
equation
  if time > 2 then
    v = 1;
  else if time > 1 then
    v = 2;
  else
    v = 3;
  end if;
//@ error[MO0031] 1-3
end Cart;
