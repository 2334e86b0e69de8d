//@ case equality_of_real_numbers
//@ run stop=2 interval=0.25 also=flat
// Real numbers are compared for equality in functions only, so a function of the flat model does it.
model Sinc
  function sinc
    input Real x;
    output Real y;
  algorithm
    y := if x == 0 then 1 elseif x <> 1 then sin(x)/x else 2;
  end sinc;
  Real y = sinc(time - 1);
end Sinc;
//@ expect flat has "'$equal'(time - 1.0, 0.0)"
//@ expect flat has "not '$equal'"
//@ expect y at 1, 2 = 1, 2
//@ expect y at 1.5 = sin(0.5)/0.5 rel 1e-12

//@ case shared_expressions
//@ used by stages.rs
// As a tree, each of these functions has more than 3^30 leaves.
model Shared
  function mixed
    input Real x;
    output Real y;
  algorithm
    y := x;
    for k in 1:30 loop
      y := (sin(y) + y/(2 + cos(y)))/1.5;
    end for;
  end mixed;
  Real x(start = 1, fixed = true);
  Real root;
  discrete Real held(start = 0, fixed = true);
  discrete Real kept(start = 0.5, fixed = true);
equation
  der(x) = -mixed(x) - x;
  // No root where its branch is not taken.
  root = if x > 0.5 then mixed(sqrt(x - 0.5))
         elseif x > 0.3 then 1 else mixed(sqrt(0.5 - x));
  when sample(0.1, 0.1) then
    held = mixed(pre(held) + x);
    kept = if x > 0.6 then mixed(sqrt(x - 0.6)) + pre(kept) else pre(kept);
  end when;
end Shared;

//@ case shared_parameters
// The values of parameters and the attributes of variables share their parts, too.
model Shared
  function mixed
    input Real x;
    output Real y;
  algorithm
    y := x;
    for k in 1:30 loop
      y := (sin(y) + y/(2 + cos(y)))/1.5;
    end for;
  end mixed;
  parameter Real a = 2;
  parameter Real b = mixed(a) + mixed(2*a);
  Real x(start = mixed(a), nominal = mixed(a) + mixed(3*a), fixed = true);
  Real y = b;
equation
  der(x) = -b*x;
  annotation(experiment(StopTime = 1));
end Shared;
//@ expect y = 0.05880165565259807 rel 1e-12
//@ expect x at start = 0.029288139380569775 rel 1e-12
//@ expect x = 0.029288139380569775*exp(-(0.05880165565259807)) rel 1e-5

//@ case conditions_of_functions
//@ used by stages.rs
// A value in one branch that a condition needs in another: a variable for it would need itself.
// There it is written out, which stays short or is reported.
model Settled
  function settled
    input Real x;
    output Real y;
  protected
    constant Integer steps = 3;
    Boolean high;
    Integer phase;
  algorithm
    y := x;
    high := x > 0.2;
    phase := 1;
    for k in 1:steps loop
      high := if high then y*y + sin(y) > 0.1*k - 2 else y*y + cos(y) > 0.9;
      phase := if high and phase < 3 then phase + 1
               elseif y > phase/4 then 2 else 1;
      if high then
        // No logarithm where its branch is not taken.
        y := log(1 + y*y)/phase + y/2;
      elseif y < 0.3 then
        y := sqrt(0.3 - y) + y/(2 + phase);
      end if;
    end for;
  end settled;
  Real x(start = 1, fixed = true);
  Real y;
equation
  der(x) = -x;
  y = settled(x);
end Settled;
