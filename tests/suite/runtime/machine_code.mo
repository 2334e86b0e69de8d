//@ case functions
//@ used by machine_code.rs
// Loops, branches, assertions and calls of calls; the Jacobian needs their derivatives.
function root
input Real a;
output Real x;
algorithm
assert(a > -1, "out of range");
x := 1 + a;
for k in 1:4 loop
x := x - (x*x - (1 + a))/(2*x);
end for;
end root;
function twice
input Real a;
output Real b;
output Real c;
algorithm
b := root(a) + root(a*a);
c := if b > 2 then min(b, 5) else max(-b, a^3);
end twice;
model M
Real x(start = 1, fixed = true);
Real y(start = 0.2, fixed = true);
Real b;
Real c;
equation
(b, c) = twice(abs(x) + y);
der(x) = -b*x;
der(y) = c - 3*y;
annotation(experiment(StopTime = 1));
end M;

//@ case blocks
//@ used by machine_code.rs
// Torn blocks, linear and nonlinear, and a mixed one.
model M
Real x(start = 1, fixed = true);
Real u(start = 1);
Real v(start = 1);
Real p;
Real q;
Real r;
Boolean high(start = false, fixed = true);
equation
der(x) = -u + (if high then 0.1 else 0);
u^3 + v = x;
v^3 - u = x*x;
p + q + r = x;
p - 2*q = time;
q + sin(time)*r = 1;
high = u > 0.5;
annotation(experiment(StopTime = 2));
end M;
