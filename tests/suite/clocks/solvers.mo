//@ case methods
//@ run stop=1 interval=0.1
// der(x) = u - x with u = time in ten steps, against the formulas of section 16.8.2; the exact solution is
// 2*exp(-t) + t - 1.
model Methods
  block Lag
    parameter String method;
    Real u = sample(time, Clock(Clock(1, 10), solverMethod = method));
    Real x(start = 1, fixed = true);
  equation
    der(x) = u - x;
  end Lag;
  Lag ee(method = "ExplicitEuler"), mp(method = "ExplicitMidPoint2");
  Lag rk(method = "ExplicitRungeKutta4");
  Lag ie(method = "ImplicitEuler"), it(method = "ImplicitTrapezoid");
end Methods;
//@ let h = 0.1
//@ let ee(n) = if n < 1 then 1 else (1 - h)*ee(n - 1) + h*(n - 1)*h
//@ let ie(n) = if n < 1 then 1 else (ie(n - 1) + h*n*h)/(1 + h)
//@ let it(n) = if n < 1 then 1 else ((1 - h/2)*it(n - 1) + h/2*(2*n - 1)*h)/(1 + h/2)
//@ let mp(n) = if n < 1 then 1 else \
//@   mp(n - 1) + h*((n - 0.5)*h - mp(n - 1) - h/2*((n - 1)*h - mp(n - 1)))
//@ expect ee.x = ee(10) abs 1e-13
//@ expect ie.x = ie(10) abs 1e-12
//@ expect it.x = it(10) abs 1e-12
//@ expect mp.x = mp(10) abs 1e-13
//@ expect rk.x = 2*exp(-1) abs 1e-6
//@ expect rk.x at 0.1 = 0.909675 abs 1e-14

//@ case nonlinear
//@ run stop=0.1 interval=0.1
// One implicit step of der(x) = -x^3 from 1 solves x + h*x^3 = 1.
model Cubic
  Real x(start = 1, fixed = true);
  Real u = sample(0.0, Clock(Clock(1, 10), solverMethod = "ImplicitEuler"));
equation
  der(x) = u - x^3;
end Cubic;
//@ let c = sqrt(25 + 1000/27)
//@ expect x = cbrt(5 + c) + cbrt(5 - c) abs 1e-9

//@ case inferred_method
//@ run stop=0.4 interval=0.1
// The model `InferenceTest` of section 16.8.4.
model InferenceTest
  Real x(start = 3) "Explicitly using ExplicitEuler";
  Real y "Explicitly using ImplicitEuler method";
  Real z "Inferred to use ExplicitEuler";
equation
  der(x) = -x + sample(1, Clock(Clock(1, 10), solverMethod = "ExplicitEuler"));
  der(y) = subSample(x, 2) + sample(1, Clock(Clock(2, 10), solverMethod = "ImplicitEuler"));
  der(z) = subSample(x, 2) + 1;
end InferenceTest;
//@ let x(n) = 1 + 2*0.9^n
//@ expect x = x(4) abs 1e-12
//@ expect y = 0.2*(x(2) + 1) + 0.2*(x(4) + 1) abs 1e-9
//@ expect z = 0.2*(x(0) + 1) + 0.2*(x(2) + 1) abs 1e-12

//@ case steady_start
//@ run stop=0.5 interval=0.1
// An initial equation of a state holds at the first tick.
model Steady
  Real u = sample(if time > 0.25 then 3.0 else 2.0, Clock(Clock(1, 10), "ImplicitEuler"));
  Real x;
initial equation
  der(x) = 0;
equation
  der(x) = u - x;
end Steady;
//@ expect x at 0.2, 0.3 = 2, (2 + 0.3)/1.1 abs 1e-9
