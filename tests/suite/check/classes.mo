//@ case several_problems
//@ check
//@ used by check.rs
// Each of these is wrong by itself, in source order.
package Several
  connector Pin
    Real v;
    flow Real i;
  end Pin;

  model Resistor "Right"
    parameter Real R;
    Pin p, n;
  equation
    p.v - n.v = R*p.i;
    p.i + n.i = 0;
  end Resistor;

  //@ error[MO0234] 9-14
  model TooFew "An equation is missing"
    Pin p, n;
  equation
    p.i + n.i = 0;
  end TooFew;

  //@ error[MO0234] 9-15
  model TooMany "One too many"
    input Real u;
    output Real y;
  equation
    y = u;
    y = 2*u;
  end TooMany;

  model Undeclared
    //@ error[MO0202] 14
    Real x = z;
    //@ error[MO0202] 14
    Real y = w;
  end Undeclared;

  model Singular
    Real a, b;
  equation
    a + b = 1;
    2*a + 2*b = a + b + time - a - b;
    //@ error[MO0402] 5-17
    a = b - b + a;
  end Singular;

  partial model Open "Left to others"
    Real x;
  end Open;

  model OnlyInside "Has its `inner` around it elsewhere"
    outer parameter Real T;
    input Real u;
    output Real y = T*u;
  end OnlyInside;
end Several;
//@ expect messages lacks "Resistor"
//@ expect messages lacks "Open"
//@ expect messages lacks "OnlyInside"

//@ case functions_that_nothing_calls
//@ check
// Functions that nothing calls are read all the same; what depends on the sizes of their arguments is left open.
package Uncalled
  function scaled "Misspells its input"
    input Real gain;
    output Real y;
  algorithm
    //@ error[MO0202] 12-15
    y := 2*gian;
  end scaled;

  function mixed "Adds a text to a number"
    input Real x;
    output Real y;
  algorithm
    //@ error[MO0212] 10-18
    y := x + "one";
  end mixed;

  function third "Right for three elements or more"
    input Real v[:];
    output Real y;
  algorithm
    y := v[3];
  end third;

  model Idle
    Real x = time;
  end Idle;
end Uncalled;
//@ expect messages lacks "v[3]"

//@ case classes_that_do_not_run
//@ check
// Names and types are checked in every class. What may follow from what others supply is left open.
package Parts
  //@ error[MO0202] 21-25
  constant Real c = nope1;

  partial model Base
    replaceable package Medium = Fluid;
    parameter Real p;
    Real state[Medium.n];
    //@ error[MO0202] 14-18
    Real x = nope2;
  end Base;

  partial package Fluid
    constant Integer n;
  end Fluid;

  record Data
    //@ error[MO0202] 14-18
    Real a = nope3;
  end Data;

  connector Pin
    Real v;
    flow Real i;
    //@ error[MO0201] 5-8
    Nope x;
  end Pin;

  model Around
    model Inner
      //@ error[MO0202] 16-20
      Real x = nope4;
    end Inner;
    Real y = time;
  end Around;

  function outer_call
    input Real u;
    output Real y;
  algorithm
    //@ error[MO0219] 10-18
    y := one(u, 2);
  end outer_call;

  function one
    input Real u;
    output Real y = u;
  end one;

  model Pendulum "Its world is elsewhere"
    outer World world;
    Real x(start = 1, fixed = true);
  equation
    //@ error[MO0202] 15-19
    der(x) = -nope5*x + world.g;
  end Pendulum;

  model World
    parameter Real g = 9.81;
  end World;
end Parts;
//@ expect messages lacks "Medium"

//@ case protected_inputs_and_open_parameters
//@ check
//@ expect accepted
// Protected elements are not inputs; a parameter without a value decides by its start value.
block Source
  connector RealInput = input Real;
  connector RealOutput = output Real;
  parameter Boolean constant_amplitude = false;
  parameter Boolean ideal(start = true);
  RealInput amplitude if not constant_amplitude;
  RealOutput y;
  Real loss;
protected
  RealInput inner_amplitude;
equation
  connect(amplitude, inner_amplitude);
  if constant_amplitude then
    inner_amplitude = 1;
  end if;
  if ideal then
    loss = 0;
  end if;
  y = inner_amplitude*time - loss;
end Source;

//@ case buses_that_lead_out
//@ check
// The surroundings of a component may write to the buses that lead out of it, and to no others.
package Buses
  connector In = input Real;
  connector Out = output Real;
  expandable connector Sub end Sub;
  expandable connector Bus Sub sub; end Bus;
  block Gain In u; Out y = 2*u; end Gain;
  block Reader
    Bus bus;
    Gain g, h;
  equation
    //@ error[MO0244] 5-27
    connect(bus.speed, g.u);
    //@ error[MO0244] 5-31
    connect(bus.sub.force, h.u);
  end Reader;
  block Two Reader r; Bus bus; equation connect(bus, r.bus); end Two;
  block Hidden
    Bus bus;
    Gain g;
  protected
    Bus inside;
  equation
    //@ error[MO0244] 5-30
    connect(inside.speed, g.u);
  end Hidden;
  model Alone Reader r; end Alone;
end Buses;

//@ case delay
//@ check
// A delayed expression is one unknown more, and one equation.
block D
  input Real u;
  output Real y;
equation
  y = delay(u, 0.1);
end D;
//@ expect accepted
