//@ case a_component_contains_itself_by_redeclaration
model Outer
  //@ error[MO0205] 21
  replaceable model M = N;
  model N
    //@ error[MO0262] 13
    extends M;
  end N;
  //@ error[MO0203] 23
  M m(redeclare model M = M);
end Outer;

//@ case a_connector_contains_itself
model Outer
  connector C
    Real e;
    //@ error[MO0294] 5
    C s;
  end C;
  input C c;
end Outer;

//@ case calls_that_double
model Model
  function fibonacci
    input Integer n;
    output Integer y;
  algorithm
    //@ error[MO1294] 50-65
    y := if n < 2 then n else fibonacci(n - 1) + fibonacci(n - 2);
  end fibonacci;
  constant Integer k = fibonacci(60);
  Real x = k;
end Model;

//@ case strings_that_double
model Model
  function repeated
    input String part;
    input Integer doublings;
    output String text = part;
  algorithm
    for i in 1:doublings loop
      //@ error[MO1296] 15-25
      text := text + text;
    end for;
  end repeated;
  constant String long = repeated("ab", 40);
  Real x = if long == "" then 0 else time;
end Model;

//@ case bases_that_double
// Forty classes that each extend the previous one twice are one path to the base.
package Bases
  partial model M0
    annotation(experiment(StopTime = 2));
  end M0;
  partial model M1 extends M0; extends M0; end M1;
  partial model M2 extends M1; extends M1; end M2;
  partial model M3 extends M2; extends M2; end M3;
  partial model M4 extends M3; extends M3; end M4;
  model M5
    extends M4;
    extends M4;
    Real x = time;
  end M5;
end Bases;
//@ expect x = 2
