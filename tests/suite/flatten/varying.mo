//@ case a_parameter_follows_its_factor
//@ run stop=1 tolerance=1e-9
model Cooling
  parameter Real k = 2;
  Real T(start = 1, fixed = true);
  Real factor = 1 + time;
equation
  der(T) = -k*T;
  annotation(__mocc(varies = "k = factor"));
end Cooling;
//@ expect T at 1 = exp(-3) abs 1e-8

//@ case bound_parameters_follow_too
//@ run stop=1 tolerance=1e-9
model Shell
  parameter Real k;
  parameter Real T_0 = 1;
  Real T(start = T_0, fixed = true);
equation
  der(T) = -k*T;
end Shell;
model Oven
  parameter Real conductance = 4;
  parameter Real capacity = 2;
  parameter Real k = conductance/capacity;
  Shell core(k = k);
  Shell hull(k = 2*k, T_0 = conductance);
  Real growth = 1 + time;
end Oven;
// The annotation of a base class counts, and another one for the same parameter multiplies.
model Aged
  extends Oven;
  annotation(__mocc(varies = "conductance = growth"));
end Aged;
model Dirty
  extends Aged;
  Real half = 0.5;
  annotation(__mocc(varies = "conductance = half"));
end Dirty;
//@ expect core.T at 1 = exp(-1.5) abs 1e-8
//@ expect hull.T at 1 = 4*exp(-3) abs 1e-8
//@ expect hull.T at 0 = 4 abs 1e-12

//@ case parameters_that_cannot_vary
model Chain
  parameter Integer n = 3;
  Real x[n](each start = 1, each fixed = true);
equation
  for i in 1:n loop
    der(x[i]) = -x[i];
  end for;
  //@ error[MO1292] 30-39: `n` cannot vary: it is not a `Real` parameter
  annotation(__mocc(varies = "n = x[1]"));
end Chain;
