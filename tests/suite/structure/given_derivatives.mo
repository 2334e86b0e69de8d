//@ case movement_by_signals
//@ run stop=1 also=flat
// The annotations give the velocity and the acceleration, which are not the derivatives of the position.
package Movements
  function position
    input Real q[3];
    input Real t;
    output Real s = q[1];
    annotation(derivative(noDerivative = q) = velocity);
  end position;
  function velocity
    input Real q[3];
    input Real t;
    input Real t_der;
    output Real v = q[2]*t_der;
    annotation(derivative(noDerivative = q, order = 2) = acceleration);
  end velocity;
  function acceleration
    input Real q[3];
    input Real t;
    input Real t_der;
    input Real t_der2;
    output Real a = q[3]*t_der + q[2]*t_der2;
  end acceleration;
  model Mass
    parameter Real m = 2;
    Real u[3] = {1 + 2*time, 3 + time^2, 7 - time};
    Real s, v, a, force;
  equation
    s = position(u, time);
    v = der(s);
    a = der(v);
    m*a = force;
  end Mass;
end Movements;
//@ expect each s, v = 1 + 2*time, 3 + time^2 rel 1e-12
//@ expect each a, force = 7 - time, 2*(7 - time) rel 1e-12

//@ case order_of_the_equations
//@ run stop=1 also=flat
// As above, with names of derivatives that are written in the reverse order, and a sign.
package Movements
  function position
    input Real q[2];
    input Real t;
    output Real s = q[1];
    annotation(derivative(noDerivative = q) = velocity);
  end position;
  function velocity
    input Real q[2];
    input Real t;
    input Real t_der;
    output Real v = q[2];
  end velocity;
  model Mass
    Real a, v, s, x;
  equation
    a = der(v);
    v = der(s);
    s = -x;
    x = position({sin(time), exp(-time)}, time);
  end Mass;
end Movements;
//@ expect each s, v, a = -sin(time), -exp(-time), exp(-time) abs 1e-12

//@ case signals_that_depend_on_states
//@ run stop=1 tolerance=1e-9 also=flat
// A chain of adaptors: their inputs depend on states that the outputs drive. The signals are consistent, so that the
// oscillator is that without adaptors, v'' + v' + v = cos(t).
package Adaptors
  function state
    input Real u[2];
    input Real t;
    output Real s = u[1];
    annotation(derivative(noDerivative = u) = rate);
  end state;
  function rate
    input Real u[2];
    input Real t;
    input Real t_der;
    output Real r = u[2];
  end rate;
  model Circuit
    parameter Real alpha = 0;
    Real v(start = 0, fixed = true);
    Real i(start = 0, fixed = true);
    Real given, i1, di1, i2, di2, T, G;
  equation
    der(i) = v;
    i1 = sin(time) - i;
    di1 = der(i1);
    given = state({i1, di1}, time);
    i2 = given - G*v;
    di2 = der(i2);
    T = 293;
    G = 1/(1 + alpha*(T - 293));
    der(v) = state({i2, di2}, time);
  end Circuit;
end Adaptors;
//@ let damped(t) = exp(-t/2)*sin(sqrt(3)/2*t)*2/sqrt(3)
//@ expect each v = sin(time) - damped(time) abs 1e-7
//@ expect each di1 = cos(time) - v abs 1e-7

//@ case adaptor_around_an_input
//@ run stop=1
// The derivative of an input is an input.
package Adaptors
  function state
    input Real u[2];
    input Real t;
    output Real s = u[1];
    annotation(derivative(noDerivative = u) = rate);
  end state;
  function rate
    input Real u[2];
    input Real t;
    input Real t_der;
    output Real r = u[2];
  end rate;
  model Capacitor
    input Real v = 0.5;
    input Real dv = 3;
    Real follower, i;
  equation
    follower = state({v, dv}, time);
    i = 2*der(follower);
  end Capacitor;
end Adaptors;
//@ expect follower, i = 0.5, 6
