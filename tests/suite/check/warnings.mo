//@ case hidden_names_and_modifications_without_effect
//@ expect accepted
//@ check
// Nothing here is an error, and none of it is intended: each gets a warning, and nothing else.
package Doubtful
  constant Real g = 9.81;

  package Constants
    constant Real pi = 3.14;
  end Constants;

  model Thermal "Does not say more than its part"
    parameter Real C = 1;
  end Thermal;

  model Motor
    parameter Boolean heats = false;
    parameter Boolean cools = heats;
    Thermal winding(C = 2) if heats;
    Thermal fan if cools;
  end Motor;

  model Right "Each name is another one, each modification counts"
    parameter Boolean hot = false;
    parameter Integer n = 3;
    Motor forwarded(heats = hot, winding(C = 5));
    Motor copied(fan(C = 3));
    Motor on(heats = true, winding(C = 5));
    Motor overridden[2](each heats = true, winding(each C = 4));
    Real x[n](each start = 1) = {sum(i*k for k in 1:n) for i in 1:n};
    Real y[n];
  equation
    for i in 1:n loop
      y[i] = x[i]*g;
    end for;
  end Right;

  model Derived "Outer modifications override inner ones"
    extends Right(on(winding(C = 6)), x(each start = 2));
  end Derived;

  model Loops
    Real i = 1;
    Real u[3];
    Real v[3];
  equation
    for i in 1:3 loop
      u[i] = i*time;
    end for;
    for k in 1:3 loop
      v[k] = sum(k for k in 1:3);
    end for;
  end Loops;

  model Inherited
    extends Loops;
    Real w[2] = {i for i in 1:2};
  end Inherited;

  model Names
    import Doubtful.Constants.pi;
    Real pi = 3;
    Real g = 1.62;
  end Names;

  model Holder
    function weight
      input Real m;
      output Real f;
    protected
      Real g = 10;
    algorithm
      f := m*g;
    end weight;
    Real f = weight(1);
  end Holder;

  model Idle
    Motor off(winding(C = 5));
    Motor out(heats = false, winding.C = 5);
    Motor one(each heats = false);
  end Idle;
end Doubtful;
