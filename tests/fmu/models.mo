package Hybrid "Models for the tests of FMUs"
  model Inputs "Inputs, outputs and variables of all types"
    input Real u(start = 1);
    input Boolean on(start = false);
    input Integer k(start = 2);
    parameter Real tau(unit = "s") = 0.1 "Time constant";
    parameter Real twice = 2*tau;
    parameter String label = "<a> & \"b\"";
    type Level = enumeration(low, middle, high);
    parameter Level at_rest = Level.middle;
    output Real y;
    Level level;
    Boolean high;
    Integer n(start = 0, fixed = true);
    Real x(start = 0, fixed = true);
  equation
    tau*der(x) = (if on then u*k else 0) - x + time;
    y = x;
    high = x > 0.5;
    when high then
      n = pre(n) + 1;
    end when;
    level = if high then Level.high else at_rest;
    annotation(experiment(StopTime = 1));
  end Inputs;

  model Ticks "A clock, a warning and the end of the run"
    discrete Real s(start = 0, fixed = true);
    Real x(start = 1, fixed = true);
  equation
    when sample(0.1, 0.1) then
      s = pre(s) + 1;
    end when;
    der(x) = s - x;
    assert(x < 2.5, "x is large", level = AssertionLevel.warning);
    annotation(experiment(StopTime = 1));
  end Ticks;

  model Delayed "A history"
    Real x(start = 1, fixed = true);
  equation
    der(x) = -delay(x, 0.2);
    annotation(experiment(StopTime = 2));
  end Delayed;

  model Pendulum "States that are selected while the model runs"
    Real x(start = 0.6);
    Real y(start = -0.8);
    Real vx(start = 0, fixed = true);
    Real vy;
    Real f;
  equation
    der(x) = vx;
    der(y) = vy;
    der(vx) = -f*x;
    der(vy) = -f*y - 9.81;
    x^2 + y^2 = 1;
    annotation(experiment(StopTime = 2));
  end Pendulum;

  model Smooth "A nonlinear loop among the derivatives"
    Real a(start = 1, fixed = true);
    Real b(start = 2, fixed = true);
    Real z(start = 1);
  equation
    z + z^3 = a*b;
    der(a) = -z*a + sin(b);
    der(b) = exp(-a) - z;
    annotation(experiment(StopTime = 1));
  end Smooth;

  model Integrator "A part of a model"
    parameter Real k(unit = "1/s") = 1 "Gain";
    input Real u "Input";
    output Real y(start = 0, fixed = true) "Integral";
    output Integer n "Whole part";
    output Boolean isHigh;
  equation
    der(y) = k*u;
    n = integer(y);
    isHigh = y > 0.5;
    annotation(experiment(StopTime = 2, Interval = 0.1));
  end Integrator;
end Hybrid;
